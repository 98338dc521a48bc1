// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Lines of a width as what a cutter runs around: slots, tracks, round holes.
#include <vector>

#include "fabrication/planar/polygon.h"

namespace formwright {

/// Everything within half of its width of a polyline. One point alone is a disc.
struct ThickLine {
  std::vector<Vec2> points_mm;
  double width_mm = 1;  // above 0
};

/// What the lines cover together, round at ends and corners, exact to `tolerance_mm`: outer edges counter-clockwise,
/// edges of holes clockwise.
std::vector<Polygon> outlines_of(const std::vector<ThickLine>& lines, double tolerance_mm = 0.002);

/// The nearest point of a polyline, and how far off it is.
struct NearestOnLine {
  Vec2 point{0, 0};
  double distance_mm = 0;
};
NearestOnLine nearest_on_line(const std::vector<Vec2>& line, bool closed, const Vec2& from);

}  // namespace formwright
