// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "geometry/mesh/adjacency.h"
#include "geometry/queries/crossings.h"
#include "base/data/fix.h"
#include "base/format.h"
#include "job/contract/operation_options.h"
#include "job/operations/thermoform/thermoform_input.h"
#include "job/operations/thermoform/thermoform_operations.h"
#include "thermoform/forming_glb.h"
#include "thermoform/measured/measured_object.h"
#include "thermoform/sheet/sheet_presets.h"

namespace formwright {
namespace {

std::vector<OutputInfo> thermoform_simulate_outputs() {
  return {
      {"sheet.ply", "application/x-ply", "Formed sheet, thickness",
       "The middle surface of the formed sheet, with flat position, thickness, stretch and time of contact at every vertex.",
       true},
      {"forming.glb", "model/gltf-binary", "Animation",
       "Animation of sagging, raising and vacuum, coloured by thickness.", true},
      {"mould.obj", "model/obj", "Model as placed",
       "The model in the machine's coordinates, as placed on the platform.", false},
      {"setup.json", "application/json", "Set-up for measuring",
       "What the machine was set to. With the model as placed and a scan, the evidence finds out what differs on the formed part. A measured object has its own.",
       false}};
}

std::vector<ReportField> thermoform_simulate_report_fields() {
  return {
      {"triangles", "Triangles", "", "Number of triangles in the simulated sheet."},
      {"vertices", "Vertices", "", "Number of vertices in the simulated sheet."},
      {"placement", "Placement", "mm",
       "Matrix of 4 x 4 numbers, row by row, that takes the file's coordinates to the machine's."},
      {"model_size_mm", "Model size", "mm",
       "Size of the model as it stands in the machine, including what lies below the plate."},
      {"model_height_mm", "Model height", "mm", "Height of the model above the base plate."},
      {"model_watertight", "Model watertight", "",
       "Whether the model has no holes. A mould needs that; forming does not."},
      {"sag_mm", "Sag", "mm", "How far the hot sheet sags before the platform moves."},
      {"relaxation_end_s", "End of sagging", "s", "Time from the start until the platform begins to move."},
      {"raise_end_s", "End of raising", "s", "Time from the start until the platform has arrived."},
      {"forming_end_s", "End of forming", "s", "Time from the start until forming ends."},
      {"pressure_end_kpa", "Vacuum at the end", "kPa",
       "Vacuum when forming ended. Less than the full vacuum if the whole sheet touched before."},
      {"stopped_by", "Stopped by", "",
       "Why forming ended: all_touching (the whole sheet touches), at_rest (nothing moves) or time_limit."},
      {"thickness_min_mm", "Thinnest place", "mm",
       "Thickness of the sheet at its thinnest triangle. Below a third of the flat sheet it may tear."},
      {"thickness_mean_mm", "Mean thickness", "mm", "Mean thickness of the sheet over the formed area."},
      {"stretch_max", "Largest stretch", "", "Largest ratio of a triangle's formed area to its flat area."},
      {"formed_area_mm2", "Formed area", "mm²", "Area of the sheet that lies on the model or the plate."},
      {"unformed_area_mm2", "Unformed area", "mm²", "Area of the sheet that hangs free, as in corners and gaps."},
      {"touching_share", "In contact", "",
       "Fraction of the sheet's movable vertices that touch the model or the plate."},
      {"webbing_area_mm2", "Squeezed area", "mm²",
       "Area that is compressed by more than a tenth in some direction. Folds and webs begin there."},
      {"crossings", "Crossings", "",
       "How often the sheet's edges go through the sheet itself; an error of the simulation, which lets it pass."},
      {"mould_edge_penetration_mm", "Edge penetration", "mm",
       "Greatest depth to which a sharp point of the model pierces the inner face of the sheet; an error of the simulation."},
      {"vertex_distance_min_mm", "Smallest distance", "mm",
       "Smallest distance from the sheet's middle surface to model or plate; half the thickness where it touches."},
      {"volume_drift", "Volume change", "",
       "Relative change of the plastic's volume during the simulation; an error of the simulation, practically 0."},
      {"elastic_energy_mj", "Elastic energy", "mJ", "Elastic energy stored in the sheet at the end."},
      {"steps", "Time steps", "", "Number of time steps of the simulation."},
      {"steps_rejected", "Rejected steps", "", "Number of time steps that were repeated with a shorter step."},
      {"newton_iterations", "Newton iterations", "", "Number of Newton iterations in all steps together."},
      {"cg_iterations", "Linear iterations", "", "Number of conjugate gradient iterations in all steps together."},
      {"point_contacts", "Edge contacts", "",
       "Number of sharp points of the model that touch the sheet inside a triangle."},
      {"reused", "Reused", "",
       "Whether the simulation of an earlier job with the same model and parameters was used again."},
      {"seconds_read", "Reading", "s", "Time for reading and repairing the file; 0 if it was read before."},
      {"seconds_simulation", "Simulation", "s",
       "Time for simulating sagging, raising and vacuum; 0 if an earlier simulation was used again."},
      {"seconds_assembly", "Assembly", "s", "Time for computing forces and stiffness."},
      {"seconds_linear", "Linear solves", "s", "Time for solving linear equations by conjugate gradients."},
      {"seconds_contact", "Contact", "s", "Time for finding where the sheet touches."},
      {"seconds_write", "Writing", "s", "Time for writing the output files."},
      {"peak_memory_mb", "Peak memory", "MB", "Largest amount of memory that the process used."},
      {"repairs", "Repairs", "", "What was found wrong in the model and repaired, as sentences."},
      {"notes", "Notes", "", "Decisions that were made automatically, as sentences."},
      {"warnings", "Warnings", "", "What may go wrong in the machine, as sentences."},
      {"fixes", "Fixes", "", fixes_help}};
}

/// What a maker should know before heating a sheet. `height_mm`: of the model above the plate.
std::vector<std::string> warnings(const FormedResult& result, const ThermoformOptions& o, double height_mm,
                                  bool watertight, int crossings, std::vector<Fix>& fixes) {
  std::vector<std::string> list;
  // A model that stands less high draws less of the sheet: on cat, bust, pyramid and star it thins less and folds less.
  const auto lower_it = [&] {
    const double by_mm = std::round(0.2 * height_mm);
    if (by_mm >= 1)
      fixes.push_back({list.back(),
                       "Lower it " + with_decimals(by_mm, 0) + " mm into the plate",
                       {{"sink_mm", o.sink_mm + by_mm}}});
  };
  const double thin = 0.3 * o.sheet_thickness_mm;
  if (result.min_thickness_mm < thin) {
    list.push_back(
        "The sheet thins to " + with_digits(result.min_thickness_mm, 2) +
        " mm, less than a third of its thickness: it may tear there. A lower model, rounder edges or a thicker sheet help.");
    lower_it();
  }
  const bool squeezed = result.webbing_area_mm2 > 0.005 * (result.formed_area_mm2 + result.unformed_area_mm2);
  if (squeezed || crossings > 0) {
    list.push_back(squeezed ? "Parts of the sheet are squeezed (" + with_digits(result.webbing_area_mm2 / 100, 2) +
                                  " cm²): it may fold into webs there."
                            : "The sheet may fold into webs.");
    if (crossings > 0) list.back() += " The simulated one goes through itself instead.";
    list.back() += " More distance between tall parts, or from the clamp, helps.";
    lower_it();
  }
  if (result.unformed_area_mm2 > 0.02 * (result.formed_area_mm2 + result.unformed_area_mm2))
    list.push_back(with_digits(result.unformed_area_mm2 / 100, 2) +
                   " cm² of the sheet hang free, so corners there come out rounded.");
  if (result.reached_time_limit) {
    list.push_back("The sheet was still moving at the time limit: raise the time limit.");
    constexpr double max_time_limit_s = 60;
    if (const double longer_s = std::min(2 * o.time_limit_s, max_time_limit_s); longer_s > o.time_limit_s)
      fixes.push_back({list.back(), "Wait " + with_digits(longer_s, 3) + " s", {{"time_limit_s", longer_s}}});
  }
  if (!watertight)
    list.push_back(
        "The model has holes. Forming works, but a mould needs a closed model: fill the holes before making one.");
  return list;
}

OperationResult run_thermoform_simulate(const OperationCall& call, const Json& given) {
  const SimulationCall simulation = simulation_call(call, given);
  const ThermoformOptions& o = simulation.options;
  Simulated simulated;
  {
    const auto span = call.context.span(0, 0.95, "Forming");
    simulated = simulate(call, simulation);
  }
  const FormedResult& formed = *simulated.result;
  const TriangleMesh placed = simulated.result->placement(simulated.mould.shape->mesh);
  const double shift_z = simulation.setup ? simulation.setup->base_plate_end_z_mm : 0;
  call.context.progress(0.95, "Writing");
  Stopwatch watch;
  OperationResult result;
  const auto add = [&](const char* name, Bytes bytes) {
    for (const OutputInfo& info : thermoform_simulate_outputs())
      if (info.name == name) result.outputs.push_back(make_output(info, std::move(bytes)));
    call.context.check_cancelled();
  };
  if (call.wants("sheet.ply")) add("sheet.ply", write_sheet_ply(formed.sheet, shift_z, call.context));
  if (call.wants("forming.glb"))
    add("forming.glb", write_forming_glb(formed, placed, o.sheet_thickness_mm, call.context));
  if (call.wants("mould.obj")) {
    Model model;
    model.mesh = placed;
    model.mesh.V.col(2).array() += shift_z;
    add("mould.obj", write_model(model, MeshFormat::obj, call.context));
  }
  // A scanner sees the face away from the mould.
  if (!simulation.setup && call.wants("setup.json"))
    add("setup.json", to_bytes(write_object_setup(o, MeasuredSurface::outer).dump(1) + "\n"));

  Json& report = result.report;
  const FormedSheet& sheet = formed.sheet;
  const bool watertight = Adjacency(placed).is_closed();
  const Placement& placement = formed.placement;
  Json matrix = Json::array();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) matrix.push_back(placement.linear(i, j));
    matrix.push_back(placement.translation[i] + (i == 2 ? shift_z : 0));
  }
  for (const double last : {0.0, 0.0, 0.0, 1.0}) matrix.push_back(last);
  const Vec3 size = (placed.V.colwise().maxCoeff() - placed.V.colwise().minCoeff()).transpose();
  report["triangles"] = sheet.mesh.face_count();
  report["vertices"] = sheet.mesh.vertex_count();
  report["placement"] = matrix;
  report["model_size_mm"] = {size.x(), size.y(), size.z()};
  report["model_height_mm"] = placed.V.col(2).maxCoeff();
  report["model_watertight"] = watertight;
  report["sag_mm"] = formed.sag_mm;
  report["relaxation_end_s"] = formed.phase_end_s[0];
  report["raise_end_s"] = formed.phase_end_s[1];
  report["forming_end_s"] = formed.phase_end_s[2];
  report["pressure_end_kpa"] = formed.pressure_end_kpa;
  report["stopped_by"] = formed.reached_time_limit    ? "time_limit"
                         : formed.touching_share >= 1 ? "all_touching"
                                                      : "at_rest";
  report["thickness_min_mm"] = formed.min_thickness_mm;
  report["thickness_mean_mm"] = formed.mean_thickness_mm;
  report["stretch_max"] = sheet.stretch.maxCoeff();
  report["formed_area_mm2"] = formed.formed_area_mm2;
  report["unformed_area_mm2"] = formed.unformed_area_mm2;
  report["touching_share"] = formed.touching_share;
  report["webbing_area_mm2"] = formed.webbing_area_mm2;
  const int crossings = count_crossings(sheet.mesh, {}, call.context);
  report["crossings"] = crossings;
  report["mould_edge_penetration_mm"] = formed.mould_edge_penetration_mm;
  report["vertex_distance_min_mm"] = formed.vertex_distance_min_mm;
  report["volume_drift"] = formed.volume_drift;
  report["elastic_energy_mj"] = formed.elastic_energy_mj;
  report["steps"] = formed.statistics.steps;
  report["steps_rejected"] = formed.statistics.rejected_steps;
  report["newton_iterations"] = formed.statistics.newton_iterations;
  report["cg_iterations"] = formed.statistics.cg_iterations;
  report["point_contacts"] = formed.point_contacts;
  report["reused"] = simulated.reused;
  report["seconds_read"] = simulated.mould.loaded->seconds_read + simulated.mould.loaded->seconds_repair;
  report["seconds_simulation"] = simulated.reused ? 0.0 : formed.seconds;
  report["seconds_assembly"] = formed.statistics.seconds_assembly;
  report["seconds_linear"] = formed.statistics.seconds_linear;
  report["seconds_contact"] = formed.statistics.seconds_contact;
  report["seconds_write"] = watch.seconds();
  report["repairs"] = simulated.mould.loaded->repairs;
  Json notes = Json::array();
  for (const std::string& note : placement.notes) notes.push_back(note);
  if (simulation.setup)
    for (const std::string& note : simulation.setup->notes) notes.push_back(note);
  report["notes"] = notes;
  std::vector<Fix> fixes;
  report["warnings"] = warnings(formed, o, placed.V.col(2).maxCoeff(), watertight, crossings, fixes);
  report["fixes"] = fixes_json(fixes);
  return result;
}

}  // namespace

Operation thermoform_simulate_operation() {
  Operation operation;
  operation.name = "thermoform-simulate";
  operation.title = "Thermoform";
  operation.summary = "Simulates how a heated plastic sheet is formed over a model by vacuum.";
  operation.inputs = {mould_input_info(), setup_input_info(), profile_input_info()};
  operation.outputs = thermoform_simulate_outputs();
  operation.report = thermoform_simulate_report_fields();
  operation.presets = sheet_presets();
  take_mergeable_options<ThermoformOptions>(operation, run_thermoform_simulate);
  return operation;
}

}  // namespace formwright
