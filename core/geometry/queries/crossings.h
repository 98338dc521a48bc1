// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Where a surface goes through itself.
#include <span>

#include "base/context.h"
#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

/// How often an edge pierces a triangle of the same mesh; each crossing of two sheets counts once for every edge.
/// `place_of`: per vertex; what shares a place, as both sides of a closed seam do, does not count. Empty: every vertex
/// has its own. Throws Error{cancelled}.
int count_crossings(const TriangleMesh& mesh, std::span<const int> place_of, Context& context);

}  // namespace formwright
