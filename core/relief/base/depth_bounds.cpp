// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/base/depth_bounds.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <string>

#include "base/parallel.h"
#include "relief/base/painted_bounds.h"

namespace formwright {
namespace {

constexpr std::size_t vertices_a_chunk = 2048;

void refuse_misses(const DepthBounds& bounds, int asked, const ReliefOptions& options) {
  if (bounds.missed == asked)
    throw Error(
        ErrorCode::invalid_input, "base_mesh",
        "No line of sight to the model meets the base: move the base behind the model, with the middle of the relief at its x = y = 0.");
  if (bounds.missed > 0 && options.base_misses == BaseMisses::refused)
    throw Error(
        ErrorCode::invalid_input, "base_misses",
        "The base ends before the model does: " + std::to_string(bounds.missed) + " of " + std::to_string(asked) +
            " vertices have no base behind them. Make the base larger, the relief narrower, or let these vertices go free.");
}

}  // namespace

DepthBounds depth_bounds(const ViewFrame& frame, const Visibility& visibility, const BaseSurface& base,
                         const ReliefOptions& options, Context& context, const Painting& given) {
  Painting with_free;
  if (options.only_outline) with_free = free_within_outline(given, visibility);
  const Painting& painting = options.only_outline ? with_free : given;
  const auto n = static_cast<std::size_t>(frame.P.rows());
  const double thickness = options.thickness_mm / options.width_mm, carve = options.carve_depth_mm / options.width_mm;
  DepthBounds bounds;
  bounds.nearest = Eigen::VectorXd::Constant(frame.P.rows(), -thickness);
  bounds.farthest = Eigen::VectorXd::Constant(frame.P.rows(), carve);
  bounds.bounded.assign(n, 1);
  if (options.bounded_vertices == BoundedVertices::visible) bounds.bounded = visibility.vertex;
  if (painting.bounds_depth()) set_painted_room(painting, options, bounds);
  bounds.group.assign(n, 0);
  bounds.above = thickness;
  bounds.below = carve;
  const BaseBands* const bands = base.bands();
  if (bands != nullptr) bounds.groups = bands->count();
  const double outline = options.outline_mm.value_or(options.only_outline ? 0 : INFINITY) / options.width_mm;
  const bool tied = outline < std::max(thickness, carve);
  const bool painted = bounds.above_of.size() > 0;
  bounds.even = base.is_flat() && !tied && !painted;
  // What is painted goes before the outline.
  const auto is_tied = [&](std::size_t i) {
    return tied && visibility.outline[i] && painting.region_of(static_cast<Eigen::Index>(i)) == PaintedRegion::usual;
  };
  // Depths before and behind the base, of one vertex.
  const auto above = [&](std::size_t i) {
    const double own = painted ? bounds.above_of[static_cast<Eigen::Index>(i)] : thickness;
    return is_tied(i) ? std::min(own, outline) : own;
  };
  const auto below = [&](std::size_t i) {
    const double own = painted ? bounds.below_of[static_cast<Eigen::Index>(i)] : carve;
    return is_tied(i) ? std::min(own, outline) : own;
  };
  for (std::size_t i = 0; tied && i < n; ++i)
    if (is_tied(i)) bounds.bounded[i] = 1;
  if (base.is_flat() && tied)
    for (std::size_t i = 0; i < n; ++i) {
      bounds.nearest[static_cast<Eigen::Index>(i)] = -above(i);
      bounds.farthest[static_cast<Eigen::Index>(i)] = below(i);
    }
  if (!base.is_flat()) {
    std::atomic<int> missed = 0;
    parallel_for(n, vertices_a_chunk, [&](std::size_t begin, std::size_t end) {
      context.check_cancelled();
      for (std::size_t i = begin; i < end; ++i) {
        const auto vertex = static_cast<Eigen::Index>(i);
        const auto nearest = base.depth_on_ray(frame, vertex, -above(i)),
                   farthest = base.depth_on_ray(frame, vertex, below(i));
        if (bands != nullptr) bounds.group[i] = bands->of_ray(frame, frame.P.row(vertex).transpose());
        if (nearest && farthest) {
          bounds.nearest[vertex] = *nearest;
          bounds.farthest[vertex] = std::max(*nearest, *farthest);
        } else if (bounds.bounded[i]) {
          bounds.bounded[i] = 0;
          if (painting.region_of(vertex) != PaintedRegion::free) ++missed;
        }
      }
    });
    bounds.missed = missed;
    const auto held = static_cast<int>(std::ranges::count(bounds.bounded, 1));
    refuse_misses(bounds, held + bounds.missed, options);
  }
  if (frame.kappa * -bounds.nearest.minCoeff() >= 0.5)
    throw Error(
        ErrorCode::invalid_input, base.is_flat() ? "thickness_mm" : "base",
        "The relief would extend more than half-way to the viewpoint: choose a smaller thickness or a larger viewing distance.");
  if (bounds.above_of.size() > 0) open_free_regions(frame, painting, bounds);
  return bounds;
}

}  // namespace formwright
