// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Simple closed meshes that moulds are put together from.
#include <vector>

#include "geometry/mesh/measures.h"
#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

/// `outline` (n >= 3, convex, counter-clockwise seen from above) between two heights: 2 n vertices.
TriangleMesh vertical_prism(const std::vector<Vec2>& outline, double bottom_mm, double top_mm);

TriangleMesh box_mesh(const Vec3& lower, const Vec3& upper);

struct Ring {
  double offset_mm, radius_mm;  // along the axis, and of the corners about it
};
/// A turned shape of at least two rings with ascending offsets about a line along `axis` (0, 1, 2) through `centre`;
/// flat ends, `sides` >= 3. Corners lie on the circles.
TriangleMesh turned_mesh(const Vec3& centre, int axis, const std::vector<Ring>& rings, int sides);

/// Several closed meshes as one; they should not touch.
TriangleMesh collected(const std::vector<TriangleMesh>& meshes);

/// Corners of the convex hull, counter-clockwise, none of them in line.
std::vector<Vec2> convex_outline(std::vector<Vec2> points);
/// A convex outline whose every side lies at least `distance_mm` outside of `outline`: its sum with a circle, drawn
/// around in `sides` pieces.
std::vector<Vec2> widened_outline(const std::vector<Vec2>& outline, double distance_mm, int sides);

}  // namespace formwright
