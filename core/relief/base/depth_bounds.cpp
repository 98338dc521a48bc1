// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/base/depth_bounds.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <string>
#include <tuple>

#include "base/parallel.h"
#include "relief/base/painted_bounds.h"
#include "relief/view/straight_view.h"

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

struct MetPart {
  int part;
  std::optional<Vec2> limits;  // nearest and farthest depth; nothing on a face that carries no relief
};
std::optional<MetPart> part_on_ray(const BaseParts& parts, const ViewFrame& frame, Eigen::Index vertex, double above,
                                   double below) {
  const Vec3 p = frame.P.row(vertex).transpose();
  const Vec2 on_plate = straightened(p, frame.kappa).head<2>();
  const auto hit = parts.foremost(on_plate);
  if (!hit) return std::nullopt;
  if (!hit->carries) return MetPart{hit->part, std::nullopt};
  const auto passage = parts.passage(hit->part, on_plate);
  if (!passage) return std::nullopt;
  return MetPart{hit->part, BaseParts::limits(*passage, above, below)};
}

/// What lies beside all that carries is left out in the end. Free, it could go to any depth and take what is held with
/// it: so it moves with the part whose picture is nearest, within that part's depths.
void hold_beside(const BaseParts& parts, const ViewFrame& frame, const std::vector<char>& beside, DepthBounds& bounds) {
  struct Space {
    Vec2 low, high;  // of the box of what is seen of it
    double nearest = INFINITY, farthest = -INFINITY;
  };
  std::vector<Space> spaces(static_cast<std::size_t>(parts.count()));
  for (int part = 0; part < parts.count(); ++part) {
    Space& space = spaces[static_cast<std::size_t>(part)];
    if (!parts.seen(part).empty()) std::tie(space.low, space.high) = parts.seen(part).box();
  }
  for (std::size_t i = 0; i < beside.size(); ++i) {
    if (!bounds.bounded[i]) continue;
    Space& space = spaces[static_cast<std::size_t>(bounds.group[i])];
    space.nearest = std::min(space.nearest, bounds.nearest[static_cast<Eigen::Index>(i)]);
    space.farthest = std::max(space.farthest, bounds.farthest[static_cast<Eigen::Index>(i)]);
  }
  for (std::size_t i = 0; i < beside.size(); ++i) {
    if (!beside[i]) continue;
    const auto vertex = static_cast<Eigen::Index>(i);
    const Vec3 p = frame.P.row(vertex).transpose();
    const Vec2 on_plate = straightened(p, frame.kappa).head<2>();
    double least = INFINITY;
    for (std::size_t k = 0; k < spaces.size(); ++k) {
      const Space& space = spaces[k];
      if (!(space.nearest < space.farthest)) continue;
      const double away = (on_plate - on_plate.cwiseMax(space.low).cwiseMin(space.high)).norm();
      if (!(away < least)) continue;
      least = away;
      bounds.group[i] = static_cast<int>(k);
      bounds.nearest[vertex] = space.nearest;
      bounds.farthest[vertex] = space.farthest;
      bounds.bounded[i] = 1;
    }
  }
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
  if (base.parts() != nullptr) bounds.groups = base.parts()->count();
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
    std::vector<char> beside(n, 0);  // of what carries
    parallel_for(n, vertices_a_chunk, [&](std::size_t begin, std::size_t end) {
      context.check_cancelled();
      for (std::size_t i = begin; i < end; ++i) {
        const auto vertex = static_cast<Eigen::Index>(i);
        std::optional<double> nearest, farthest;
        if (base.parts() != nullptr) {
          if (const auto met = part_on_ray(*base.parts(), frame, vertex, above(i), below(i))) {
            bounds.group[i] = met->part;
            if (met->limits) {
              nearest = (*met->limits)[0];
              farthest = (*met->limits)[1];
            } else if (bounds.bounded[i]) {
              bounds.bounded[i] = 0;
              beside[i] = 1;
            }
          }
        } else {
          nearest = base.depth_on_ray(frame, vertex, -above(i));
          farthest = base.depth_on_ray(frame, vertex, below(i));
        }
        if (bands != nullptr) bounds.group[i] = bands->of_ray(frame, frame.P.row(vertex).transpose());
        if (nearest && farthest) {
          bounds.nearest[vertex] = *nearest;
          bounds.farthest[vertex] = std::max(*nearest, *farthest);
        } else if (bounds.bounded[i]) {
          bounds.bounded[i] = 0;
          if (painting.region_of(vertex) == PaintedRegion::free) continue;
          ++missed;
          beside[i] = 1;
        }
      }
    });
    bounds.missed = missed;
    const auto held =
        static_cast<int>(std::ranges::count(bounds.bounded, 1) + std::ranges::count(beside, 1)) - bounds.missed;
    refuse_misses(bounds, held + bounds.missed, options);
    if (base.parts() != nullptr) hold_beside(*base.parts(), frame, beside, bounds);
  }
  if (frame.kappa * -bounds.nearest.minCoeff() >= 0.5)
    throw Error(
        ErrorCode::invalid_input, base.is_flat() ? "thickness_mm" : "base",
        "The relief would extend more than half-way to the viewpoint: choose a smaller thickness or a larger viewing distance.");
  if (bounds.above_of.size() > 0) open_free_regions(frame, painting, bounds);
  return bounds;
}

}  // namespace formwright
