// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Room for the zipper: the ribbon's edges move inwards by the width of half the teeth and the gap, in the plane
// (sewing) or in space along the zipper's binormal (gluing). Thesis Sec. 5.3.1, Appendix C.
#include <vector>

#include "zippable/flat_design.h"
#include "zippable/plan/pieces/plan_options.h"

namespace formwright {

struct ZipperModel {
  double tape_width_mm = 0, teeth_width_mm = 0, gap_mm = 0;
  double offset_mm() const { return teeth_width_mm / 2 + gap_mm; }
};

/// The coil's widths, or those given instead.
ZipperModel zipper_model(const PlanOptions& options);

struct BinormalField {
  std::vector<Vec3> left;    // per point: unit vectors to the left of the path
  std::vector<char> usable;  // per point: 0 where the binormal stands off the surface or the path is straight;
                             // `left_on_surface` is there
};

/// Of a polyline in space. The binormal is the cross product of the path behind and ahead over `window_mm` each (at
/// least one segment), over more where it is nearly straight, pointing left. Along every stretch where it is usable,
/// offsets to both sides are then made equally long, segment by segment, to rounding, by the smallest change of the
/// directions in the sense of least squares. `left_on_surface`: per point, a unit vector along the surface.
BinormalField binormals(const std::vector<Vec3>& points_mm, const std::vector<Vec3>& left_on_surface, double window_mm);

struct OffsetRibbon {
  std::vector<Vec2> flat_mm;         // per boundary vertex, counter-clockwise triangles
  std::vector<double> offset_share;  // per sample: 1, or less where the ribbon is too narrow for the zipper
  int narrow_samples = 0;            // how many of those
  double narrow_mm = 0;              // length of the zipper at those
  double min_share = 1;
  double left_mm = 0, right_mm = 0;  // lengths of the moved sides
  double binormal_share = 0;         // of the zipper's length; gluing
  bool sides_made_equal = false;     // along the whole zipper, by a change of the steps of at most the offset; gluing
  double shear_max_mm = 0;           // the largest such change, nearly all of it along the zipper
  double offset_mean_mm = 0;         // over the samples
};

/// Every triangle keeps its orientation and a tenth of its area; where it would not, the zipper moves closer to the
/// edge. An offset below 0 moves
/// the edges outwards, in the plane only. Throws Error{invalid_input, "coil"} when less than half of the offset has
/// room on the average, "seam_take_up_mm" for an offset below 0 where the zipper is glued.
OffsetRibbon offset_ribbon(const FlatDesign& design, ZipperOffset method, double offset_mm);

}  // namespace formwright
