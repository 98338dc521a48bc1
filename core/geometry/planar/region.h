// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Areas of the plane with straight borders, in parts and with holes: their union, difference and offsets (Clipper,
// which counts in whole numbers, so that nothing is lost by rounding but the coordinates themselves).
#include <utility>
#include <vector>

#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

/// Rings that cross neither each other nor themselves: outer ones counter-clockwise, those of holes clockwise.
/// Coordinates are multiples of 2^-30, and at most 2^31.
struct Region {
  std::vector<std::vector<Vec2>> rings;

  bool empty() const { return rings.empty(); }
  double area() const;
  std::pair<Vec2, Vec2> box() const;  // least and largest coordinates; of a region that is not empty
  /// Whether a point lies within; on a border either answer may come.
  bool contains(const Vec2& p) const;
  /// Where the line at height y enters and leaves it by turns, ascending: x.
  std::vector<double> crossings(double y) const;
};

/// What closed lines go around counter-clockwise more often than clockwise. They may cross.
Region surrounded_by(const std::vector<std::vector<Vec2>>& lines);
Region united(const Region& a, const Region& b);
Region common(const Region& a, const Region& b);
Region without(const Region& a, const Region& b);
/// Without points nearer than a distance to the line through their neighbours, and without rings around less area than
/// `min_area`.
Region cleaned(const Region& region, double distance, double min_area);
/// Grown by a distance, with mitred corners; shrunk by a negative one.
Region grown(const Region& region, double distance);

}  // namespace formwright
