// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A ribbon cut from two fabrics that are joined flat and interleave when it is zipped up: thesis Fig. 5.4.
//
// A Fermat spiral is two bands side by side: one has the left side of the zipper along both of its edges, the other the
// right side. Left bands are cut from one fabric and right bands from the other, so that the zipper has another colour
// on either side wherever such bands lie beside each other. Between them the ribbon changes its fabric at a ruling.
#include <vector>

#include "zippable/ribbon/ribbon.h"

namespace formwright {

inline constexpr int fabric_count = 2;

struct FabricColours {
  std::vector<int> of_face;         // per triangle: 0, or 1
  int seams = 0;                    // rulings where one fabric is joined to the other
  double area_mm2[fabric_count]{};  // of each fabric
  double interleaved_share = 0;     // of the zipper's length: with another colour on either side
  bool has_bands = false;           // some band lies along one side of the zipper only
};

/// The cheapest colouring: a band of the other side's fabric costs its area, a seam its length times twice `width_mm`
/// (by dynamic programming over the tree of triangles). Without bands that interleave there is one seam that halves the
/// area. Needs a ribbon as `make_ribbon` gives it, of two triangles at least.
FabricColours two_fabrics(const Ribbon& ribbon, double width_mm);

}  // namespace formwright
