// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Small pictures of pieces for the assembly sheet, from the same outlines that are cut.
#include <string>
#include <vector>

#include "imaging/drawing/drawing.h"
#include "zippable/plan/zippable_plan.h"

namespace formwright {

/// Strokes of the picture by what they show, in mm.
inline constexpr double left_edge_stroke_mm = 0.5, right_edge_stroke_mm = 0.25, outline_stroke_mm = 0.1,
                        seam_stroke_mm = 0.9;

/// A seam's number in a circle beside the edge, half-way along it.
struct SeamTag {
  int number = 0;
  bool left = true;
  double arclength_mm = 0;
};

struct PiecePicture {
  Drawing drawing;   // from the origin to its size
  double scale = 1;  // of the piece, at most 1
};

/// The piece as it lies on its sheet. The left edge of the zipper thick, the right one thin, splits dashed with their
/// letters, the outline with its allowances finest; numbers of markers as far apart as they can be read. `seam`: letter
/// of the split to show boldly, or empty. Precondition: width and height at least 30 mm.
PiecePicture picture_of_piece(const FlatDesign& design, const ZippablePlan& plan, int piece, const Vec2& size_mm,
                              const std::string& seam, const std::vector<SeamTag>& tags);

}  // namespace formwright
