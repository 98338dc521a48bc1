// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/parts/part_front.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "base/parallel.h"
#include "relief/right_triangle_network.h"
#include "relief/view/straight_view.h"

namespace formwright {
namespace {

constexpr double max_points = 16e6;
constexpr double border_share = 0.3;  // of the pitch, that inner points keep from the border: no slivers
constexpr std::size_t rows_a_chunk = 8, points_a_chunk = 1024;

class Sampler {
 public:
  Sampler(const BaseParts& parts, int part, const TriangleMesh& relief, const PartFrontOptions& options)
      : parts_(parts), part_(part), options_(options) {
    if (relief.F.rows() == 0) return;
    const TriangleMesh straight{straightened(relief.V, parts.kappa()), relief.F};
    caster_ = std::make_unique<RayCaster>(straight);
    front_ = straight.V.col(2).minCoeff() - 1;
    far_ = straight.V.col(2).maxCoeff() + 1 - front_;
  }

  FrontSample operator()(const Vec2& on_plate) const {
    FrontSample sample;
    const auto passage = parts_.passage(part_, on_plate);
    if (!passage) return sample;
    sample.base = sample.relief = passage->enters;
    sample.leaves = passage->leaves;
    if (!caster_) return sample;
    const auto hit = caster_->first_hit(Vec3(on_plate.x(), on_plate.y(), front_), Vec3::UnitZ(), 0, far_);
    if (!hit) return sample;
    const Vec2 limits = BaseParts::limits(*passage, options_.above, options_.below);
    sample.covered = true;
    sample.relief = std::clamp(depth_from_straight(front_ + hit->distance, parts_.kappa()), limits[0], limits[1]);
    return sample;
  }

 private:
  const BaseParts& parts_;
  int part_;
  const PartFrontOptions& options_;
  std::unique_ptr<RayCaster> caster_;
  double front_ = 0, far_ = 0;
};

/// Depths at the nodes of a grid, NaN outside the region and near its border.
struct Grid {
  int columns = 0, rows = 0;
  Vec2 low{0, 0}, pitch{0, 0};
  std::vector<float> depth;

  Vec2 place(int x, int y) const { return low + Vec2(pitch.x() * x, pitch.y() * y); }
  float at(GridNode p) const {
    return depth[static_cast<std::size_t>(p.y) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(p.x)];
  }
};

Grid sampled_grid(const Region& seen, const Sampler& sampler, double pitch, const Context& context) {
  Grid grid;
  const Region inner = grown(seen, -border_share * pitch);
  const auto [low, high] = seen.box();
  const Vec2 size = high - low, cells = (size / pitch).array().ceil().max(1);
  if ((cells.x() + 1) * (cells.y() + 1) > max_points)
    throw Error(
        ErrorCode::invalid_input, "pixel_mm",
        "A piece would have more than 16 million points: raise the detail spacing (pixel_mm) or lower the width.");
  grid.columns = static_cast<int>(cells.x()) + 1;
  grid.rows = static_cast<int>(cells.y()) + 1;
  grid.low = low;
  grid.pitch = size.cwiseQuotient(cells);
  grid.depth.assign(static_cast<std::size_t>(grid.columns) * static_cast<std::size_t>(grid.rows), NAN);
  parallel_for(static_cast<std::size_t>(grid.rows), rows_a_chunk, [&](std::size_t begin, std::size_t end) {
    context.check_cancelled();
    for (std::size_t row = begin; row < end; ++row) {
      const std::vector<double> crossings = inner.crossings(grid.place(0, static_cast<int>(row)).y());
      for (int x = 0; x < grid.columns; ++x) {
        const Vec2 place = grid.place(x, static_cast<int>(row));
        if ((std::ranges::upper_bound(crossings, place.x()) - crossings.begin()) % 2 == 0) continue;
        grid.depth[row * static_cast<std::size_t>(grid.columns) + static_cast<std::size_t>(x)] =
            static_cast<float>(sampler(place).relief);
      }
    }
  });
  return grid;
}

/// The nodes within that larger triangles need.
std::vector<Vec2> chosen_nodes(const Grid& grid, double tolerance, Context& context) {
  if (grid.columns < 2 || grid.rows < 2) return {};
  RightTriangleNetwork network(grid.columns, grid.rows, static_cast<float>(tolerance),
                               [&](GridNode a, GridNode b, GridNode m) -> float {
                                 const float at_a = grid.at(a), at_b = grid.at(b), at_m = grid.at(m);
                                 const int outside = std::isnan(at_a) + std::isnan(at_b) + std::isnan(at_m);
                                 if (outside == 3) return 0;
                                 return outside > 0 ? INFINITY : std::abs(0.5f * (at_a + at_b) - at_m);
                               });
  network.find_bounds(context);
  network.collect();
  std::vector<char> chosen(grid.depth.size(), 0);
  for (const GridNode& node : network.corners)
    if (node.x < grid.columns && node.y < grid.rows)
      chosen[static_cast<std::size_t>(node.y) * static_cast<std::size_t>(grid.columns) +
             static_cast<std::size_t>(node.x)] = 1;
  std::vector<Vec2> places;
  for (int y = 0; y < grid.rows; ++y)
    for (int x = 0; x < grid.columns; ++x)
      if (chosen[static_cast<std::size_t>(y) * static_cast<std::size_t>(grid.columns) + static_cast<std::size_t>(x)] &&
          !std::isnan(grid.at({x, y})))
        places.push_back(grid.place(x, y));
  return places;
}

}  // namespace

PartFront part_front(const BaseParts& parts, int part, const Region& seen, const TriangleMesh& relief,
                     const PartFrontOptions& options, Context& context) {
  PartFront front;
  if (seen.empty()) return front;
  const Sampler sampler(parts, part, relief, options);
  const Grid grid = sampled_grid(seen, sampler, options.pitch, context);
  front.net = triangles_of(seen, options.pitch, chosen_nodes(grid, options.tolerance, context));
  front.samples.resize(front.net.points.size());
  parallel_for(front.samples.size(), points_a_chunk, [&](std::size_t begin, std::size_t end) {
    context.check_cancelled();
    for (std::size_t i = begin; i < end; ++i) front.samples[i] = sampler(front.net.points[i]);
  });
  return front;
}

}  // namespace formwright
