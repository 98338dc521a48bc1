// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/making/making_profile.h"

#include "base/data/json_text.h"
#include "base/error.h"

namespace formwright {
namespace {

constexpr const char* making_format = "formwright-making-profile";

[[noreturn]] void refuse_profile(const std::string& sentence) {
  throw Error(ErrorCode::invalid_input, "profile", "The making profile: " + sentence);
}

std::vector<std::string> texts_in(const Json& json, const char* key) {
  std::vector<std::string> texts;
  const Json list = json.value(key, Json::array());
  if (!list.is_array()) refuse_profile("“" + std::string(key) + "” must be a list of texts.");
  for (const Json& item : list) {
    if (!item.is_string()) refuse_profile("“" + std::string(key) + "” must be a list of texts.");
    texts.push_back(item.get<std::string>());
  }
  return texts;
}

}  // namespace

MakingProfile read_making_profile(ByteView bytes) {
  const Json json = parse_json_text(as_text(bytes));
  if (!json.is_object() || json.value("format", Json()) != making_format || json.value("version", Json()) != 1)
    refuse_profile("this file is none: give the profile.json that evidence-diagnose-zippable wrote.");
  MakingProfile profile;
  const Json name = json.value("name", Json("")), parameters = json.value("parameters", Json::object());
  if (!name.is_string() || !parameters.is_object())
    refuse_profile("“name” must be a text, and “parameters” an object of names and values.");
  profile.name = name.get<std::string>();
  try {
    read_parameters<MakingErrors>(parameters);
  } catch (const Error& error) {
    refuse_profile(error.what());
  }
  profile.parameters = parameters;
  profile.from = texts_in(json, "from");
  profile.notes = texts_in(json, "notes");
  return profile;
}

std::string write_making_profile(const MakingProfile& profile) {
  Json json = Json::object();
  json["format"] = making_format;
  json["version"] = 1;
  json["name"] = profile.name;
  json["parameters"] = profile.parameters;
  json["from"] = profile.from;
  json["notes"] = profile.notes;
  return json.dump(2) + "\n";
}

Json with_making_profile(const Json& given, const MakingProfile& profile) {
  Json merged = given;
  for (const auto& [name, value] : profile.parameters.items())
    if (!merged.contains(name)) merged[name] = value;
  return merged;
}

}  // namespace formwright
