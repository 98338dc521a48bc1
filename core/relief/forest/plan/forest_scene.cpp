// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/forest/plan/forest_scene.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/format.h"

namespace formwright {
namespace {

constexpr double max_place_mm = 1e6, min_height_mm = 1, min_area_mm2 = 1;

[[noreturn]] void refuse(const std::string& sentence) { throw Error(ErrorCode::invalid_input, "scene", sentence); }

std::string name_of(const char* kind, std::size_t index) { return std::string(kind) + " " + std::to_string(index + 1); }

bool is_place(double value) { return std::isfinite(value) && std::abs(value) <= max_place_mm; }

void check_pillar(const Pillar& pillar, std::size_t index) {
  const std::string name = name_of("Pillar", index);
  if (!std::ranges::all_of(pillar.outline_mm, [](const Vec2& p) { return is_place(p.x()) && is_place(p.y()); }) ||
      !is_place(pillar.height_mm) || pillar.height_mm < min_height_mm)
    refuse(name + " has a place or height that is not between 1 mm and 1 km: give both in millimetres.");
  if (pillar.outline_mm.size() < 3 || pillar.outline_mm.size() > static_cast<std::size_t>(max_outline_corners))
    refuse(name + " has an outline of " + std::to_string(pillar.outline_mm.size()) + " corners: give 3 to " +
           std::to_string(max_outline_corners) + ".");
  for (int k = 0; k < static_cast<int>(pillar.outline_mm.size()); ++k)
    if (corner(pillar.outline_mm, k) == corner(pillar.outline_mm, k + 1))
      refuse(name + " has two corners at the same place: leave one of them out.");
  if (crosses_itself(pillar.outline_mm))
    refuse(name + " has an outline that crosses itself: put its corners in order.");
  if (std::abs(outline_area_mm2(pillar.outline_mm)) < min_area_mm2)
    refuse(name + " covers less than 1 mm² of the floor: make it wider.");
}

void check_viewpoint(const ForestViewpoint& view, std::size_t index) {
  const std::string name = name_of("Viewpoint", index);
  for (int k = 0; k < 3; ++k)
    if (!is_place(view.eye_mm[k]) || !is_place(view.look_at_mm[k]))
      refuse(name + " has a place beyond 1 km: give places in millimetres.");
  if (!(view.width_mm >= 0.1) || !is_place(view.width_mm))
    refuse(name + " has a model of " + with_digits(view.width_mm, 4) + " mm: give a width from 0.1 mm to 1 km.");
  const Vec3 look = view.look_at_mm - view.eye_mm;
  if (look.head<2>().norm() < 1e-3 * look.norm() || look.norm() < 1e-3)
    refuse(name + " looks straight up or down, or nowhere: move it aside of what it looks at.");
}

void check_among_pillars(const ForestScene& scene, std::size_t index) {
  const ForestViewpoint& view = scene.viewpoints[index];
  const Vec2 eye = view.eye_mm.head<2>(), forward = (view.look_at_mm - view.eye_mm).head<2>().normalized();
  bool any_ahead = false;
  for (std::size_t p = 0; p < scene.pillars.size(); ++p) {
    const Outline& outline = scene.pillars[p].outline_mm;
    if (is_inside(outline, eye))
      refuse(name_of("Viewpoint", index) + " stands inside pillar " + std::to_string(p + 1) + ": move one of the two.");
    for (const Vec2& c : outline) any_ahead = any_ahead || forward.dot(c - eye) > 0;
  }
  if (!any_ahead)
    refuse("All pillars stand behind viewpoint " + std::to_string(index + 1) + ": turn it round or move it.");
}

}  // namespace

void check_viewpoints(const ForestScene& scene) {
  if (scene.viewpoints.empty()) refuse("The scene has no viewpoint: add one with a model.");
  if (scene.viewpoints.size() > static_cast<std::size_t>(max_viewpoints))
    refuse("The scene has " + std::to_string(scene.viewpoints.size()) + " viewpoints: at most " +
           std::to_string(max_viewpoints) + " can be computed.");
  for (std::size_t v = 0; v < scene.viewpoints.size(); ++v) check_viewpoint(scene.viewpoints[v], v);
}

void check_forest(const ForestScene& scene, double gap_mm) {
  check_viewpoints(scene);
  if (scene.pillars.empty()) refuse("The scene has no pillars: add some, or choose a layout that makes them.");
  if (scene.pillars.size() > static_cast<std::size_t>(max_pillars))
    refuse("The scene has " + std::to_string(scene.pillars.size()) + " pillars: at most " +
           std::to_string(max_pillars) + " can be computed.");
  for (std::size_t p = 0; p < scene.pillars.size(); ++p) check_pillar(scene.pillars[p], p);
  for (std::size_t p = 0; p < scene.pillars.size(); ++p)
    for (std::size_t q = p + 1; q < scene.pillars.size(); ++q) {
      const double distance = distance_between(scene.pillars[p].outline_mm, scene.pillars[q].outline_mm, gap_mm);
      const std::string both = "Pillars " + std::to_string(p + 1) + " and " + std::to_string(q + 1);
      if (distance == 0) refuse(both + " overlap: move them apart.");
      if (distance < gap_mm)
        refuse(both + " stand " + with_digits(distance, 3) + " mm apart, and their reliefs need " +
               with_digits(gap_mm, 3) + " mm: move them apart, or make the reliefs thinner.");
    }
  for (std::size_t v = 0; v < scene.viewpoints.size(); ++v) check_among_pillars(scene, v);
}

void orient_outlines(ForestScene& scene) {
  for (Pillar& pillar : scene.pillars)
    if (outline_area_mm2(pillar.outline_mm) < 0) std::ranges::reverse(pillar.outline_mm);
}

}  // namespace formwright
