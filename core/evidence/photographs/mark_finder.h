// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Coded marks in a photograph.
#include <vector>

#include "evidence/photographs/mark_edges.h"

namespace formwright {

struct SeenMark {
  int number = 0;
  SquareCorners corners;  // back left, back right, front right, front left of the mark, wherever the camera stood
};

struct SeenMarks {
  std::vector<SeenMark> marks;  // every number once, in the order of numbers
  std::vector<int> mirrored;    // numbers that were read with left and right exchanged
  std::vector<int> blurred;     // numbers that were read, but whose edges are not clear enough to measure
  bool cut_short = false;       // more outlines than are looked at: a busy background
};

/// Dark quadrilaterals whose corners are refined and whose cells are read. Throws Error{cancelled}.
SeenMarks find_coded_marks(const LightPicture& picture, const Context& context);

}  // namespace formwright
