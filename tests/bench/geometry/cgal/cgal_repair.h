// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// CGAL's repair of triangle soups, put together as its manual advises.
#include "geometry/mesh/triangle_mesh.h"

namespace formwright::bench {

/// Repairs the soup (merges points, removes duplicate and degenerate polygons), orients it, makes a mesh of it,
/// stitches borders, removes needles and caps where that is possible, and turns closed parts outwards. `autorefine`:
/// first splits triangles where they cross each other. Throws std::exception where CGAL does.
TriangleMesh cgal_repair(const TriangleMesh& soup, bool autorefine);

}  // namespace formwright::bench
