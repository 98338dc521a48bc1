// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/forest/plan/relief_space.h"

#include <algorithm>
#include <cmath>

#include "geometry/planar/plane.h"

namespace formwright {
namespace {

constexpr double out_of_sight_mm = 0.05;  // more than solids leave the relief by their larger triangles

/// Where offset + b slope is 0, if that is between `near` and `far`.
void add_root(double offset, double slope, double near, double far, std::vector<double>& roots) {
  const double root = -offset / slope;
  if (root > near && root < far) roots.push_back(root);
}

}  // namespace

bool is_in_sight(const SeenPlan& plan, std::size_t view, const Vec2& place) {
  const PlanView& from = plan.views[view];
  const double ahead = from.ahead(place);
  if (ahead <= 0) return false;
  const double t = from.aside(place) / ahead;
  if (t < from.from || t > from.to) return false;
  const std::vector<WallStrip>& strips = plan.strips[view];
  const auto after = std::ranges::upper_bound(strips, t, {}, &WallStrip::from);
  if (after == strips.begin() || t > (after - 1)->to) return true;
  const WallStrip& strip = *(after - 1);
  const Outline& outline = plan.pillars[static_cast<std::size_t>(strip.pillar)].outline_mm;
  return ahead < from.meets_line(t, corner(outline, strip.edge), corner(outline, strip.edge + 1));
}

double last_in_sight(const SeenPlan& plan, std::size_t view, const Vec2& e, const Vec2& d, double near, double far) {
  const PlanView& from = plan.views[view];
  const Vec2 begin = e + near * d, end = e + far * d;
  const double ahead_0 = from.ahead(e), ahead_1 = from.forward.dot(d), aside_0 = from.aside(e),
               aside_1 = from.right().dot(d);
  // The segment in the viewpoint's tangents; all of them where it passes beside or behind the eye.
  double least = -INFINITY, largest = INFINITY;
  if (from.ahead(begin) <= 0 && from.ahead(end) <= 0) return near;
  if (from.ahead(begin) > 0 && from.ahead(end) > 0) {
    least = std::min(from.tangent(begin), from.tangent(end));
    largest = std::max(from.tangent(begin), from.tangent(end));
  }
  if (largest < from.from || least > from.to) return near;
  // Sight can change only where the segment crosses the line of a surface, or the first or last ray that meets it.
  std::vector<double> changes{near, far};
  add_root(ahead_0, ahead_1, near, far, changes);
  const auto add_tangent = [&](double t) {
    add_root(aside_0 - t * ahead_0, aside_1 - t * ahead_1, near, far, changes);
  };
  add_tangent(from.from);
  add_tangent(from.to);
  const std::vector<WallStrip>& strips = plan.strips[view];
  for (auto it = std::ranges::lower_bound(strips, least, {}, &WallStrip::to); it != strips.end() && it->from <= largest;
       ++it) {
    const WallStrip& s = *it;
    const Outline& outline = plan.pillars[static_cast<std::size_t>(s.pillar)].outline_mm;
    const Vec2 &a = corner(outline, s.edge), &b = corner(outline, s.edge + 1);
    add_tangent(s.from);
    add_tangent(s.to);
    add_root(cross(b - a, e - a), cross(b - a, d), near, far, changes);
  }
  std::ranges::sort(changes, std::greater<>());
  for (std::size_t k = 0; k + 1 < changes.size(); ++k)
    if (changes[k] > changes[k + 1] && is_in_sight(plan, view, e + 0.5 * (changes[k] + changes[k + 1]) * d))
      return changes[k];
  return near;
}

WallReach ReliefSpace::reach(int pillar, int edge, double t) const {
  const PlanView& own = plan_.views[view_];
  WallReach reach = wall_reach(own, this->pillar(pillar), edge, t, space_.above_mm, space_.below_mm);
  if (!hidden_from_others_) return reach;
  const double free = reach.near;
  for (std::size_t v = 0; v < plan_.views.size(); ++v)
    if (v != view_)
      reach.near = std::max(reach.near, last_in_sight(plan_, v, own.eye, own.direction(t), reach.near, reach.surface));
  if (reach.near > free) reach.near = std::min(reach.surface, reach.near + out_of_sight_mm / std::hypot(1, t));
  return reach;
}

}  // namespace formwright
