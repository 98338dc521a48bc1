// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Triangles over points of the plane with given edges among them: the constrained Delaunay triangulation (CGAL).
#include <array>
#include <vector>

#include "geometry/mesh/triangle_mesh.h"
#include "geometry/planar/region.h"

namespace formwright {

struct PlaneTriangles {
  std::vector<Vec2> points;                // those that were given, in their order, and where given edges cross
  std::vector<Eigen::Vector3i> triangles;  // counter-clockwise
  std::vector<char> enclosed;  // of each triangle: whether an odd number of given edges is between it and the outside
};

/// Over the convex hull of `points`, which may lie on each other: a later one at the same place has no triangles. None
/// where all lie on a line.
/// `edges`: pairs of indices of points; each becomes one edge or several in a row.
PlaneTriangles constrained_delaunay(const std::vector<Vec2>& points, const std::vector<std::array<int, 2>>& edges);

/// Over a region: its rings, first and in pieces no longer than `max_edge`, and `inner` points, of which those outside
/// have no triangles.
PlaneTriangles triangles_of(const Region& region, double max_edge, const std::vector<Vec2>& inner);

}  // namespace formwright
