// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The corners of a black square on white to a small part of a pixel, and how sure they are.
#include <array>
#include <optional>

#include "imaging/picture/light_picture.h"

namespace formwright {

struct SquareCorners {
  std::array<Vec2, 4> corner_px;                  // in the order of the first guess
  std::array<Eigen::Matrix2d, 4> covariance_px2;  // from the scatter of the edges' points, and what no scatter shows
  /// Of the error, what every photograph as sharp as this has alike, so that it does not average out.
  std::array<double, 4> shared_px{};
};

/// Along every edge, profiles across it are searched for the place where the light is halfway between black and white;
/// a parabola is fitted to these places, robustly, because a square on a curved sheet has curved edges; neighbouring
/// parabolas are intersected. `first_px`: corners clockwise in the picture, within a cell of the true ones.
/// None where an edge is not seen well enough.
std::optional<SquareCorners> refine_square(const LightPicture& picture, const std::array<Vec2, 4>& first_px);

}  // namespace formwright
