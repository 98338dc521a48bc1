// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/zipping/zipper_hinges.h"

namespace formwright {

std::vector<ClothHinge> zipper_hinges(const RibbonPattern& pattern, double bending_n_mm2) {
  std::vector<ClothHinge> hinges;
  const std::vector<SeamPair>& seams = pattern.seams;
  for (std::size_t i = 1; i + 1 < seams.size(); ++i) {
    const double before = seams[i].along_mm - seams[i - 1].along_mm, after = seams[i + 1].along_mm - seams[i].along_mm;
    if (!(before > 0) || !(after > 0)) continue;  // a stretch ends here
    for (const auto side : {&SeamPair::left, &SeamPair::right}) {
      ClothHinge hinge;
      // The two that share no edge stand last: the system couples these for a hinge.
      hinge.vertex = {seams[i].*side, seams[i].*side, seams[i - 1].*side, seams[i + 1].*side};
      hinge.weight << -1 / before - 1 / after, 0, 1 / before, 1 / after;
      hinge.stiffness_n_per_mm = 0.5 * bending_n_mm2 / (0.5 * (before + after));
      hinges.push_back(hinge);
    }
  }
  return hinges;
}

}  // namespace formwright
