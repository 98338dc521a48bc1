// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Dark quadrilaterals on a lighter ground, as outlines of printed marks are.
#include <array>
#include <vector>

#include "imaging/picture/light_picture.h"

namespace formwright {

struct DarkQuads {
  std::vector<std::array<Vec2, 4>> corners_px;  // clockwise in the picture, to about two pixels; one may occur twice
  bool cut_short = false;                       // there were more than are returned
};

/// Outlines of four corners that are darker than their surroundings, with windows for large and small ones (OpenCV:
/// adaptiveThreshold, findContours [SA85], approxPolyDP [DP73]), in the picture reduced by a whole number to 4096
/// pixels. At most 40,000. Throws Error{cancelled}.
DarkQuads find_dark_quads(const LightPicture& picture, const Context& context);

}  // namespace formwright
