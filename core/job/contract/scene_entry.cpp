// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/contract/scene_entry.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/data/json_text.h"
#include "base/error.h"

namespace formwright {
namespace {

constexpr int max_model_inputs = 64;
constexpr std::size_t shown_characters = 40;  // of a name that is not known

std::string listed(std::initializer_list<const char*> names) {
  std::string list;
  for (const char* name : names) list += (list.empty() ? "" : ", ") + std::string(name);
  return list;
}

bool is_among(const std::string& key, std::initializer_list<const char*> names) {
  return std::ranges::any_of(names, [&](const char* name) { return key == name; });
}

}  // namespace

void refuse_scene(const std::string& sentence) { throw Error(ErrorCode::invalid_input, "scene", sentence); }

Json read_scene_object(ByteView bytes, std::initializer_list<const char*> known) {
  Json scene = parse_json_text(std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  if (!scene.is_object())
    refuse_scene("The scene is not a JSON object: it needs " + listed(known) + ", as docs/relief.md shows.");
  for (const auto& [key, value] : scene.items())
    if (!is_among(key, known))
      refuse_scene("The scene has \"" + key.substr(0, shown_characters) +
                   "\", which is not known; there are: " + listed(known) + ".");
  return scene;
}

const Json& scene_list(const Json& scene, const char* key, std::size_t max_size) {
  static const Json none = Json::array();
  const auto found = scene.find(key);
  if (found == scene.end()) return none;
  if (!found->is_array()) refuse_scene(std::string("The scene's ") + key + " must be a list.");
  if (found->size() > max_size)
    refuse_scene("The scene may have at most " + std::to_string(max_size) + " " + key + ", and has " +
                 std::to_string(found->size()) + ".");
  return *found;
}

SceneEntry::SceneEntry(const Json& object, std::string name, std::initializer_list<const char*> known)
    : object_(object), name_(std::move(name)) {
  if (!object.is_object()) refuse_scene(name_ + " of the scene must be a JSON object.");
  for (const auto& [key, value] : object.items())
    if (!is_among(key, known))
      refuse_scene(name_ + " of the scene has \"" + key.substr(0, shown_characters) +
                   "\", which is not known; there are: " + listed(known) + ".");
}

const Json& SceneEntry::value(const char* key) const {
  if (!has(key)) refuse_scene(name_ + " of the scene has no " + key + ": add it.");
  return object_[key];
}

int SceneEntry::whole(const char* key) const {
  const double n = number(key);
  if (n != std::floor(n) || std::abs(n) > 1e9) wrong(key, "a whole number");
  return static_cast<int>(n);
}

std::string SceneEntry::text(const char* key) const {
  if (!value(key).is_string()) wrong(key, "text");
  return value(key).get<std::string>();
}

void SceneEntry::wrong(const char* key, const std::string& kind) const {
  refuse_scene(name_ + " of the scene has " + key + " that is not " + kind + ".");
}

double SceneEntry::checked(const Json& n, const char* key, const std::string& kind) const {
  if (!n.is_number() || !std::isfinite(n.get<double>())) wrong(key, kind);
  return n.get<double>();
}

const SampleInfo& sample_called(const std::string& name, const std::string& whose) {
  std::string list;
  for (const SampleInfo& info : sample_catalog()) {
    if (info.name == name) return info;
    list += (list.empty() ? "" : ", ") + info.name;
  }
  refuse_scene(whose + " of the scene asks for a sample \"" + name.substr(0, shown_characters) +
               "\"; there are: " + list + ".");
}

SceneModelSource read_model_source(const SceneEntry& entry) {
  SceneModelSource source;
  if (entry.has("sample") == entry.has("model"))
    refuse_scene(entry.name() + " of the scene needs either a sample or the number of a model.");
  if (entry.has("sample")) {
    source.sample = entry.text("sample");
    sample_called(source.sample, entry.name());
    if (entry.has("vertices")) {
      source.sample_vertices = entry.whole("vertices");
      if (source.sample_vertices < min_sample_vertices || source.sample_vertices > max_sample_vertices)
        refuse_scene(entry.name() + " of the scene asks for a sample of " + std::to_string(source.sample_vertices) +
                     " vertices: give " + std::to_string(min_sample_vertices) + " to " +
                     std::to_string(max_sample_vertices) + ".");
    }
    return source;
  }
  source.input_number = entry.whole("model");
  if (source.input_number < 1 || source.input_number > max_model_inputs)
    refuse_scene(entry.name() + " of the scene asks for model " + std::to_string(source.input_number) +
                 ": models are numbered from 1, in the order in which they are given.");
  return source;
}

void write_model_source(const SceneModelSource& source, Json& entry) {
  if (source.input_number > 0) entry["model"] = source.input_number;
  else entry["sample"] = source.sample;
  if (source.sample_vertices > 0) entry["vertices"] = source.sample_vertices;
}

InputInfo scene_input_info(std::string help) {
  InputInfo info{scene_input, "Scene", std::move(help), {"json"}};
  info.required = false;
  return info;
}

InputInfo scene_models_info() {
  InputInfo info = model_input_info();
  info.name = scene_model_input;
  info.help = "A model that the scene refers to by its number: the first is 1.";
  info.required = false;
  info.accepts_sample = false;
  info.repeatable = true;
  return info;
}

std::string scene_model_name(int number) {
  return number == 1 ? scene_model_input : std::string(scene_model_input) + "_" + std::to_string(number);
}

std::shared_ptr<const LoadedModel> load_scene_model(const OperationCall& call, const SceneModelSource& source,
                                                    const std::string& whose) {
  if (source.input_number > 0) {
    const std::string name = scene_model_name(source.input_number);
    if (!call.inputs.contains(name))
      refuse_scene(whose + " of the scene asks for model " + std::to_string(source.input_number) +
                   ", which was not given: give it with --model.");
    return load_model(call, name);
  }
  InputBlob blob;
  blob.sample = source.sample;
  blob.sample_vertices = source.sample_vertices;
  const std::map<std::string, InputBlob> inputs{{scene_model_input, blob}};
  return load_model({inputs, call.wants, call.session, call.context}, scene_model_input);
}

}  // namespace formwright
