// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/tiles/tile_grid.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "geometry/queries/ray_caster.h"

namespace formwright {
namespace {

constexpr std::size_t rows_a_chunk = 8;
constexpr double max_nodes = 16e6;
// Rays of the outermost nodes start this share of the way to the tile's middle: its surface ends on its outline.
constexpr double inwards = 1e-6;

int steps_of(double length_mm, double pixel_mm) {
  return std::max(1, static_cast<int>(std::ceil(length_mm / pixel_mm - 1e-9)));
}

/// Where the line x = `at` enters and leaves a convex polygon.
Vec2 ends_at(const std::vector<Vec2>& outline, double at) {
  Vec2 ends(INFINITY, -INFINITY);
  const auto add = [&](double y) { ends = {std::min(ends[0], y), std::max(ends[1], y)}; };
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const Vec2 &p = outline[k], &q = outline[(k + 1) % outline.size()];
    if (p.x() == at) add(p.y());
    if ((p.x() < at && q.x() > at) || (p.x() > at && q.x() < at))
      add(p.y() + (q.y() - p.y()) * ((at - p.x()) / (q.x() - p.x())));
  }
  return ends;
}

/// Places of the corners, each once. Corners at one place get exactly the same one.
std::vector<double> corner_places(std::vector<Vec2>& outline) {
  std::vector<double> places;
  for (const Vec2& p : outline) places.push_back(p.x());
  std::ranges::sort(places);
  const double close = 1e-9 * (places.back() - places.front());
  const auto again = std::ranges::unique(places, [&](double a, double b) { return b - a <= close; });
  places.erase(again.begin(), again.end());
  for (Vec2& p : outline)
    for (const double place : places)
      if (std::abs(p.x() - place) <= close) p.x() = place;
  return places;
}

TileGrid empty_grid(const ReliefTile& tile, double pixel_mm) {
  std::vector<Vec2> outline = tile.outline;
  const std::vector<double> corners = corner_places(outline);
  double longest = 0, columns = 1;
  for (const double at : corners) {
    const Vec2 ends = ends_at(outline, at);
    longest = std::max(longest, ends[1] - ends[0]);
  }
  for (std::size_t k = 1; k < corners.size(); ++k) columns += std::ceil((corners[k] - corners[k - 1]) / pixel_mm);
  if (columns * (longest / pixel_mm + 2) > max_nodes)
    throw Error(ErrorCode::invalid_input, "pixel_mm",
                "A piece would have more than 16 million points: raise the detail spacing (pixel_mm) or lower the "
                "width.");
  TileGrid grid;
  grid.rows = steps_of(longest, pixel_mm) + 1;
  const auto add = [&](double at) {
    const Vec2 ends = ends_at(outline, at);
    const auto is_corner = [&](double y) { return std::ranges::find(outline, Vec2(at, y)) != outline.end(); };
    grid.x_mm.push_back(at);
    grid.low_mm.push_back(ends[0]);
    grid.high_mm.push_back(ends[1]);
    grid.low_corner.push_back(is_corner(ends[0]));
    grid.high_corner.push_back(is_corner(ends[1]));
  };
  for (std::size_t k = 0; k < corners.size(); ++k) {
    if (k > 0) {
      const int steps = steps_of(corners[k] - corners[k - 1], pixel_mm);
      for (int s = 1; s < steps; ++s) add(corners[k - 1] + (corners[k] - corners[k - 1]) * s / steps);
    }
    add(corners[k]);
  }
  grid.height_mm.assign(grid.x_mm.size() * static_cast<std::size_t>(grid.rows), 0.0);
  return grid;
}

}  // namespace

TileGrid tile_grid(const ReliefTile& tile, const TriangleMesh& surface, const TileRoom& room, double pixel_mm,
                   const Context& context) {
  TileGrid grid = empty_grid(tile, pixel_mm);
  if (surface.F.rows() == 0) return grid;
  const RayCaster caster(surface);
  const double reach = 4 * (surface.V.cwiseAbs().maxCoeff() + tile.upper().norm() + tile.lower().norm() +
                            tile.origin.norm() + room.above_mm + room.below_mm);
  const Vec2 middle = 0.5 * (tile.lower() + tile.upper());
  parallel_for(static_cast<std::size_t>(grid.rows), rows_a_chunk, [&](std::size_t begin, std::size_t end) {
    context.check_cancelled();
    for (std::size_t row = begin; row < end; ++row)
      for (int column = 0; column < grid.columns(); ++column) {
        const Vec2 place = grid.place(column, static_cast<int>(row));
        const Vec3 point = tile.on_plane(place + inwards * (middle - place)), back = tile.towards_eye(point);
        const Vec3 start = tile.eye ? *tile.eye : Vec3(point + reach * back);
        const auto hit = caster.first_hit(start, -back, 0, 2 * reach + (tile.eye ? (*tile.eye - point).norm() : 0));
        if (!hit) continue;
        const double height = tile.normal.dot(start - hit->distance * back - tile.origin);
        grid.height_mm[grid.node(column, static_cast<int>(row))] = std::clamp(height, -room.below_mm, room.above_mm);
      }
  });
  return grid;
}

}  // namespace formwright
