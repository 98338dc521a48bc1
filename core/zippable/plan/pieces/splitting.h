// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The flat ribbon divided at few of its rulings into pieces that do not overlap themselves and fit the bed. Thesis
// Sec. 5.2.4.
#include <functional>
#include <vector>

#include "base/context.h"
#include "fabrication/planar/polygon.h"

namespace formwright {

struct RibbonSplit {
  int from = 0, to = 0;     // vertices of the cut edge; piece `left` lies to the left of the direction from -> to
  int left = 0, right = 0;  // pieces
};

struct Splitting {
  int merged_crumbs = 0, moved_splits = 0;  // small pieces that were joined to a neighbour, or grew at its cost
  int piece_count = 0;
  std::vector<int> piece_of_face;
  std::vector<RibbonSplit> splits;  // as they follow each other on the boundary
};

/// `F`: a disc with all vertices on its boundary, which runs through them in order, triangles counter-clockwise at
/// `flat_mm`. `fits`: may a piece with this convex hull be cut? Pieces grow from the ribbon's ends, joined where it
/// branches as long as they stay valid: on a ribbon without branches no division has fewer. Of several ends to grow
/// towards, the one with the fewest pieces is taken, then with the largest smallest piece. Windings of a piece that are
/// far apart along the boundary keep `clearance_mm`. Pieces smaller than `min_area_mm2` are then joined to a neighbour
/// if the two may be one piece, or else grow at its cost until they are that large, unless it would become too small
/// itself or fall apart where the ribbon branches. With `kind_of_face` (as long as `F`; empty: all alike) a piece has
/// triangles of one kind only. Throws Error: invalid_input ("bed_x_mm": a single triangle does not fit), cancelled.
Splitting split_ribbon(const Triangles& F, const std::vector<Vec2>& flat_mm,
                       const std::function<bool(const Polygon&)>& fits, double clearance_mm, double min_area_mm2,
                       Context& context, const std::vector<int>& kind_of_face = {});

}  // namespace formwright
