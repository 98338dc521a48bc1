// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/forest/plan/wall_reach.h"

#include <cmath>
#include <utility>

#include "geometry/planar/plane.h"

namespace formwright {
namespace {

using Interval = std::pair<double, double>;  // empty: first > second
constexpr double max_share_of_chord = 0.4;
constexpr Interval nothing{INFINITY, -INFINITY};

Interval hull(const Interval& a, const Interval& b) {
  return {std::min(a.first, b.first), std::max(a.second, b.second)};
}

/// Where the line e + b d is within `radius` of a point.
Interval in_disc(const Vec2& e, const Vec2& d, const Vec2& centre, double radius) {
  const double squared = d.squaredNorm(), middle = d.dot(centre - e) / squared,
               off = cross(d, centre - e) / std::sqrt(squared), half2 = radius * radius - off * off;
  if (half2 < 0) return nothing;
  const double half = std::sqrt(half2 / squared);
  return {middle - half, middle + half};
}

/// Where e + b d has `low` <= linear <= `high`, the linear function being offset + b slope.
Interval between(double offset, double slope, double low, double high) {
  if (slope == 0) return offset >= low && offset <= high ? Interval{-INFINITY, INFINITY} : nothing;
  const double at_low = (low - offset) / slope, at_high = (high - offset) / slope;
  return {std::min(at_low, at_high), std::max(at_low, at_high)};
}

/// Where the line is within `radius` of a segment; one interval, because what lies so near a segment is convex.
Interval near_segment(const Vec2& e, const Vec2& d, const Vec2& a, const Vec2& c, double radius) {
  const Vec2 along = (c - a).normalized(), normal(-along.y(), along.x());
  const Interval strip = between(normal.dot(e - a), normal.dot(d), -radius, radius),
                 beside = between(along.dot(e - a), along.dot(d), 0, (c - a).norm());
  const Interval box{std::max(strip.first, beside.first), std::min(strip.second, beside.second)};
  const Interval ends = hull(in_disc(e, d, a, radius), in_disc(e, d, c, radius));
  return box.first <= box.second ? hull(box, ends) : ends;
}

/// The connected part of the line that holds `start` and is within `radius` of the outline.
Interval near_outline(const Vec2& e, const Vec2& d, const Outline& outline, double start, double radius) {
  std::vector<Interval> parts;
  for (int k = 0; k < static_cast<int>(outline.size()); ++k) {
    const Interval part = near_segment(e, d, corner(outline, k), corner(outline, k + 1), radius);
    if (part.first <= part.second) parts.push_back(part);
  }
  Interval reach{start, start};
  for (bool grows = true; grows;) {
    grows = false;
    for (const Interval& part : parts) {
      if (part.first > reach.second || part.second < reach.first) continue;
      const Interval larger = hull(reach, part);
      grows = grows || larger != reach;
      reach = larger;
    }
  }
  return reach;
}

}  // namespace

WallReach wall_reach(const PlanView& view, const Pillar& pillar, int edge, double t, double above_mm, double below_mm) {
  const Outline& outline = pillar.outline_mm;
  const Vec2 d = view.direction(t);
  WallReach reach;
  reach.surface = view.meets_line(t, corner(outline, edge), corner(outline, edge + 1));
  reach.exit = INFINITY;
  for (int k = 0; k < static_cast<int>(outline.size()); ++k) {
    const Vec2 &a = corner(outline, k), &c = corner(outline, k + 1);
    if (cross(d, c - a) <= 0) continue;  // the ray enters there
    const double ahead = view.meets_line(t, a, c);
    if (!(ahead >= reach.surface) || ahead >= reach.exit) continue;
    const double place = (view.at(t, ahead) - a).dot(c - a) / (c - a).squaredNorm();
    if (place >= 0 && place <= 1) reach.exit = ahead;
  }
  // At a corner, round-off may miss all edges: the ray only touches the pillar.
  if (!std::isfinite(reach.exit)) reach.exit = reach.surface;
  reach.near = std::max(near_outline(view.eye, d, outline, reach.surface, above_mm).first, 0.1 * reach.surface);
  reach.near = std::min(reach.near, reach.surface);
  reach.far = reach.surface;
  if (below_mm > 0)
    reach.far = std::min(near_outline(view.eye, d, outline, reach.surface, below_mm).second,
                         reach.surface + max_share_of_chord * (reach.exit - reach.surface));
  reach.far = std::max(reach.far, reach.surface);
  return reach;
}

}  // namespace formwright
