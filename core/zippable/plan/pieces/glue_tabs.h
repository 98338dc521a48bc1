// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Tabs to glue paper by, along one of the two edges of every seam: trapezes that overlap nothing. Thesis Sec. 5.4,
// Fig. 5.21.
#include <array>
#include <vector>

#include "base/context.h"
#include "zippable/plan/pieces/seams.h"

namespace formwright {

/// Its foot runs along the boundary of the ribbon, which lies to the left.
struct GlueTab {
  int piece = 0;
  bool left = true;                         // on which side of the zipper
  int from_edge = 0, to_edge = 0;           // of the boundary, where the foot begins and ends
  Vec2 foot_from{0, 0}, foot_to{0, 0};      // on these edges
  Vec2 corner_from{0, 0}, corner_to{0, 0};  // outside
  double from_mm = 0, to_mm = 0;            // along the zipper, from_mm < to_mm
};

struct GlueTabs {
  std::vector<GlueTab> tabs;  // in the zipper's order
  int shortened = 0;          // not as deep as asked for
  int left_out = 0;           // stretches without a tab: there was no room on either side
};

struct GlueTabOptions {
  double depth_mm = 5, length_mm = 15;
  double clearance_mm = 0.25;  // between cuts that are not neighbours
};

/// Every stretch of an edge (`SeamKind::edge`) is divided into tabs of at most `length_mm`, shorter where the edge is
/// curved. A tab stands on the left edge; where it would come too close to its own piece or another tab, on the right
/// one; where that is so there too, both are tried with 0.6 and 0.35 of the depth. Precondition: the ribbon's edges
/// have not been moved. Throws Error: cancelled.
GlueTabs make_glue_tabs(const FlatDesign& design, const std::vector<Vec2>& flat_mm, const Splitting& splitting,
                        const std::vector<Seam>& seams, const GlueTabOptions& options, const Context& context);

/// The two triangles of the tab, its foot taken as straight.
std::array<std::array<Vec2, 3>, 2> triangles_of(const GlueTab& tab);

}  // namespace formwright
