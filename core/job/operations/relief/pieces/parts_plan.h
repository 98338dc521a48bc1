// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Where the parts of a base go: a drawing at true scale.
#include "fabrication/sheet/cut_sheet.h"
#include "relief/parts/parted_relief.h"

namespace formwright {

/// Four parts. The outlines of all pieces with their numbers from the front, from above with the viewer below, and from
/// the right with the viewer on the left, so that the same place stands at the same height or above itself. A table:
/// number, size of the solid, how far its foremost place lies behind that of the whole base, and how far its left and
/// lower ends are from those of the whole. `pieces`: at least one.
CutSheet parts_plan(const std::vector<PartPiece>& pieces);

}  // namespace formwright
