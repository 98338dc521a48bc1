// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Numbered marks at regular distances along the zipper, on both sides of the ribbon, and how long the sides are between
// them.
#include <vector>

#include "zippable/plan/pieces/zipper_offset.h"

namespace formwright {

struct SideMark {
  Vec2 flat_mm;        // on the moved edge
  Vec2 along, inward;  // unit vectors of the edge, the ribbon to the left of `along`
  int edge = 0;        // of the boundary, from this vertex to the next
};

/// The same place of the zipper on both sides.
struct Marker {
  int number = 0;           // from 0, the zipper's start
  double arclength_mm = 0;  // along the zipper
  SideMark left, right;
};

/// From one marker to the next, or to the zipper's end.
struct MarkerInterval {
  double zipper_mm = 0, left_mm = 0, right_mm = 0;  // tape, and the moved sides in the plane
};

struct Markers {
  std::vector<Marker> markers;
  std::vector<MarkerInterval> intervals;
};

/// At every multiple of `spacing_mm` along the zipper. Throws Error{invalid_input, "marker_spacing_mm"} above 9999 of
/// them.
Markers place_markers(const FlatDesign& design, const OffsetRibbon& ribbon, double spacing_mm);

/// The place on one moved side of the ribbon that belongs to a place of the zipper.
SideMark side_mark(const FlatDesign& design, const std::vector<Vec2>& flat_mm, bool left, double arclength_mm);

}  // namespace formwright
