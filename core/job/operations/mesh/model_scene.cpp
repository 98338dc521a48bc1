// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/operations/mesh/model_scene.h"

namespace formwright {
namespace {

constexpr double row_size_mm = 100, row_step_mm = 110;
constexpr double max_length_mm = 1e6;
constexpr std::size_t max_name_bytes = 200;

Vec3 vector_of(const SceneEntry& entry, const char* key, double max_size) {
  if (!entry.has(key)) return {0, 0, 0};
  const auto n = entry.numbers<3>(key);
  for (const double value : n)
    if (std::abs(value) > max_size) entry.wrong(key, "within " + std::to_string(static_cast<int>(max_size)));
  return {n[0], n[1], n[2]};
}

PlacedModel read_model(const Json& object, std::size_t index) {
  const SceneEntry entry(object, "Model " + std::to_string(index + 1),
                         {"sample", "vertices", "model", "name", "size_mm", "turn_deg", "at_mm"});
  PlacedModel model;
  model.source = read_model_source(entry);
  model.name = entry.has("name") ? entry.text("name") : model.source.name();
  if (model.name.size() > max_name_bytes) entry.wrong("name", "text of at most 200 bytes");
  model.placement.size_mm = entry.number("size_mm", row_size_mm);
  if (!(model.placement.size_mm >= 0.01 && model.placement.size_mm <= max_length_mm))
    entry.wrong("size_mm", "between 0.01 and 1000000");
  model.placement.turn_deg = vector_of(entry, "turn_deg", 36000);
  model.placement.at_mm = vector_of(entry, "at_mm", max_length_mm);
  return model;
}

}  // namespace

std::vector<PlacedModel> read_model_scene(ByteView bytes) {
  const Json scene = read_scene_object(bytes, {"models"});
  const Json& list = scene_list(scene, "models", max_scene_models);
  if (list.empty()) refuse_scene("The scene has no models: add at least one to its list \"models\".");
  std::vector<PlacedModel> models;
  for (std::size_t k = 0; k < list.size(); ++k) models.push_back(read_model(list[k], k));
  return models;
}

Json model_scene_json(const std::vector<PlacedModel>& models) {
  Json list = Json::array();
  for (const PlacedModel& model : models) {
    Json one = Json::object();
    write_model_source(model.source, one);
    one["name"] = model.name;
    one["size_mm"] = model.placement.size_mm;
    one["turn_deg"] = array_of(model.placement.turn_deg);
    one["at_mm"] = array_of(model.placement.at_mm);
    list.push_back(one);
  }
  return Json{{"models", list}};
}

std::vector<PlacedModel> models_in_a_row(int count) {
  std::vector<PlacedModel> models;
  for (int k = 0; k < count; ++k) {
    PlacedModel model;
    model.source.input_number = k + 1;
    model.name = model.source.name();
    model.placement.size_mm = row_size_mm;
    model.placement.at_mm = Vec3(row_step_mm * (k - 0.5 * (count - 1)), 0, 0);
    models.push_back(model);
  }
  return models;
}

std::vector<PlacedModel> sample_model_scene(int vertices) {
  struct Member {
    const char* name;
    double size_mm, x_mm, z_mm, turn_deg;
  };
  // Before each other and turned, so that some hide parts of others. All stand on y = 0.
  constexpr Member family[] = {{"Large cat", 110, -30, -40, 25}, {"Cat", 80, 38, 0, -35}, {"Kitten", 50, -8, 45, 10}};
  std::vector<PlacedModel> models;
  for (const Member& member : family) {
    PlacedModel model;
    model.source.sample = "cat";
    model.source.sample_vertices = vertices;
    model.name = member.name;
    // The cat is taller than wide or deep: its size is its height.
    model.placement = {member.size_mm, {0, member.turn_deg, 0}, {member.x_mm, 0.5 * member.size_mm, member.z_mm}};
    models.push_back(model);
  }
  return models;
}

}  // namespace formwright
