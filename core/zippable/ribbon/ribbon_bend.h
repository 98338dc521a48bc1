// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How tightly the flat ribbon bends: the bound on the curve's curvature that thesis Sec. 5.4 asks for.
#include <optional>

#include "zippable/ribbon/ribbon.h"

namespace formwright {

struct RibbonBend {
  double radius_mm = 0;  // the least of the centre line
  int face = 0;          // the triangle there
};

/// The centre line runs through the middles of the rulings of the flat ribbon. Its radius at a place is that of the
/// circle through it and the places half a `width_mm` before and behind it. Where the ribbon branches and nearer than
/// that to its ends there is none. Nothing when the ribbon is nowhere long enough.
std::optional<RibbonBend> tightest_bend(const Ribbon& ribbon, double width_mm);

}  // namespace formwright
