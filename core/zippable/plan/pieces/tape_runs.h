// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Which stretch of which tape goes along which piece of cloth.
#include <string>
#include <vector>

#include "zippable/plan/pieces/markers.h"
#include "zippable/plan/pieces/splitting.h"

namespace formwright {

/// A stretch of one side of the zipper along one piece, between splits and openings.
struct TapeRun {
  bool left = true;
  int zipper_piece = 0;                    // from opening to opening
  int piece = 0;                           // of the splitting
  double from_mm = 0, to_mm = 0;           // along the zipper
  double cloth_mm = 0;                     // the piece's moved edge, in the plane
  int first_marker = 0, last_marker = -1;  // in it, in the zipper's order; the first above the last: none
  std::string splits = "";                 // letters of the splits that end at its beginning, "A" or "A-B"

  double tape_mm() const { return to_mm - from_mm; }
};

/// The faces beside the boundary's edges, by the edge's first vertex. Of a disc whose boundary runs through its
/// vertices in order.
std::vector<int> faces_of_boundary(const Triangles& F, int vertex_count);

/// All runs of the left side in the zipper's order, then all of the right side.
std::vector<TapeRun> tape_runs(const FlatDesign& design, const OffsetRibbon& ribbon, const Splitting& splitting,
                               const Markers& markers);

}  // namespace formwright
