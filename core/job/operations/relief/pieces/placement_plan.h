// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Where the pieces of a relief go: a drawing at true scale.
#include "fabrication/sheet/cut_sheet.h"
#include "relief/tiles/tiled_relief.h"

namespace formwright {

/// Three parts. From the front: the outline of every piece with its number. Across the base: bands that lie side by
/// side from above, with the viewer below, others from the side, with the viewer on the left; plates with their
/// numbers, and between strips a cross at every fold. A table: number, size of the solid, how far the piece's middle
/// lies behind the foremost place, and how far it is turned against the plate, positive where its right or upper side
/// is farther away. `pieces`: at least one.
CutSheet placement_plan(const std::vector<ReliefPiece>& pieces, const BaseBands& bands);

}  // namespace formwright
