// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What the viewer sees, and what lies behind what.
#include <vector>

#include "base/context.h"
#include "geometry/queries/ray_caster.h"
#include "numerics/qp/bounded_qp.h"
#include "relief/view/view_frame.h"

namespace formwright {

struct Visibility {
  std::vector<char> vertex;   // 1 where nothing lies between the viewpoint and the vertex
  std::vector<char> face;     // 1 where the face is turned to the viewer and its three vertices are visible
  std::vector<char> outline;  // 1 on the border of a connected part's picture; see find_outline
  int visible_vertices = 0;
};

/// `caster` holds the mesh (frame.P, F).
Visibility find_visibility(const ViewFrame& frame, const Triangles& F, const RayCaster& caster, Context& context);

/// Eq. (3.12): along the ray of every vertex, the next surface in front and the next behind keep their order.
/// A hit inside a face is written in the face's three u by barycentric interpolation of s along the ray,
/// which is exact for a uniform scaling and keeps the rows linear.
std::vector<InequalityRow> depth_order_rows(const ViewFrame& frame, const Triangles& F, const RayCaster& caster,
                                            Context& context);

/// 1 where a face's outside is turned to the viewer, for any positions in view coordinates.
bool faces_viewer(const ViewFrame& frame, const Positions& P, const Triangles& F, Eigen::Index face);

}  // namespace formwright
