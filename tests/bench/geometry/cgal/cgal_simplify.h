// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// CGAL's edge collapse with each of its four kinds of Garland and Heckbert's quadrics.
#include <array>
#include <string_view>
#include <vector>

#include "base/context.h"
#include "geometry/mesh/triangle_mesh.h"

namespace formwright::bench {

enum class CgalQuadrics { plane, triangle, probabilistic_plane, probabilistic_triangle };

struct CgalSimplified {
  TriangleMesh mesh;
  std::vector<int> new_vertex_of;  // per old vertex, the new one into which it went
};

/// Collapses edges, none of which may turn a face over, until `target` vertices are left or no edge may be collapsed.
/// `smooth`: then CGAL's own smoothing of angles, five rounds, each projected onto the simplified surface (its
/// smoothing of areas needs Ceres). The mesh is scaled to unit size about the origin first, as ours scales it. Needs a
/// manifold mesh.
CgalSimplified cgal_simplify(const TriangleMesh& mesh, int target, CgalQuadrics quadrics, bool smooth,
                             Context& context);

}  // namespace formwright::bench
