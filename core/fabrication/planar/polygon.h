// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Polygons in the plane, in mm: area, hull, offset with a distance of its own for every edge.
#include <array>
#include <vector>

#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

using Polygon = std::vector<Vec2>;  // closed, the last point joined to the first; counter-clockwise is positive

double signed_area_mm2(const Polygon& polygon);

/// Corners of the convex hull, counter-clockwise, none on a straight side. Points that all lie on one line give its two
/// ends.
Polygon convex_hull(std::vector<Vec2> points);

/// How far each corner moves when edge i (from corner i to i + 1) moves to its left by `left_mm[i]`: corners go where
/// the moved edges meet, but never farther than twice the larger distance. Corners stay paired with those given, so
/// that lengths can be compared; where the polygon bends more tightly than the distance the result runs back on itself.
/// Edges may have no length.
std::vector<Vec2> offset_steps(const Polygon& polygon, const std::vector<double>& left_mm);

/// Do the triangles overlap by more than `touching_mm` in every direction? Corners in any order.
bool triangles_overlap(const std::array<Vec2, 3>& a, const std::array<Vec2, 3>& b, double touching_mm);

}  // namespace formwright
