// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Texture coordinates and a painted texture for a coloured solid.
#include <functional>
#include <string>

#include "base/context.h"
#include "geometry/samples/shapes.h"

namespace formwright::samples {

/// Fills UV, FT, materials and textures of `model`. `broad_normal` is the direction in which the surface faces when
/// its fine detail is ignored; `colouring` is linear RGB; both take mesh coordinates. `pixels` is the side of the
/// texture. Every face lies inside [0, 1]^2; faces of one chart overlap by no more than the fine detail.
void paint_texture(Model& model, const std::function<Point(const Point&)>& broad_normal, const Colouring& colouring,
                   int pixels, const std::string& name, Context& context);

/// The texture of a height field: u along x, v against z, over a square of `side_mm` about the origin.
void paint_from_above(Model& model, double side_mm, const std::function<Point(double x, double z)>& colouring,
                      int pixels, const std::string& name, Context& context);

}  // namespace formwright::samples
