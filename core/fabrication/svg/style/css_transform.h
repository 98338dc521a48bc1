// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The transform properties of CSS (CSS Transforms 1 and 2, in the plane).
#include <Eigen/Geometry>
#include <optional>
#include <string_view>

#include "fabrication/svg/grammar/svg_grammar.h"

namespace formwright {

/// What per cents and origins of a transform are of: the viewport or the element's own box, in user units.
struct TransformBox {
  double x = 0, y = 0, width = 0, height = 0;
  double font_size = 16;
};

/// "translate(10px, 5%) rotate(30deg)". None when it is not well formed or leaves the plane.
std::optional<Eigen::Affine2d> read_css_transform(std::string_view text, const TransformBox& box);

/// The values of the properties translate, rotate and scale ("" for none), one after the other.
std::optional<Eigen::Affine2d> read_single_transforms(std::string_view translate, std::string_view rotate,
                                                      std::string_view scale, const TransformBox& box);

/// "50% 10px", "center", "right bottom": where the transform's fixed point is. None when it is not well formed.
std::optional<Vec2> read_transform_origin(std::string_view text, const TransformBox& box);

}  // namespace formwright
