// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Numbered marks on a flat sheet at true size, to draw or transfer before it is formed.
#include <string>
#include <vector>

#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

struct MarksDrawing {
  Vec2 sheet_mm, opening_mm;   // width and length of the sheet, and of the clamp opening in its middle
  std::vector<Vec2> marks_mm;  // from the sheet's centre, x to the right, y to the back
  int first_number = 1;
};

/// SVG in millimetres, as seen from above: outline of the sheet, clamp opening dashed, centre lines, a numbered cross
/// for each mark.
std::string marks_svg(const MarksDrawing& drawing);

}  // namespace formwright
