// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/operations/relief/forest/forest_scene_file.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace formwright {
namespace {

Vec3 vector_of(const std::array<double, 3>& n) { return {n[0], n[1], n[2]}; }

void read_viewpoint(const Json& object, std::size_t index, ForestSceneFile& file) {
  const SceneEntry entry(object, "Viewpoint " + std::to_string(index + 1),
                         {"eye_mm", "look_at_mm", "width_mm", "sample", "vertices", "model", "direction", "up"});
  ForestViewpoint view;
  view.eye_mm = vector_of(entry.numbers<3>("eye_mm"));
  view.look_at_mm = vector_of(entry.numbers<3>("look_at_mm"));
  view.width_mm = entry.number("width_mm");
  const SceneModelSource source = read_model_source(entry);
  view.model = source.name();
  if (source.input_number == 0) {
    const SampleInfo& info = sample_called(source.sample, entry.name());
    view.direction = array_of(info.view_direction);
    view.up = array_of(info.view_up);
  }
  if (entry.has("direction")) view.direction = entry.numbers<3>("direction");
  if (entry.has("up")) view.up = entry.numbers<3>("up");
  file.scene.viewpoints.push_back(view);
  file.models.push_back(source);
}

Pillar read_pillar(const Json& object, std::size_t index) {
  const SceneEntry entry(object, "Pillar " + std::to_string(index + 1),
                         {"shape", "x_mm", "y_mm", "width_mm", "turn_deg", "outline_mm", "height_mm"});
  const double height_mm = entry.number("height_mm");
  if (entry.has("outline_mm")) {
    Pillar pillar{{}, height_mm};
    const Json& corners = entry.value("outline_mm");
    if (!corners.is_array() || corners.size() > static_cast<std::size_t>(max_outline_corners))
      entry.wrong("outline_mm", "a list of at most " + std::to_string(max_outline_corners) + " corners");
    for (const Json& place : corners) {
      const auto p = entry.numbers_of<2>(place, "outline_mm");
      pillar.outline_mm.emplace_back(p[0], p[1]);
    }
    return pillar;
  }
  PillarForm form;
  form.centre = Vec2(entry.number("x_mm"), entry.number("y_mm"));
  form.width_mm = entry.number("width_mm");
  form.turn_deg = entry.number("turn_deg", 0);
  if (!(form.width_mm > 0)) entry.wrong("width_mm", "more than 0");
  const auto shape = shape_called(entry.text("shape"));
  if (!shape) entry.wrong("shape", "round, square or hexagon; give other shapes as outline_mm");
  form.shape = *shape;
  return pillar_of(form, height_mm);
}

}  // namespace

ForestSceneFile read_forest_scene(ByteView bytes) {
  const Json scene = read_scene_object(bytes, {"viewpoints", "pillars"});
  const Json& viewpoints = scene_list(scene, "viewpoints", static_cast<std::size_t>(max_viewpoints));
  const Json& pillars = scene_list(scene, "pillars", static_cast<std::size_t>(max_pillars));
  ForestSceneFile file;
  for (std::size_t k = 0; k < viewpoints.size(); ++k) read_viewpoint(viewpoints[k], k, file);
  for (std::size_t k = 0; k < pillars.size(); ++k) file.scene.pillars.push_back(read_pillar(pillars[k], k));
  return file;
}

Json forest_scene_json(const ForestSceneFile& file) {
  Json viewpoints = Json::array(), pillars = Json::array();
  for (std::size_t v = 0; v < file.scene.viewpoints.size(); ++v) {
    const ForestViewpoint& view = file.scene.viewpoints[v];
    const SceneModelSource& source = file.models[v];
    Json one = {
        {"eye_mm", array_of(view.eye_mm)}, {"look_at_mm", array_of(view.look_at_mm)}, {"width_mm", view.width_mm}};
    write_model_source(source, one);
    one["direction"] = view.direction;
    one["up"] = view.up;
    viewpoints.push_back(one);
  }
  for (const Pillar& pillar : file.scene.pillars) {
    if (pillar.form) {
      Json one = {{"shape", name_of(pillar.form->shape)},
                  {"x_mm", pillar.form->centre.x()},
                  {"y_mm", pillar.form->centre.y()},
                  {"width_mm", pillar.form->width_mm}};
      if (pillar.form->turn_deg != 0) one["turn_deg"] = pillar.form->turn_deg;
      one["height_mm"] = pillar.height_mm;
      pillars.push_back(one);
      continue;
    }
    Json outline = Json::array();
    for (const Vec2& p : pillar.outline_mm) outline.push_back({p.x(), p.y()});
    pillars.push_back({{"outline_mm", outline}, {"height_mm", pillar.height_mm}});
  }
  return {{"viewpoints", viewpoints}, {"pillars", pillars}};
}

ForestSceneFile sample_forest_scene(int vertices) {
  struct Side {
    const char* sample;
    double x, y, width_mm, look_z;
  };
  // Models are 50 to 95 mm high where they seem to stand; the eyes are level with their middles.
  constexpr double away = 600;
  constexpr Side sides[] = {
      {"bust", 0, -1, 68, 60}, {"octopus", 1, 0, 92, 60}, {"cat", 0, 1, 52, 60}, {"fish", -1, 0, 92, 60}};
  ForestSceneFile file;
  for (const Side& side : sides) {
    const SampleInfo& info = sample_called(side.sample, "The sample");
    ForestViewpoint view;
    view.eye_mm = Vec3(away * side.x, away * side.y, side.look_z);
    view.look_at_mm = Vec3(0, 0, side.look_z);
    view.width_mm = side.width_mm;
    view.direction = array_of(info.view_direction);
    view.up = array_of(info.view_up);
    view.model = side.sample;
    file.scene.viewpoints.push_back(view);
    file.models.push_back({side.sample, vertices, 0});
  }
  return file;
}

}  // namespace formwright
