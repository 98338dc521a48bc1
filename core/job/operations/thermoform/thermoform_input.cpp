// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/operations/thermoform/thermoform_input.h"

#include <algorithm>

namespace formwright {
namespace {

const char* const column_names[] = {"sheet_x_mm", "sheet_y_mm", "thickness_mm", "stretch", "contact_s"};

/// Stands the model in the machine, or leaves it where a setup's mould.obj has it.
Placement placement_of(const TriangleMesh& mesh, const SimulationCall& simulation) {
  if (!simulation.setup) return place(mesh, simulation.options, clamp_opening_mm(simulation.options));
  Placement as_it_is;
  as_it_is.translation.z() = -simulation.setup->base_plate_end_z_mm;
  return as_it_is;
}

PlacedMould placed(const OperationCall& call, const SimulationCall& simulation) {
  PlacedMould mould;
  mould.loaded = load_model(call, "mould");
  const std::string key = "mould-shape:" + mould.loaded->key;
  mould.shape = call.session.find<const MouldShape>(key);
  if (!mould.shape) {
    mould.shape = std::make_shared<const MouldShape>(mould.loaded->model.mesh);
    call.session.keep(key, mould.shape, static_cast<double>(mould.shape->mesh.face_count()) * 3e-4);
  }
  mould.placement = placement_of(mould.shape->mesh, simulation);
  return mould;
}

}  // namespace

InputInfo mould_input_info() {
  InputInfo info = model_input_info();
  info.name = "mould";
  info.help = "The model that the sheet is formed over. It need not be watertight.";
  info.object_file = "mould.obj";
  return info;
}

InputInfo sheet_input_info() {
  InputInfo info;
  info.name = "sheet";
  info.label = "Formed sheet";
  info.help = "The sheet.ply that thermoform-simulate wrote. Without it, the forming is simulated first.";
  info.extensions = {"ply"};
  info.required = false;
  return info;
}

InputInfo setup_input_info() {
  InputInfo info;
  info.name = "setup";
  info.label = "Machine set-up";
  info.help =
      "The setup.json of a measured object: its machine settings. The mould is then expected in machine coordinates.";
  info.extensions = {"json"};
  info.required = false;
  info.object_file = "setup.json";
  return info;
}

InputInfo profile_input_info() {
  InputInfo info;
  info.name = "profile";
  info.label = "Machine profile";
  info.help = "The profile.json of a machine: material and faults fitted to objects that it made.";
  info.extensions = {"json"};
  info.required = false;
  return info;
}

std::optional<MachineProfile> machine_profile(const OperationCall& call) {
  const auto profile = call.inputs.find("profile");
  if (profile == call.inputs.end()) return std::nullopt;
  return read_machine_profile(*profile->second.bytes);
}

Json merged_parameters(const OperationCall& call, const Json& parameters, const std::optional<ObjectSetup>& setup) {
  Json merged = setup ? setup->parameters : Json::object();
  if (const auto profile = machine_profile(call)) merged = with_profile(merged, *profile);
  for (const auto& [name, value] : parameters.items()) merged[name] = value;
  return merged;
}

SimulationCall simulation_call(const OperationCall& call, const Json& parameters) {
  SimulationCall simulation;
  if (const auto setup = call.inputs.find("setup"); setup != call.inputs.end())
    simulation.setup = read_object_setup(*setup->second.bytes);
  simulation.options = read_parameters<ThermoformOptions>(merged_parameters(call, parameters, simulation.setup));
  if (simulation.setup && simulation.setup->sheet_turned) {  // a wedge is the sheet's and turns with it
    simulation.options.thickness_wedge_x *= -1;
    simulation.options.thickness_wedge_y *= -1;
  }
  return simulation;
}

PlacedMould placed_mould(const OperationCall& call, const ThermoformOptions& options) {
  return placed(call, {options, std::nullopt});
}

Simulated simulate(const OperationCall& call, const SimulationCall& simulation) {
  Simulated simulated;
  {
    const auto span = call.context.span(0, 0.1, "Reading the model");
    simulated.mould = placed(call, simulation);
  }
  const std::string standing =
      simulation.setup ? ":as it is, plate at " + Json(simulation.setup->base_plate_end_z_mm).dump() : "";
  const std::string key =
      "formed:" + simulated.mould.loaded->key + standing + ":" + write_parameters(simulation.options).dump();
  if (auto known = call.session.find<const FormedResult>(key)) {
    simulated.result = std::move(known);
    simulated.reused = true;
    return simulated;
  }
  const auto span = call.context.span(0.1, 1, "Forming");
  simulated.result = std::make_shared<const FormedResult>(
      form_sheet(simulated.mould.shape, simulated.mould.placement, simulation.options, call.context));
  const double megabytes = static_cast<double>(simulated.result->frames.size() + 2) *
                           static_cast<double>(simulated.result->sheet.mesh.V.rows()) * 28e-6;
  call.session.keep(key, simulated.result, megabytes);
  return simulated;
}

FormedModel formed_model(const OperationCall& call, const ThermoformOptions& options) {
  FormedModel formed;
  if (const auto sheet = call.inputs.find("sheet"); sheet != call.inputs.end()) {
    PlacedMould mould = placed_mould(call, options);
    formed.loaded = std::move(mould.loaded);
    formed.placement = std::move(mould.placement);
    formed.real_placement = displaced(formed.placement, options);
    formed.sheet = std::make_shared<const FormedSheet>(
        read_sheet_ply(*sheet->second.bytes, sheet->second.file_name, call.context));
    return formed;
  }
  Simulated simulated = simulate(call, {options, std::nullopt});
  formed.loaded = std::move(simulated.mould.loaded);
  formed.placement = std::move(simulated.mould.placement);
  formed.real_placement = simulated.result->placement;
  formed.sheet = std::shared_ptr<const FormedSheet>(simulated.result, &simulated.result->sheet);
  return formed;
}

Bytes write_sheet_ply(const FormedSheet& sheet, double shift_z_mm, Context& context) {
  Model model;
  model.mesh = sheet.mesh;
  model.mesh.V.col(2).array() += shift_z_mm;
  const std::vector<VertexColumn> columns = {{column_names[0], sheet.sheet_mm.col(0), ColumnKind::float64},
                                             {column_names[1], sheet.sheet_mm.col(1), ColumnKind::float64},
                                             {column_names[2], sheet.thickness_mm, ColumnKind::float64},
                                             {column_names[3], sheet.stretch, ColumnKind::float64},
                                             {column_names[4], sheet.contact_s, ColumnKind::float64}};
  WriteOptions write;
  write.columns = columns;
  return write_model(model, MeshFormat::ply, write, context);
}

FormedSheet read_sheet_ply(ByteView bytes, const std::string& file_name, Context& context) {
  ReadOptions options;
  options.where = "sheet";
  const ModelFile file = read_model_file(bytes, file_name, options, context);
  FormedSheet sheet;
  sheet.mesh = file.model.mesh;
  const auto column = [&](const char* name) -> const Eigen::VectorXd& {
    for (const VertexColumn& candidate : file.columns)
      if (candidate.name == name) return candidate.values;
    throw Error(ErrorCode::invalid_input, "sheet",
                file_name + ": there is no column “" + name + "”; give the sheet.ply that thermoform-simulate wrote.");
  };
  sheet.sheet_mm.resize(sheet.mesh.V.rows(), 2);
  sheet.sheet_mm.col(0) = column(column_names[0]);
  sheet.sheet_mm.col(1) = column(column_names[1]);
  sheet.thickness_mm = column(column_names[2]);
  sheet.stretch = column(column_names[3]);
  sheet.contact_s = column(column_names[4]);
  return sheet;
}

}  // namespace formwright
