// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/base/painted_bounds.h"

#include <algorithm>
#include <cmath>

namespace formwright {
namespace {

constexpr double max_way_to_viewpoint = 0.5;  // of the distance from the plate, as for every relief

double own_or(const Eigen::VectorXd& values, Eigen::Index vertex, double otherwise) {
  return values.size() > 0 && !std::isnan(values[vertex]) ? values[vertex] : otherwise;
}

}  // namespace

Painting free_within_outline(const Painting& painting, const Visibility& visibility) {
  Painting result = painting;
  result.region.resize(visibility.outline.size(), PaintedRegion::usual);
  for (std::size_t i = 0; i < result.region.size(); ++i)
    if (result.region[i] == PaintedRegion::usual && !visibility.outline[i]) result.region[i] = PaintedRegion::free;
  return result;
}

void set_painted_room(const Painting& painting, const ReliefOptions& options, DepthBounds& bounds) {
  bounds.above_of = -bounds.nearest;
  bounds.below_of = bounds.farthest;
  for (Eigen::Index i = 0; i < bounds.nearest.size(); ++i) {
    switch (painting.region_of(i)) {
      case PaintedRegion::usual:
      case PaintedRegion::free: continue;
      case PaintedRegion::on_base: bounds.above_of[i] = bounds.below_of[i] = 0; break;
      case PaintedRegion::own_thickness:
        bounds.above_of[i] = own_or(painting.thickness_mm, i, options.thickness_mm) / options.width_mm;
        bounds.below_of[i] = std::max(own_or(painting.carve_depth_mm, i, options.carve_depth_mm) / options.width_mm,
                                      -bounds.above_of[i]);
        break;
    }
    bounds.bounded[static_cast<std::size_t>(i)] = 1;
  }
  bounds.nearest = -bounds.above_of;
  bounds.farthest = bounds.below_of;
}

void open_free_regions(const ViewFrame& frame, const Painting& painting, DepthBounds& bounds) {
  bounds.reach = bounds.nearest;
  const double straight_on = std::max(1.0, frame.P.col(2).maxCoeff() - frame.P.col(2).minCoeff());
  for (Eigen::Index i = 0; i < bounds.reach.size(); ++i) {
    if (painting.region_of(i) != PaintedRegion::free) continue;
    bounds.reach[i] = frame.kappa > 0 ? std::min(bounds.nearest[i], -max_way_to_viewpoint / frame.kappa)
                                      : bounds.nearest[i] - straight_on;
    bounds.above_of[i] += bounds.nearest[i] - bounds.reach[i];
  }
}

}  // namespace formwright
