// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "zippable/making/making_errors.h"
#include "zippable/zipping/ribbon_pattern.h"

namespace formwright {

/// The ribbon as it is sewn when the plan of `pattern`, which is as designed, was made with these errors: edges moved
/// in `flat` (by less where a triangle would lose nine tenths of its area), the cloth's own change in `cloth_change`.
/// Zipper and predicted places stay. Throws Error{could_not_solve} where the cloth is pulled so far askew that it has
/// no area.
RibbonPattern made_pattern(const RibbonPattern& pattern, const MakingErrors& errors);

/// Both ends of every edge on the ribbon's border, the cloth on its left.
std::vector<std::array<int, 2>> border_edges(const RibbonPattern& pattern);

/// Per vertex: where the slider passes it, and on which side; -1 off the zipper.
struct ZipperSides {
  std::vector<double> along_mm;
  std::vector<char> left;
  explicit ZipperSides(const RibbonPattern& pattern);
  /// Is this border edge sewn to the zipper? Openings, which lie between stretches of it, are not.
  bool zipper_edge(const RibbonPattern& pattern, int a, int b) const;
};

}  // namespace formwright
