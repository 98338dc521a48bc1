// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// CGAL's triangulations of polygons and of holes.
#include <array>
#include <span>
#include <vector>

#include "geometry/mesh/triangle_mesh.h"

namespace formwright::bench {

using PolygonTriangles = std::vector<std::array<int, 3>>;

/// What CGAL's triangulate_faces does with a polygon of more than four corners: triangulate_hole_polyline, by a
/// constrained Delaunay triangulation where the corners are nearly in a plane. Empty where it finds none.
PolygonTriangles cgal_polyline(std::span<const Vec3> corners);

/// A constrained Delaunay triangulation in the polygon's mean plane, with exact predicates. Empty where sides cross or
/// corners coincide.
PolygonTriangles cgal_delaunay(std::span<const Vec3> corners);

/// The triangles of a hole whose loop is `corners`, each side with the third corner of the face beyond it. `delaunay`
/// searches the triangles of a 3D Delaunay triangulation first, which is quicker and may find another filling.
PolygonTriangles cgal_fill_hole(std::span<const Vec3> corners, std::span<const Vec3> beyond, bool delaunay);

}  // namespace formwright::bench
