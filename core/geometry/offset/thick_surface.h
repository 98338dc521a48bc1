// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A wall around any surface: alpha wrapping [PRHCA22], CGAL's Alpha_wrap_3.
#include "base/context.h"
#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

struct ThickSurfaceOptions {
  double wall_mm = 2;
  double opening_mm = 1;         // alpha: gaps and hollows with narrower openings than twice this are filled
  int max_vertices = 1'000'000;  // that are placed; bounds time and memory
};

struct ThickSurface {
  TriangleMesh mesh;    // closed, 2-manifold, without self-intersections, faces outwards
  double reach_mm = 0;  // how far its vertices are from the surface, within 1 %
};

/// A solid that holds every place within `wall_mm` of `surface`, and what the surface encloses.
///
/// The wrap's vertices lie at `reach_mm` r from the surface within the 1 % to which CGAL finds them, and its triangles
/// have circumradii below alpha. A point of such a triangle is at least sqrt((0.99 r)² - alpha²) from the surface: the
/// mean, weighted by its barycentric coordinates, of the corners' squared distances from its nearest place is the
/// square of its own distance plus at most alpha². So r is chosen to make this `wall_mm`.
/// @param surface  mm; open, self-intersecting and non-manifold ones are welcome; at least one triangle with an area
/// Throws Error: invalid_input (sizes that are not positive; nothing to thicken; "wall_mm" beyond max_vertices),
/// cancelled.
ThickSurface thick_surface(const TriangleMesh& surface, const ThickSurfaceOptions& options, Context& context);

}  // namespace formwright
