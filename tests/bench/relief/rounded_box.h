// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The Box model of Fig. 3.5: a cube of regular right triangles. 16 squares along an edge have 1538 vertices.
#include "geometry/mesh/triangle_mesh.h"

namespace formwright::test {

/// Edge 1, about the origin. Edges and corners within `radius` of the border are rounded; 0: sharp.
TriangleMesh rounded_box(int squares_along_edge, double radius);

}  // namespace formwright::test
