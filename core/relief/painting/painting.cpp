// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/painting/painting.h"

#include <algorithm>

namespace formwright {

bool Painting::bounds_depth() const {
  return std::ranges::any_of(region, [](PaintedRegion r) { return r != PaintedRegion::usual; });
}

Painting painting_of(const Painting& painting, const std::vector<int>& origin) {
  Painting result;
  const auto taken = [&](const Eigen::VectorXd& values) {
    return values.size() == 0 ? Eigen::VectorXd() : Eigen::VectorXd(values(origin));
  };
  result.weight = taken(painting.weight);
  result.thickness_mm = taken(painting.thickness_mm);
  result.carve_depth_mm = taken(painting.carve_depth_mm);
  if (!painting.region.empty())
    for (const int vertex : origin) result.region.push_back(painting.region[static_cast<std::size_t>(vertex)]);
  return result;
}

}  // namespace formwright
