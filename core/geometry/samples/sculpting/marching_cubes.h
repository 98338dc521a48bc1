// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Closed, manifold, outward oriented isosurface of a field: marching cubes on the blocks of a sparse octree
// that the surface can reach.
#include <array>
#include <vector>

#include "base/context.h"
#include "geometry/samples/sculpting/sculpture.h"

namespace formwright::samples {

using Corners = std::array<int, 3>;

struct Surface {
  std::vector<Point> points;
  std::vector<Corners> triangles;
};

/// The zero set of shape.field on a grid of `cell_mm`. Only the largest connected part is kept.
/// Every vertex lies on a grid edge, kept off its ends by a fifth so that no triangle is tiny.
/// Throws Error: internal (the field is positive everywhere), cancelled.
Surface marching_cubes(const ImplicitShape& shape, double cell_mm, Context& context);

double surface_area(const Surface& surface);

}  // namespace formwright::samples
