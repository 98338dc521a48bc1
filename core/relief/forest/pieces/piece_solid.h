// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The solids that make one piece of a relief out of its pillar.
#include "relief/forest/pieces/piece_grid.h"

namespace formwright {

struct PieceSolids {
  TriangleMesh raised;  // from the relief to somewhat below the pillar's surface, to be united with it
  TriangleMesh room;    // what is cut out of the pillar before, where reliefs are carved into it; else empty
};

/// Closed meshes, faces outwards; flat parts are covered by larger triangles, within `tolerance_mm` of every node. The
/// grid must have a covered cell. The room ends half a pixel inside the raised piece, and reaches farther back than the
/// relief, so that no faces of the two coincide. Throws Error: cancelled.
PieceSolids piece_solids(const PieceGrid& grid, const ForestView& view, const WallSpace& space, double tolerance_mm,
                         Context& context);

}  // namespace formwright
