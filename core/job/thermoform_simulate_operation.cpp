// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "geometry/adjacency.h"
#include "job/thermoform_input.h"
#include "job/thermoform_operations.h"
#include "thermoform/forming_glb.h"

namespace formwright {
namespace {

std::vector<OutputInfo> outputs() {
  return {
      {"sheet.ply", "application/x-ply", "Formed sheet",
       "Middle surface with the sheet's coordinates, thickness, stretch and time of contact of every vertex.", true},
      {"forming.glb", "model/gltf-binary", "Animation", "The three phases as morph targets, coloured by thickness.",
       true},
      {"mould.obj", "model/obj", "Placed model", "The model in machine coordinates.", false}};
}

std::vector<ReportField> report_fields() {
  return {{"triangles", "Triangles", "", "of the sheet"},
          {"vertices", "Vertices", "", "of the sheet"},
          {"placement", "Placement", "mm", "4 x 4, row by row: from the file's coordinates to the machine's"},
          {"model_size_mm", "Model size", "mm", "as it stands in the machine, above and below the plate"},
          {"model_height_mm", "Model height", "mm", "above the base plate"},
          {"model_watertight", "Model watertight", "", "needed for the mould, not for forming"},
          {"sag_mm", "Sag", "mm", "of the hot sheet before the platform moves"},
          {"relaxation_end_s", "End of relaxation", "s", "from the start"},
          {"raise_end_s", "End of raising", "s", "from the start"},
          {"forming_end_s", "End of forming", "s", "from the start"},
          {"pressure_end_kpa", "Vacuum at the end", "kPa", "full unless everything touched before"},
          {"stopped_by", "Stopped by", "", "all_touching, at_rest or time_limit"},
          {"thickness_min_mm", "Thinnest place", "mm", "over the sheet's triangles"},
          {"thickness_mean_mm", "Mean thickness", "mm", "over the formed area"},
          {"stretch_max", "Largest stretch", "", "area now over area then"},
          {"formed_area_mm2", "Formed area", "mm²", "of triangles that touch with every corner"},
          {"unformed_area_mm2", "Unformed area", "mm²", "of the others: bridges, fillets in corners"},
          {"touching_share", "In contact", "", "share of the free vertices that touch"},
          {"webbing_area_mm2", "Squeezed area", "mm²",
           "compressed by more than a tenth in some direction: folds and webs start here"},
          {"mould_edge_penetration_mm", "Edge penetration", "mm",
           "deepest sharp point of the model beyond the sheet's inner face"},
          {"vertex_distance_min_mm", "Smallest distance", "mm",
           "of the sheet's middle surface vertices from model and plate; half the thickness where it touches"},
          {"volume_drift", "Volume drift", "", "relative change of the plastic's volume"},
          {"elastic_energy_mj", "Elastic energy", "mJ", "stored in the sheet at the end"},
          {"steps", "Time steps", "", "accepted"},
          {"steps_rejected", "Rejected steps", "", "tried again with a shorter one"},
          {"newton_iterations", "Newton iterations", "", "all steps"},
          {"cg_iterations", "Linear iterations", "", "conjugate gradients, all steps"},
          {"point_contacts", "Edge contacts", "", "sharp points of the model caught inside a triangle"},
          {"reused", "Reused", "", "from an earlier job on the same model and parameters"},
          {"seconds_read", "Reading", "s", "file to repaired model; 0 when known from before"},
          {"seconds_simulation", "Simulation", "s", "all three phases; 0 when reused"},
          {"seconds_assembly", "Assembly", "s", "forces and stiffness"},
          {"seconds_linear", "Linear solves", "s", "conjugate gradients"},
          {"seconds_contact", "Contact", "s", "search for contacts"},
          {"seconds_write", "Writing", "s", "outputs into their formats"},
          {"peak_memory_mb", "Peak memory", "MB", "of the process"},
          {"repairs", "Repairs", "", "what was found in the model and mended, in words"},
          {"notes", "Notes", "", "what was decided for you, in words"},
          {"warnings", "Warnings", "", "what may go wrong in the machine, in words"}};
}

std::string figure(double value, int digits = 2) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

/// What a maker should know before heating a sheet.
Json warnings(const FormedResult& result, const ThermoformOptions& o, bool watertight) {
  Json list = Json::array();
  const double thin = 0.3 * o.sheet_thickness_mm;
  if (result.least_thickness_mm < thin)
    list.push_back(
        "The sheet thins to " + figure(result.least_thickness_mm) +
        " mm, less than a third of its thickness: it may tear there. A lower model, rounder edges or a thicker sheet help.");
  if (result.webbing_area_mm2 > 0.005 * (result.formed_area_mm2 + result.unformed_area_mm2))
    list.push_back("Parts of the sheet are squeezed (" + figure(result.webbing_area_mm2 / 100) +
                   " cm²): it may fold into webs there. More distance between tall parts, or from the clamp, helps.");
  if (result.unformed_area_mm2 > 0.02 * (result.formed_area_mm2 + result.unformed_area_mm2))
    list.push_back(figure(result.unformed_area_mm2 / 100) +
                   " cm² of the sheet do not reach the model or the plate: corners and gaps stay rounded there.");
  if (result.reached_time_limit) list.push_back("The sheet was still moving when the time limit ended.");
  if (!watertight) list.push_back("The model has holes: it can be formed over, but a mould needs it closed.");
  return list;
}

OperationResult run(const OperationCall& call) {
  const SimulationCall simulation = simulation_call(call, call.parameters);
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
    for (const OutputInfo& info : outputs())
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
  report["thickness_min_mm"] = formed.least_thickness_mm;
  report["thickness_mean_mm"] = formed.mean_thickness_mm;
  report["stretch_max"] = sheet.stretch.maxCoeff();
  report["formed_area_mm2"] = formed.formed_area_mm2;
  report["unformed_area_mm2"] = formed.unformed_area_mm2;
  report["touching_share"] = formed.touching_share;
  report["webbing_area_mm2"] = formed.webbing_area_mm2;
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
  report["warnings"] = warnings(formed, o, watertight);
  return result;
}

}  // namespace

Operation thermoform_simulate_operation() {
  Operation operation;
  operation.name = "thermoform-simulate";
  operation.title = "Thermoform";
  operation.summary = "Simulates a heated plastic sheet being drawn over a model (thesis chapter 4).";
  operation.inputs = {mould_input_info(), setup_input_info(), profile_input_info()};
  operation.parameters = describe_parameters<ThermoformOptions>();
  operation.outputs = outputs();
  operation.report = report_fields();
  operation.check = [](const Json& parameters) { read_parameters<ThermoformOptions>(parameters); };
  operation.run = run;
  return operation;
}

}  // namespace formwright
