// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The outline of a model as the viewer sees it: where thesis section 3.3 ("visual hull") ties a relief to its plate.
#include <vector>

#include "base/context.h"
#include "geometry/mesh/adjacency.h"
#include "geometry/queries/ray_caster.h"
#include "relief/view/view_frame.h"

namespace formwright {

/// n; 1 where a vertex lies on the border of its connected part's picture: an edge there has a face on one side only
/// that is turned to the viewer, or none on the other, and the vertex's ray meets its part nowhere else. What other
/// parts hide or show does not count.
/// @param component  n, the connected part of each vertex
/// @param adjacency  of F
/// @param caster     holds the mesh (frame.P, F)
/// Throws Error: cancelled.
std::vector<char> find_outline(const ViewFrame& frame, const Triangles& F, const Adjacency& adjacency,
                               const std::vector<int>& component, const RayCaster& caster, Context& context);

}  // namespace formwright
