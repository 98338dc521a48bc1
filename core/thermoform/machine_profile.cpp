// SPDX-License-Identifier: GPL-3.0-or-later
#include "thermoform/machine_profile.h"

#include <algorithm>

#include "base/error.h"
#include "base/data/json_text.h"
#include "thermoform/sheet/thermoform_options.h"

namespace formwright {
namespace {

constexpr const char* format_name = "formwright-machine-profile";
constexpr int newest_version = 1;

[[noreturn]] void refuse(const std::string& sentence) {
  throw Error(ErrorCode::invalid_input, "profile", "The machine profile: " + sentence);
}

std::vector<std::string> sentences_of(const Json& value, const std::string& key) {
  std::vector<std::string> list;
  if (!value.is_array()) refuse("“" + key + "” must be a list of texts.");
  for (const Json& item : value) {
    if (!item.is_string()) refuse("“" + key + "” must be a list of texts.");
    list.push_back(item.get<std::string>());
  }
  return list;
}

void check_parameters(const Json& parameters) {
  if (!parameters.is_object()) refuse("“parameters” must be an object of names and values.");
  for (const ParameterInfo& info : describe_parameters<PlacementOptions>())
    if (parameters.contains(info.name))
      refuse(
          "“" + info.name +
          "” places a model and belongs to a job: take it out; what a machine does to every mould is mould_shift_x_mm, mould_shift_y_mm, "
          "mould_rotation_deg and mould_scale.");
  try {
    read_parameters<ThermoformOptions>(parameters);
  } catch (const Error& error) {
    refuse(error.what());
  }
}

bool is_of_the_material(const ParameterInfo& info) { return info.group == "Material" || info.name == "vacuum_ramp_s"; }

/// What a profile knows better than a set-up.
bool is_the_machines_own(const ParameterInfo& info) {
  return is_of_the_material(info) || info.group == SheetEffects::group_title;
}

}  // namespace

MachineProfile read_machine_profile(ByteView bytes) {
  const Json json = parse_json_text(as_text(bytes));
  if (!json.is_object() || !json.contains("format") || json["format"] != format_name)
    refuse("this file is none: it must be a JSON object with \"format\": \"" + std::string(format_name) + "\".");
  if (!json.contains("version") || json["version"] != newest_version)
    refuse("only version " + std::to_string(newest_version) + " is known here: use a newer Formwright.");
  MachineProfile profile;
  for (const auto& [key, value] : json.items()) {
    if (key == "format" || key == "version") continue;
    if (key == "name") {
      if (!value.is_string()) refuse("“name” must be text.");
      profile.name = value.get<std::string>();
    } else if (key == "parameters") {
      check_parameters(value);
      profile.parameters = value;
    } else if (key == "measurement") {
      try {
        profile.measurement = read_parameters<MeasurementEffects>(value);
      } catch (const Error& error) {
        refuse(error.what());
      }
    } else if (key == "from") {
      profile.from = sentences_of(value, key);
    } else if (key == "notes") {
      profile.notes = sentences_of(value, key);
    } else {
      refuse("“" + key + "” is not known: it has name, parameters, measurement, from and notes.");
    }
  }
  return profile;
}

std::string write_machine_profile(const MachineProfile& profile) {
  check_parameters(profile.parameters);
  Json json = Json::object();
  json["format"] = format_name;
  json["version"] = newest_version;
  json["name"] = profile.name;
  json["parameters"] = profile.parameters;
  json["measurement"] = write_parameters(profile.measurement);
  json["from"] = profile.from;
  json["notes"] = profile.notes;
  return json.dump(2) + "\n";
}

std::vector<std::string> names_of_material() {
  std::vector<std::string> names;
  for (const ParameterInfo& info : describe_parameters<ThermoformOptions>())
    if (is_of_the_material(info)) names.push_back(info.name);
  return names;
}

Json with_profile(const Json& setup_parameters, const MachineProfile& profile) {
  Json merged = setup_parameters;
  for (const ParameterInfo& info : describe_parameters<ThermoformOptions>())
    if (profile.parameters.contains(info.name) && (is_the_machines_own(info) || !merged.contains(info.name)))
      merged[info.name] = profile.parameters[info.name];
  return merged;
}

}  // namespace formwright
