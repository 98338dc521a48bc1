// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A relief on a base of several parts as numbered solids, one for each part that is seen.
#include "relief/base/relief_pieces.h"
#include "relief/parts/part_solid.h"
#include "relief/view/relief_options.h"

namespace formwright {

struct PartPiece {
  int part = 0;  // of BaseParts
  PartSolid solid;
  double depth_mm = 0;  // how far its foremost place lies behind that of the whole base
  Region outline_mm;    // from the front, straight on
};

/// In reading order, row by row: piece k has the number k + 1. `cut`: the relief as ReliefSolver leaves it on `parts`.
/// `tolerance_mm`, `numbered`: as tiled_relief has them.
/// Throws Error: invalid_input ("pixel_mm"; "base_mesh": parts that overlap), could_not_solve, cancelled.
std::vector<PartPiece> parted_relief(const BaseParts& parts, const ReliefPieces& cut, const ReliefOptions& options,
                                     double tolerance_mm, bool numbered, Context& context);

}  // namespace formwright
