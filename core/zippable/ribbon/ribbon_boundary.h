// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The walk around the ribbon: along the left side of the curve to its end, back along the right side, and along the
// openings that it touches on its way.
#include <map>
#include <vector>

#include "zippable/ribbon/ribbon.h"

namespace formwright {

class RibbonBoundary {
 public:
  RibbonBoundary(int part_count, const Parameterisation& parameterisation, const LineTracer& tracer,
                 const ZipperCurve& curve, double sample_mm, TapedCuts& cuts);

  /// A strip lies between a line and the next one of its part, towards larger x, which may be a period on.
  struct Strip {
    int left_line, right_line;
    int right_shift;                                // grid steps to add to the right line's grid
    double right_offset_mm;                         // the same in x
    std::vector<std::pair<int, int>> upper, lower;  // along openings: (grid, place on the boundary)
  };

  std::vector<RibbonVertex> vertices;
  std::vector<Strip> strips;
  std::vector<OpeningArc> arcs;  // as they follow each other on the boundary

  /// Place on the boundary of a line's sample, on the side where x is larger (below the line) or smaller (above it).
  int place(int line, std::size_t sample, bool larger_x) const;

 private:
  std::vector<int> grid_along(const OpeningArc& arc) const;
  void add_opening(OpeningArc& arc, std::vector<std::pair<int, int>>& ruled);
  void add_piece(std::size_t piece, bool left);

  const LineTracer& tracer_;
  const ZipperCurve& curve_;
  double sample_mm_;
  std::vector<int> left_place_, right_place_;  // per curve sample
};

}  // namespace formwright
