// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Readers write a polygon as a fan of triangles at once, and have it triangulated properly when all vertices are known.
#include <cstdint>
#include <span>

#include "base/context.h"
#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

struct PolygonFan {
  std::int64_t first_triangle;  // of corners - 2 in a row: (c0, c1, c2), (c0, c2, c3), ...
  int corners;
};

/// Replaces the fans by good triangulations, in model.mesh.F and, if there is one, in model.FT alike.
void triangulate_fans(std::span<const PolygonFan> fans, Model& model, const Context& context);

}  // namespace formwright
