// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// All seams of a zippable in the order in which they are sewn or glued, thesis Sec. 5.3.1: first the splits, flat, then
// the edges.
#include <string>
#include <vector>

#include "zippable/plan/pieces/tape_runs.h"

namespace formwright {

enum class SeamKind {
  join,  // two pieces at a split
  tape,  // a tape along a piece
  edge   // two edges of paper, where there is no zipper
};

struct Seam {
  SeamKind kind = SeamKind::join;
  std::string letters = "";                // of the split
  int piece = 0, other_piece = 0;          // the same for a tape; an edge's left and right side
  bool left = true;                        // side of a tape
  double from_mm = 0, to_mm = 0;           // along the zipper
  double cloth_mm = 0;                     // edge of the piece (a split's length; the left edge of an edge)
  int first_marker = 0, last_marker = -1;  // the first above the last: none

  double tape_mm() const { return to_mm - from_mm; }
};

/// Joins grow from the piece where the zipper begins, so that there is always one thing in the maker's hands. Then the
/// left tape and the right one along the zipper; or, without tape, edges stretch by stretch, each between the same two
/// pieces.
std::vector<Seam> seams_in_order(const Splitting& splitting, const std::vector<Vec2>& flat_mm,
                                 const std::vector<TapeRun>& runs, const Markers& markers, bool tape);

}  // namespace formwright
