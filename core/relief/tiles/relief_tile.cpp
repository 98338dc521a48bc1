// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/tiles/relief_tile.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace formwright {
namespace {

constexpr double min_share = 1e-6;  // of the plate's front: what covers less is no tile

double twice_area(const std::vector<Vec2>& polygon) {
  double sum = 0;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vec2 &p = polygon[k], &q = polygon[(k + 1) % polygon.size()];
    sum += p.x() * q.y() - p.y() * q.x();
  }
  return sum;
}

/// The part of a convex polygon where `across` . p is at most `limit`, or with `beyond` at least.
std::vector<Vec2> clipped(const std::vector<Vec2>& polygon, const Vec2& across, double limit, bool beyond) {
  std::vector<Vec2> kept;
  const double side = beyond ? -1 : 1;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vec2 &p = polygon[k], &q = polygon[(k + 1) % polygon.size()];
    const double a = side * (across.dot(p) - limit), b = side * (across.dot(q) - limit);
    if (a <= 0) kept.push_back(p);
    if ((a < 0 && b > 0) || (a > 0 && b < 0)) kept.push_back(p + (q - p) * (a / (a - b)));
  }
  return kept;
}

/// The plane of a band, not yet cut.
ReliefTile plane_of(const ViewFrame& frame, const BaseBands& bands, int band, double size_mm) {
  ReliefTile tile;
  tile.band = band;
  const Vec2 across = bands.across();
  const double slope = bands.slope(band);
  // z is away from the viewer there and towards the viewer here.
  tile.normal = Vec3(slope * across.x(), slope * across.y(), 1).normalized();
  tile.origin = Vec3(0, 0, -size_mm * bands.depth(band));
  tile.up = (Vec3::UnitY() - tile.normal.y() * tile.normal).normalized();
  tile.right = tile.up.cross(tile.normal);
  if (frame.kappa > 0) tile.eye = Vec3(0, 0, size_mm / frame.kappa);
  return tile;
}

}  // namespace

Positions to_scene(const Positions& view_positions, double size_mm) {
  Positions scene = size_mm * view_positions;
  scene.col(2) *= -1;
  return scene;
}

Vec3 ReliefTile::towards_eye(const Vec3& point) const {
  return eye ? Vec3((*eye - point).normalized()) : Vec3(Vec3::UnitZ());
}

Vec3 ReliefTile::raised(const Vec2& place, double height_mm) const {
  const Vec3 point = on_plane(place);
  if (!eye) return point + Vec3(0, 0, height_mm / normal.z());
  return point + (*eye - point) * (height_mm / normal.dot(*eye - origin));
}

double ReliefTile::area_mm2() const { return 0.5 * twice_area(outline); }

Vec2 ReliefTile::lower() const {
  Vec2 low = outline.front();
  for (const Vec2& p : outline) low = low.cwiseMin(p);
  return low;
}

Vec2 ReliefTile::upper() const {
  Vec2 high = outline.front();
  for (const Vec2& p : outline) high = high.cwiseMax(p);
  return high;
}

double ReliefTile::turn_deg() const { return std::acos(std::min(1.0, normal.z())) * 180 / std::numbers::pi; }

std::vector<ReliefTile> relief_tiles(const ViewFrame& frame, const BaseBands& bands, PlateSize plate, double size_mm) {
  const double x = 0.5 * plate.width_mm, y = 0.5 * plate.height_mm;
  const std::vector<Vec2> front{{-x, -y}, {x, -y}, {x, y}, {-x, y}};
  std::vector<std::pair<Vec2, ReliefTile>> tiles;  // with the middle of its part of the picture
  double passed = -INFINITY;
  for (int band = 0; band < bands.count(); ++band) {
    std::vector<Vec2> seen = front;
    if (band > 0) seen = clipped(seen, bands.across(), passed, true);
    if (band + 1 < bands.count()) {
      // A nearer step may hide the next one as a whole.
      passed = std::max(passed, size_mm * bands.border_on_plate(frame, band));
      seen = clipped(seen, bands.across(), passed, false);
    }
    if (seen.size() < 3 || twice_area(seen) < 2 * min_share * plate.width_mm * plate.height_mm) continue;
    ReliefTile tile = plane_of(frame, bands, band, size_mm);
    Vec2 middle(0, 0);
    for (const Vec2& p : seen) {
      middle += p / static_cast<double>(seen.size());
      const Vec3 view(p.x() / size_mm, p.y() / size_mm, 0);
      const double z = bands.depth_on_ray(frame, band, view, 0), spread = 1 + frame.kappa * z;
      const Vec3 off = Vec3(p.x() * spread, p.y() * spread, -size_mm * z) - tile.origin;
      tile.outline.emplace_back(off.dot(tile.right), off.dot(tile.up));
    }
    tiles.emplace_back(middle, std::move(tile));
  }
  const bool side_by_side = std::abs(bands.across().x()) >= std::abs(bands.across().y());
  std::ranges::stable_sort(tiles, {}, [&](const auto& one) { return side_by_side ? one.first.x() : -one.first.y(); });
  std::vector<ReliefTile> in_order;
  for (auto& [middle, tile] : tiles) in_order.push_back(std::move(tile));
  return in_order;
}

}  // namespace formwright
