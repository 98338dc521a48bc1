// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// CGAL's Loop subdivision.
#include "geometry/mesh/triangle_mesh.h"

namespace formwright::bench {

/// Needs a manifold mesh. `seconds` gets the processor time without the conversions to CGAL's mesh and back.
TriangleMesh cgal_loop(const TriangleMesh& mesh, int levels, double& seconds);

}  // namespace formwright::bench
