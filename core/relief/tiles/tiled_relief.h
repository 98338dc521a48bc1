// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A relief on steps or strips as numbered solids, one for each step or strip.
#include "relief/base/relief_pieces.h"
#include "relief/tiles/tile_solid.h"
#include "relief/view/relief_options.h"

namespace formwright {

struct ReliefPiece {
  ReliefTile tile;
  TileSolid solid;
};

/// In reading order: piece k has the number k + 1. `cut`: the relief as ReliefSolver leaves it on `bands`.
/// `tolerance_mm`: how far larger triangles may leave the height at any node; `numbered`: sinks numbers into the backs.
/// Throws Error: invalid_input "pixel_mm", could_not_solve, cancelled.
std::vector<ReliefPiece> tiled_relief(const ViewFrame& frame, const BaseBands& bands, const ReliefPieces& cut,
                                      PlateSize plate, const ReliefOptions& options, double tolerance_mm, bool numbered,
                                      Context& context);

}  // namespace formwright
