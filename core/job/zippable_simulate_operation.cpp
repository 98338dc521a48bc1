// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "job/model_input.h"
#include "job/zippable_operation.h"
#include "zippable/zipping/zipping_files.h"

namespace formwright {
namespace {

InputInfo design_input() {
  InputInfo info;
  info.name = "design";
  info.label = "Design";
  info.help = "design.json of zippable-design: the flat ribbon, its zipper and the shape it is meant to take.";
  info.extensions = {"json"};
  return info;
}

std::vector<OutputInfo> outputs() {
  return {{"zipped.ply", "application/x-ply", "Zipped cloth",
           "The simulated shape with its distance to the prediction and its strain at every vertex.", true},
          {"zipping.glb", "model/gltf-binary", "Animation",
           "From flat to zipped as morph targets, coloured by the distance at the end.", true}};
}

std::vector<ReportField> report_fields() {
  return {
      {"outcome", "Outcome", "", "takes_shape, as_the_cloth_does, another_shape, open_seams or not_settled"},
      {"verdict", "Will it zip?", "", "the outcome in words"},
      {"mirrored", "Inside out", "", "the mirror image, which flat cloth takes just as well, was nearer"},
      {"distance_mean_mm", "Mean distance", "mm",
       "of places from where the design has them, after turning it there; by area"},
      {"distance_95_mm", "Distance of 95 %", "mm", "no more than 5 % of the cloth is farther off"},
      {"distance_max_mm", "Largest distance", "mm", "of any vertex"},
      {"distance_mean_percent", "Mean distance", "%", "of the shape's size"},
      {"distance_95_percent", "Distance of 95 %", "%", "of the shape's size"},
      {"distance_max_percent", "Largest distance", "%", "of the shape's size"},
      {"rest_distance_mean_mm", "Mean distance at rest", "mm",
       "when it starts zipped in the designed shape: its own sagging"},
      {"rest_distance_95_mm", "Distance of 95 % at rest", "mm", "the same"},
      {"rest_energy_mj", "Energy at rest", "mJ", "the same: less than energy_mj where zipping ends in a worse shape"},
      {"gap_max_mm", "Largest gap", "mm", "between two places that should meet"},
      {"open_pairs", "Open pairs", "", "with a gap of over a hundredth of the ribbon's width"},
      {"seams_closed", "All seams closed", "", "no pair is open"},
      {"strain_mean", "Mean strain", "", "of lengths, by area: 0.01 is a hundredth longer or shorter"},
      {"strain_max", "Largest strain", "", "of any triangle"},
      {"energy_mj", "Energy", "mJ", "of stretching, bending and seams at the end"},
      {"bending_energy_mj", "Bending energy", "mJ", "part of it"},
      {"crossings", "Crossings", "",
       "edges that pierce triangles at the end: cloth cannot, this one is not kept from it"},
      {"attempts", "Courses tried", "", "with other pressures from inside; the figures are the best one's"},
      {"pressed_out", "Pressed out", "",
       "whether it was, from inside, before it came to rest; as a maker does with tucked-in corners"},
      {"held_open_percent", "Held open", "%", "in this course"},
      {"settled", "At rest", "", "the simulation ended because nothing moved"},
      {"triangles", "Triangles", "", "of the cloth"},
      {"seam_pairs", "Pairs", "", "of places that the zipper brings together"},
      {"size_mm", "Size", "mm", "largest dimension of the designed shape"},
      {"newton_iterations", "Newton iterations", "", "all steps"},
      {"seconds_simulation", "Simulation", "s", "all but reading and writing"},
      {"seconds_write", "Writing", "s", "outputs into their formats"},
      {"peak_memory_mb", "Peak memory", "MB", "of the process"}};
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

OperationResult run(const OperationCall& call) {
  const auto options = read_parameters<ZippingOptions>(call.parameters);
  const RibbonDesign design = ribbon_of(read_flat_design(*call.inputs.at("design").bytes));
  ZippingResult zipped;
  {
    const auto span = call.context.span(0, 0.97, "Zipping");
    zipped = simulate_zipping(design, options, call.context);
  }
  call.context.progress(0.97, "Writing");
  Stopwatch watch;
  OperationResult result;
  for (const OutputInfo& info : outputs()) {
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
  operation.summary = "Zips the flat ribbon up as cloth and compares it with the design.";
  operation.inputs = {design_input()};
  operation.parameters = describe_parameters<ZippingOptions>();
  operation.outputs = outputs();
  operation.report = report_fields();
  operation.check = [](const Json& parameters) { read_parameters<ZippingOptions>(parameters); };
  operation.run = run;
  return operation;
}

}  // namespace formwright
