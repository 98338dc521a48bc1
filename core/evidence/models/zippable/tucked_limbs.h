// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Limbs of the shape that a ribbon zips up into, and where they are in words.
#include <array>
#include <string>
#include <vector>

#include "zippable/parts/limbs.h"
#include "zippable/zipping/ribbon_pattern.h"

namespace formwright {

/// A ribbon as designed, with all seams and openings closed: one surface.
struct ClosedShape {
  TriangleMesh mesh;
  std::vector<int> vertex;  // of the mesh, per vertex of the ribbon
};
ClosedShape closed_shape(const RibbonPattern& pattern);

struct RibbonLimb {
  Limb limb;                                     // distances per vertex of the ribbon, tip in closed_shape()
  std::vector<std::array<double, 2>> zipper_mm;  // stretches of the zipper on it, from and to, in their order
};

/// At most ten limbs of the designed shape, in the order in which the zipper first comes to them. Throws cancelled.
std::vector<RibbonLimb> limbs_of(const RibbonPattern& pattern, Context& context);

/// Where a limb is: "with marks 12 to 17 and 40 to 44"; without a mark on it "340 mm along the zipper".
std::string limb_place(const RibbonLimb& limb, double marker_spacing_mm);

}  // namespace formwright
