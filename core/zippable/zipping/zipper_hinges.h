// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "zippable/zipping/cloth_energy.h"
#include "zippable/zipping/ribbon_pattern.h"

namespace formwright {

/// The zipper as a rod that is straight at rest, half of it on each side: energy B k^2 / 2 a length, the curvature k
/// from the change of direction between neighbouring edges over their mean length (Bergou, Wardetzky, Robinson,
/// Audoly, Grinspun 2008, "Discrete Elastic Rods"), quadratic in the positions because a zipper does not stretch.
std::vector<ClothHinge> zipper_hinges(const RibbonPattern& pattern, double bending_n_mm2);

}  // namespace formwright
