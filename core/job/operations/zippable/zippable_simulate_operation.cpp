// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "job/contract/model_input.h"
#include "job/contract/operation_options.h"
#include "job/operations/zippable/zippable_inputs.h"
#include "job/operations/zippable/zippable_operation.h"
#include "zippable/plan/plan_record.h"
#include "zippable/zipping/cloth_presets.h"
#include "zippable/zipping/zipping_files.h"

namespace formwright {
namespace {

std::vector<OutputInfo> zippable_simulate_outputs() {
  return {{"zipped.ply", "application/x-ply", "Zipped cloth",
           "The simulated shape, with distance from the design and strain at every vertex.", true},
          {"zipping.glb", "model/gltf-binary", "Animation",
           "Animation from flat to zipped, coloured by the distance from the design at the end.", true}};
}

std::vector<ReportField> zippable_simulate_report_fields() {
  return {
      {"outcome", "Outcome", "",
       "takes_shape (as designed), as_the_cloth_does (sags as the cloth would anyway), another_shape, open_seams or not_settled (still moving)."},
      {"verdict", "Will it zip?", "", "The outcome of the simulation as a sentence."},
      {"mirrored", "Inside out", "",
       "Whether the cloth took the mirrored shape, inside out, which fits flat cloth equally well."},
      {"distance_mean_mm", "Mean distance", "mm",
       "Mean distance of the cloth from its designed place, weighted by area, after the best rotation and shift."},
      {"distance_95_mm", "Distance of 95 %", "mm", "95 % of the cloth lie closer than this to their designed place."},
      {"distance_max_mm", "Largest distance", "mm",
       "Largest distance of any point of the cloth from its designed place."},
      {"distance_mean_percent", "Mean distance", "%",
       "Mean distance of the cloth from its designed place, in percent of the object's size."},
      {"distance_95_percent", "Distance of 95 %", "%",
       "95 % of the cloth lie closer than this to their designed place, in percent of the object's size."},
      {"distance_max_percent", "Largest distance", "%",
       "Largest distance of the cloth from its designed place, in percent of the object's size."},
      {"rest_distance_mean_mm", "Mean distance at rest", "mm",
       "Mean distance from the design if the cloth starts already zipped in the designed shape: its own sagging."},
      {"rest_distance_95_mm", "Distance of 95 % at rest", "mm",
       "95 % of the cloth lie closer than this to the design if it starts already zipped in the designed shape."},
      {"rest_energy_mj", "Energy at rest", "mJ",
       "Energy of the cloth if it starts already zipped in the designed shape. Less than the energy after zipping if zipping ends in a worse shape."},
      {"gap_max_mm", "Largest gap", "mm", "Largest gap between two points that the zipper should bring together."},
      {"open_pairs", "Open pairs", "",
       "Number of pairs of points with a gap of more than a hundredth of the ribbon width."},
      {"seams_closed", "All seams closed", "", "Whether all seams closed: no pair of points stays open."},
      {"strain_mean", "Mean strain", "",
       "Mean relative change of length of the cloth, weighted by area: 0.01 is 1 % longer or shorter."},
      {"strain_max", "Largest strain", "", "Largest relative change of length of any triangle of the cloth."},
      {"energy_mj", "Energy", "mJ", "Energy of stretching, bending and seams at the end."},
      {"bending_energy_mj", "Bending energy", "mJ", "The part of the energy that comes from bending."},
      {"crossings", "Crossings", "",
       "Number of edges that pass through a triangle at the end. Real cloth cannot do this; the simulation does not prevent it."},
      {"attempts", "Courses tried", "",
       "Number of simulations with different pressures from inside; the figures are those of the best."},
      {"pressed_out", "Pressed out", "",
       "Whether the cloth was pressed out from inside once after zipping, as hands do with tucked-in corners."},
      {"held_open_percent", "Held open", "%",
       "Pressure that held the closed part open in the best simulation, in percent of stretch stiffness divided by size."},
      {"settled", "At rest", "", "Whether the simulation ended because nothing moved any more."},
      {"triangles", "Triangles", "", "Number of triangles of the cloth."},
      {"seam_pairs", "Pairs", "", "Number of pairs of points that the zipper brings together."},
      {"size_mm", "Size", "mm", "Largest dimension of the designed shape."},
      {"newton_iterations", "Newton iterations", "", "Number of Newton iterations in all steps together."},
      {"seconds_simulation", "Simulation", "s", "Time for everything except reading and writing."},
      {"seconds_write", "Writing", "s", "Time for writing the output files."},
      {"peak_memory_mb", "Peak memory", "MB", "Largest amount of memory that the process used."}};
}

const char* outcome_name(ZippingOutcome outcome) {
  switch (outcome) {
    case ZippingOutcome::takes_shape: return "takes_shape";
    case ZippingOutcome::as_the_cloth_does: return "as_the_cloth_does";
    case ZippingOutcome::another_shape: return "another_shape";
    case ZippingOutcome::open_seams: return "open_seams";
    case ZippingOutcome::not_settled: break;
  }
  return "not_settled";
}

OperationResult run_zippable_simulate(const OperationCall& call, const Json& given) {
  const auto options = read_parameters<ZippingOptions>(with_making_profile(call, given));
  const FlatDesign flat = read_flat_design(*call.inputs.at("design").bytes);
  RibbonDesign design = ribbon_of(flat);
  if (const auto plan = call.inputs.find("plan"); plan != call.inputs.end())
    design.turn_of_triangle_rad =
        read_plan_record(*plan->second.bytes, static_cast<std::size_t>(flat.F.rows()), "plan").turn_of_triangle_rad;
  ZippingResult zipped;
  {
    const auto span = call.context.span(0, 0.97, "Zipping");
    zipped = simulate_zipping(design, options, call.context);
  }
  call.context.progress(0.97, "Writing");
  Stopwatch watch;
  OperationResult result;
  for (const OutputInfo& info : zippable_simulate_outputs()) {
    if (!call.wants(info.name)) continue;
    result.outputs.push_back(make_output(info, info.name == "zipped.ply" ? write_zipped_ply(zipped, call.context)
                                                                         : write_zipping_glb(zipped, call.context)));
  }
  Json& report = result.report;
  const ShapeComparison& c = zipped.comparison;
  const double percent = 100 / std::max(zipped.pattern.size_mm, 1e-9);
  report["outcome"] = outcome_name(zipping_outcome(zipped, options.tolerance_percent));
  report["verdict"] = zipping_verdict(zipped, options.tolerance_percent);
  report["mirrored"] = c.mirrored;
  report["distance_mean_mm"] = c.mean_mm;
  report["distance_95_mm"] = c.percentile_95_mm;
  report["distance_max_mm"] = c.largest_mm;
  report["distance_mean_percent"] = percent * c.mean_mm;
  report["distance_95_percent"] = percent * c.percentile_95_mm;
  report["distance_max_percent"] = percent * c.largest_mm;
  report["rest_distance_mean_mm"] = zipped.rest.mean_mm;
  report["rest_distance_95_mm"] = zipped.rest.percentile_95_mm;
  report["rest_energy_mj"] = zipped.rest_energies.inner_mj();
  report["gap_max_mm"] = zipped.gap_max_mm;
  report["open_pairs"] = zipped.open_seams;
  report["seams_closed"] = zipped.closed();
  report["strain_mean"] = zipped.strain_mean;
  report["strain_max"] = zipped.strain_max;
  report["energy_mj"] = zipped.energies.inner_mj();
  report["bending_energy_mj"] = zipped.energies.bending_mj;
  report["crossings"] = zipped.crossings;
  report["attempts"] = zipped.attempts;
  report["pressed_out"] = zipped.pressed_out;
  report["held_open_percent"] = zipped.held_open_percent;
  report["settled"] = zipped.settled;
  report["triangles"] = zipped.pattern.flat.face_count();
  report["seam_pairs"] = zipped.pattern.seams.size();
  report["size_mm"] = zipped.pattern.size_mm;
  report["newton_iterations"] = zipped.newton_iterations;
  report["seconds_simulation"] = zipped.seconds;
  report["seconds_write"] = watch.seconds();
  return result;
}

}  // namespace

Operation zippable_simulate_operation() {
  Operation operation;
  operation.name = "zippable-simulate";
  operation.title = "Will it zip?";
  operation.summary = "Simulates the ribbon as cloth while it is zipped up, and compares the result with the design.";
  operation.inputs = {flat_design_info(), plan_record_info(), making_profile_info()};
  operation.outputs = zippable_simulate_outputs();
  operation.report = zippable_simulate_report_fields();
  operation.presets = {cloth_presets()};
  take_mergeable_options<ZippingOptions>(operation, run_zippable_simulate);
  return operation;
}

}  // namespace formwright
