// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// One piece of a relief on steps or strips as a watertight solid.
#include "relief/tiles/tile_grid.h"

namespace formwright {

struct TileSolidOptions {
  TileRoom room;            // as the grid was made with
  double plate_mm = 3;      // behind what may be carved
  double tolerance_mm = 0;  // of heights, for larger triangles
  int number = 0;           // sunk into the back, with a mark that points up; 0: a plain back
};

/// From the relief to a flat back, parallel to the tile's plane; its sides lie in the planes through the viewpoint and
/// the edges of the tile, so that neighbours meet without a gap and do not overlap.
struct TileSolid {
  TriangleMesh mesh;     // lying on its back: x right, y up, z towards the viewer from the back; from 0, 0, 0
  Vec2 corner_mm{0, 0};  // place on the tile's plane, along `right` and `up`, of x = y = 0
  double back_mm = 0;    // how far the back lies behind the tile's plane
  double volume_mm3 = 0;
  bool numbered = false;  // there was room for the number
  bool watertight = false;
};

/// Throws Error: could_not_solve, cancelled.
TileSolid tile_solid(const ReliefTile& tile, const TileGrid& grid, const TileSolidOptions& options, Context& context);

/// The solid where it belongs: mm, x right, y up, z towards the viewer, the middle of the plate's front at 0.
TriangleMesh in_place(const TileSolid& solid, const ReliefTile& tile);

/// What is cut out of the back: prisms from `below` the back to their depth, lying as the solid does. Empty where there
/// is no room. `outline`: of the back, convex, seen from the front; `plate_mm`: what there is behind the tile.
std::vector<TriangleMesh> number_grooves(const std::vector<Vec2>& outline, int number, double plate_mm);

}  // namespace formwright
