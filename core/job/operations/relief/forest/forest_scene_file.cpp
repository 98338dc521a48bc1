// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/operations/relief/forest/forest_scene_file.h"

#include <algorithm>
#include <cmath>

#include "base/data/json_text.h"
#include "base/error.h"
#include "geometry/samples/samples.h"

namespace formwright {
namespace {

constexpr int max_model_inputs = 64;

[[noreturn]] void refuse(const std::string& sentence) { throw Error(ErrorCode::invalid_input, "scene", sentence); }

/// One viewpoint or pillar of the file.
class Entry {
 public:
  Entry(const Json& object, std::string name, std::initializer_list<const char*> known)
      : object_(object), name_(std::move(name)) {
    if (!object.is_object()) refuse(name_ + " of the scene must be a JSON object.");
    for (const auto& [key, value] : object.items())
      if (std::ranges::find_if(known, [&k = key](const char* other) { return k == other; }) == known.end()) {
        std::string list;
        for (const char* other : known) list += (list.empty() ? "" : ", ") + std::string(other);
        refuse(name_ + " of the scene has \"" + key.substr(0, 40) + "\", which is not known; there are: " + list + ".");
      }
  }

  bool has(const char* key) const { return object_.contains(key); }
  const Json& value(const char* key) const {
    if (!has(key)) refuse(name_ + " of the scene has no " + key + ": add it.");
    return object_[key];
  }
  double number(const char* key) const { return checked(value(key), key, "a number"); }
  double number(const char* key, double otherwise) const { return has(key) ? number(key) : otherwise; }
  int whole(const char* key) const {
    const double n = number(key);
    if (n != std::floor(n) || std::abs(n) > 1e9) wrong(key, "a whole number");
    return static_cast<int>(n);
  }
  std::string text(const char* key) const {
    if (!value(key).is_string()) wrong(key, "text");
    return value(key).get<std::string>();
  }
  template <std::size_t N>
  std::array<double, N> numbers(const char* key) const {
    return numbers_of<N>(value(key), key);
  }
  template <std::size_t N>
  std::array<double, N> numbers_of(const Json& list, const char* key) const {
    const std::string kind = "a list of " + std::to_string(N) + " numbers";
    std::array<double, N> result{};
    if (!list.is_array() || list.size() != N) wrong(key, kind);
    for (std::size_t k = 0; k < N; ++k) result[k] = checked(list[k], key, kind);
    return result;
  }
  [[noreturn]] void wrong(const char* key, const std::string& kind) const {
    refuse(name_ + " of the scene has " + key + " that is not " + kind + ".");
  }
  const std::string& name() const { return name_; }

 private:
  double checked(const Json& n, const char* key, const std::string& kind) const {
    if (!n.is_number() || !std::isfinite(n.get<double>())) wrong(key, kind);
    return n.get<double>();
  }
  const Json& object_;
  std::string name_;
};

Vec3 vector_of(const std::array<double, 3>& n) { return {n[0], n[1], n[2]}; }
std::array<double, 3> array_of(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

const SampleInfo& sample_called(const std::string& name, const std::string& whose) {
  std::string list;
  for (const SampleInfo& info : sample_catalog()) {
    if (info.name == name) return info;
    list += (list.empty() ? "" : ", ") + info.name;
  }
  refuse(whose + " of the scene asks for a sample \"" + name.substr(0, 40) + "\"; there are: " + list + ".");
}

void read_viewpoint(const Json& object, std::size_t index, ForestSceneFile& file) {
  const Entry entry(object, "Viewpoint " + std::to_string(index + 1),
                    {"eye_mm", "look_at_mm", "width_mm", "sample", "vertices", "model", "direction", "up"});
  ForestViewpoint view;
  ForestModelSource source;
  view.eye_mm = vector_of(entry.numbers<3>("eye_mm"));
  view.look_at_mm = vector_of(entry.numbers<3>("look_at_mm"));
  view.width_mm = entry.number("width_mm");
  if (entry.has("sample") == entry.has("model"))
    refuse(entry.name() + " of the scene needs either a sample or the number of a model.");
  if (entry.has("sample")) {
    source.sample = entry.text("sample");
    const SampleInfo& info = sample_called(source.sample, entry.name());
    view.direction = array_of(info.view_direction);
    view.up = array_of(info.view_up);
    view.model = source.sample;
    if (entry.has("vertices")) {
      source.sample_vertices = entry.whole("vertices");
      if (source.sample_vertices < min_sample_vertices || source.sample_vertices > max_sample_vertices)
        refuse(entry.name() + " of the scene asks for a sample of " + std::to_string(source.sample_vertices) +
               " vertices: give " + std::to_string(min_sample_vertices) + " to " + std::to_string(max_sample_vertices) +
               ".");
    }
  } else {
    source.input_number = entry.whole("model");
    if (source.input_number < 1 || source.input_number > max_model_inputs)
      refuse(entry.name() + " of the scene asks for model " + std::to_string(source.input_number) +
             ": models are numbered from 1, in the order in which they are given.");
    view.model = "model " + std::to_string(source.input_number);
  }
  if (entry.has("direction")) view.direction = entry.numbers<3>("direction");
  if (entry.has("up")) view.up = entry.numbers<3>("up");
  file.scene.viewpoints.push_back(view);
  file.models.push_back(source);
}

Pillar read_pillar(const Json& object, std::size_t index) {
  const Entry entry(object, "Pillar " + std::to_string(index + 1),
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

const Json& list_of(const Json& scene, const char* key) {
  static const Json none = Json::array();
  const auto found = scene.find(key);
  if (found == scene.end()) return none;
  if (!found->is_array()) refuse(std::string("The scene's ") + key + " must be a list.");
  return *found;
}

}  // namespace

ForestSceneFile read_forest_scene(ByteView bytes) {
  const Json scene = parse_json_text(std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  if (!scene.is_object())
    refuse("The scene is not a JSON object: it needs viewpoints and pillars, as docs/relief.md shows.");
  for (const auto& [key, value] : scene.items())
    if (key != "viewpoints" && key != "pillars")
      refuse("The scene has \"" + key.substr(0, 40) + "\", which is not known; there are: viewpoints, pillars.");
  const Json &viewpoints = list_of(scene, "viewpoints"), &pillars = list_of(scene, "pillars");
  if (viewpoints.size() > static_cast<std::size_t>(max_viewpoints) ||
      pillars.size() > static_cast<std::size_t>(max_pillars))
    refuse("The scene may have at most " + std::to_string(max_viewpoints) + " viewpoints and " +
           std::to_string(max_pillars) + " pillars.");
  ForestSceneFile file;
  for (std::size_t k = 0; k < viewpoints.size(); ++k) read_viewpoint(viewpoints[k], k, file);
  for (std::size_t k = 0; k < pillars.size(); ++k) file.scene.pillars.push_back(read_pillar(pillars[k], k));
  return file;
}

Json forest_scene_json(const ForestSceneFile& file) {
  Json viewpoints = Json::array(), pillars = Json::array();
  for (std::size_t v = 0; v < file.scene.viewpoints.size(); ++v) {
    const ForestViewpoint& view = file.scene.viewpoints[v];
    const ForestModelSource& source = file.models[v];
    Json one = {
        {"eye_mm", array_of(view.eye_mm)}, {"look_at_mm", array_of(view.look_at_mm)}, {"width_mm", view.width_mm}};
    if (source.input_number > 0) one["model"] = source.input_number;
    else one["sample"] = source.sample;
    if (source.sample_vertices > 0) one["vertices"] = source.sample_vertices;
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
