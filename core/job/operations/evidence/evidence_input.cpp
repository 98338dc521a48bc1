// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/operations/evidence/evidence_input.h"

#include <map>

#include "base/sha256.h"
#include "evidence/models/thermoform/rim_thickness.h"
#include "formats/mesh_io.h"
#include "geometry/repair/repair.h"
#include "job/contract/file_pack.h"

namespace formwright {
namespace {

FormedObject read_object(const InputBlob& input, const std::string& where, OperationCall const& call) {
  const std::map<std::string, Bytes> files =
      unpack_files(input, where, {"mould.obj", "setup.json", "measured.csv"}, call.context);
  FormedObject object;
  object.name = pack_name(input, where);
  const auto named = [&](const Error& error) { return Error(error.code(), where, object.name + ": " + error.what()); };
  try {
    object.setup = read_object_setup(files.at("setup.json"));
    object.points = read_measured_points(files.at("measured.csv"));
    object.thickness = read_measured_thickness(files.at("measured.csv"));
    object.key = sha256_hex(files.at("mould.obj"));
    const std::string key = "evidence-mould:" + object.key;
    object.mould = call.session.find<const MouldShape>(key);
    if (!object.mould) {
      ReadOptions options;
      options.where = where;
      const ModelFile file = read_model_file(files.at("mould.obj"), "mould.obj", options, call.context);
      object.mould = std::make_shared<const MouldShape>(repair(file.model.mesh, {}, call.context).mesh);
      call.session.keep(key, object.mould, static_cast<double>(object.mould->mesh.face_count()) * 3e-4);
    }
  } catch (const Error& error) {
    if (error.code() != ErrorCode::invalid_input) throw;
    throw named(error);
  }
  try {
    check_measured_object(object);
    check_mould_of(object);
    for (const std::string& note : {rim_note(object), thickness_note(object)})
      if (!note.empty()) object.setup.notes.push_back(note);
  } catch (const Error& error) {
    throw Error(error.code(), where, error.what());
  }
  return object;
}

}  // namespace

InputInfo object_input_info(const std::string& name, const std::string& label, const std::string& help, bool required,
                            bool repeatable) {
  InputInfo info;
  info.name = name;
  info.label = label;
  info.help = help;
  info.extensions = {"zip"};
  info.required = required;
  info.repeatable = repeatable;
  info.folder_files = {"mould.obj", "setup.json", "measured.csv"};
  return info;
}

std::vector<FormedObject> read_formed_objects(const OperationCall& call, const std::string& name) {
  std::vector<FormedObject> objects;
  for (const auto& [own, input] : inputs_named(call, name)) objects.push_back(read_object(*input, own, call));
  return objects;
}

void require_each_once(const OperationCall& call, const std::string& file) {
  std::map<Bytes, std::string> names;  // by content
  for (const char* role : {"object", "unseen", "good"})
    for (const auto& [own, input] : inputs_named(call, role)) {
      const std::string name = pack_name(*input, own);
      const auto [before, is_new] = names.emplace(unpack_files(*input, own, {file}, call.context).at(file), name);
      if (!is_new)
        throw Error(ErrorCode::invalid_input, own,
                    name + " has the same " + file + " as " + before->second +
                        ": give every measurement once; what was fitted says nothing about the gain.");
    }
}

MachineProfile read_profile_input(const OperationCall& call) {
  const auto input = call.inputs.find("profile");
  return input == call.inputs.end() ? MachineProfile{} : read_machine_profile(*input->second.bytes);
}

Json parameter_values(const ForwardModel& model, const Eigen::VectorXd& u, ParameterRole role) {
  Json list = Json::array();
  for (std::size_t p = 0; p < model.parameters().size(); ++p) {
    const ModelParameter& parameter = model.parameters()[p];
    if (parameter.role == role)
      list.push_back({{"name", parameter.name},
                      {"label", parameter.label},
                      {"value", parameter.value(u[static_cast<Eigen::Index>(p)])},
                      {"unit", parameter.unit}});
  }
  return list;
}

}  // namespace formwright
