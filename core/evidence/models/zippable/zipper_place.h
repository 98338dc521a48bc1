// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Where a numbered mark lies on a ribbon, and which lengths between marks can be measured.
#include <array>
#include <vector>

#include "evidence/models/zippable/measured_zippable.h"

namespace formwright {

/// The cloth of a ribbon with its vertices at x.
TriangleMesh cloth_mesh(const RibbonPattern& pattern, const Positions& x);

/// Between two pairs of places that the zipper brings together.
struct ZipperPlace {
  std::array<int, 2> pair{};  // indices into RibbonPattern::seams
  double share = 0;           // of the way from the first to the second

  /// A quantity of pairs, there. `at`: from a SeamPair to something that can be added and scaled.
  template <class At>
  Vec3 interpolate(const RibbonPattern& pattern, const At& at) const {
    return (1 - share) * at(pattern.seams[static_cast<std::size_t>(pair[0])]) +
           share * at(pattern.seams[static_cast<std::size_t>(pair[1])]);
  }
};

/// `along_mm`: of the zipper. Beyond an end, the end. Stretches that an opening interrupts follow each other. At least
/// one seam.
ZipperPlace zipper_place(const RibbonPattern& pattern, double along_mm);

/// Where a mark lies on the flat ribbon as designed.
Vec2 flat_place(const RibbonPattern& pattern, const ZipperMark& mark, double marker_spacing_mm);

/// How the piece on which a mark lies was turned on its sheet, radians.
double piece_turn(const RibbonPattern& pattern, const ZipperMark& mark, double marker_spacing_mm);

/// Lengths that a tape or calipers can take: at most about `zipped` straight through the zipped object, none shorter
/// than a tenth of its size, and `flat` on the flat pieces, across the ribbon and along it by turns, each within one
/// piece. With `sigma_mm`, and 0 as what was measured.
std::vector<MeasuredLength> measurable_lengths(const RibbonPattern& pattern, double marker_spacing_mm, int zipped,
                                               int flat, double sigma_mm);

}  // namespace formwright
