// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/shared/polygon_triangulation.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "geometry/planar/plane.h"

namespace formwright {
namespace {

// Sines below this count as straight, distances below it (of an edge) as on the edge: some hundred round-offs.
constexpr double tolerance = 1e-12;

}  // namespace

std::span<const std::array<int, 3>> PolygonTriangulator::triangulate(std::span<const Vec3> corners) {
  triangles_.clear();
  const int n = static_cast<int>(corners.size());
  if (n < 3) return triangles_;
  if (n == 3) {
    triangles_.push_back({0, 1, 2});
    return triangles_;
  }
  if (n == 4) {
    quadrangle(corners);
    return triangles_;
  }
  project(corners);
  classify();
  build_grid();
  tests_left_ = std::min(max_tests, std::max<std::int64_t>(tests_left_, 0) + tests_per_corner * n);
  heap_.clear();
  for (int i = 0; i < n; ++i) consider(i);
  while (alive_count_ > 3) {
    if (heap_.empty()) {
      // A corner can become an ear without its neighbours changing, when what was in its way has been clipped.
      tests_left_ -= n;
      int best = -1;
      for (int i = 0; i < n; ++i) {
        if (!alive_[static_cast<std::size_t>(i)]) continue;
        consider(i);
        if (best < 0 || quality(i) > quality(best)) best = i;
      }
      if (heap_.empty()) {
        // No ears: the polygon crosses itself, or what is left has no area. Take the most convex corner, unchecked.
        if (quality(best) <= tolerance) tests_left_ = 0;
        while (alive_count_ > 3 && heap_.empty()) {
          const int following = next_[static_cast<std::size_t>(best)];
          clip(best);
          if (tests_left_ > 0) break;
          best = following;
        }
        continue;
      }
    }
    std::pop_heap(heap_.begin(), heap_.end());
    const Candidate candidate = heap_.back();
    heap_.pop_back();
    const auto c = static_cast<std::size_t>(candidate.corner);
    if (alive_[c] && stamp_[c] == candidate.stamp) clip(candidate.corner);
  }
  int first = 0;
  while (!alive_[static_cast<std::size_t>(first)]) ++first;
  const int second = next_[static_cast<std::size_t>(first)];
  triangles_.push_back({first, second, next_[static_cast<std::size_t>(second)]});
  return triangles_;
}

void PolygonTriangulator::quadrangle(std::span<const Vec3> corners) {
  const Vec3 &a = corners[0], &b = corners[1], &c = corners[2], &d = corners[3];
  const Vec3 normal = (c - a).cross(d - b);
  const auto worse = [&](const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& s, const Vec3& t, const Vec3& u) {
    return std::min((q - p).cross(r - p).dot(normal), (t - s).cross(u - s).dot(normal));
  };
  const double by_ac = worse(a, b, c, a, c, d), by_bd = worse(a, b, d, b, c, d);
  // Lengths that differ by round-off must not make a regular grid's diagonals irregular.
  const bool bd_shorter = (d - b).squaredNorm() < 0.999 * (c - a).squaredNorm();
  const bool use_bd = by_ac > 0 && by_bd > 0 ? bd_shorter : by_bd > by_ac;
  if (use_bd) triangles_ = {{0, 1, 3}, {1, 2, 3}};
  else triangles_ = {{0, 1, 2}, {0, 2, 3}};
}

void PolygonTriangulator::project(std::span<const Vec3> corners) {
  const std::size_t n = corners.size();
  Vec3 normal = Vec3::Zero();
  for (std::size_t i = 1; i + 1 < n; ++i) normal += (corners[i] - corners[0]).cross(corners[i + 1] - corners[0]);
  if (!(normal.norm() > 0)) normal = Vec3::UnitZ();
  normal.normalize();
  int smallest = 0;
  normal.cwiseAbs().minCoeff(&smallest);
  const Vec3 u = normal.cross(Vec3::Unit(smallest)).normalized(), v = normal.cross(u);
  points_.resize(n);
  for (std::size_t i = 0; i < n; ++i) points_[i] = {(corners[i] - corners[0]).dot(u), (corners[i] - corners[0]).dot(v)};
}

void PolygonTriangulator::classify() {
  const std::size_t n = points_.size();
  previous_.resize(n), next_.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    previous_[i] = static_cast<int>((i + n - 1) % n);
    next_[i] = static_cast<int>((i + 1) % n);
  }
  stamp_.assign(n, 0), alive_.assign(n, 1), reflex_.assign(n, 0);
  alive_count_ = static_cast<int>(n);
  for (std::size_t i = 0; i < n; ++i) reflex_[i] = quality(static_cast<int>(i)) <= tolerance;
}

void PolygonTriangulator::build_grid() {
  Vec2 low = points_[0], high = points_[0];
  int count = 0;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    low = low.cwiseMin(points_[i]), high = high.cwiseMax(points_[i]);
    count += reflex_[i];
  }
  const int side = std::clamp(static_cast<int>(std::sqrt(count / 2.0)), 1, 1024);
  grid_columns_ = grid_rows_ = side;
  grid_origin_ = low;
  for (int k = 0; k < 2; ++k) grid_scale_[k] = high[k] > low[k] ? side / (high[k] - low[k]) : 0;

  const auto cell = [&](std::size_t i) {
    const Vec2 p = (points_[i] - grid_origin_).cwiseProduct(grid_scale_);
    const int x = std::clamp(static_cast<int>(p.x()), 0, grid_columns_ - 1);
    const int y = std::clamp(static_cast<int>(p.y()), 0, grid_rows_ - 1);
    return static_cast<std::size_t>(y * grid_columns_ + x);
  };
  grid_start_.assign(static_cast<std::size_t>(side * side) + 1, 0);
  for (std::size_t i = 0; i < points_.size(); ++i)
    if (reflex_[i]) ++grid_start_[cell(i) + 1];
  for (std::size_t i = 1; i < grid_start_.size(); ++i) grid_start_[i] += grid_start_[i - 1];
  grid_items_.resize(static_cast<std::size_t>(count));
  for (std::size_t i = points_.size(); i-- > 0;)
    if (reflex_[i]) grid_items_[static_cast<std::size_t>(--grid_start_[cell(i) + 1])] = static_cast<int>(i);
  // Filling from the back has moved each cell's start into the place after it.
  for (std::size_t i = 0; i + 1 < grid_start_.size(); ++i) grid_start_[i] = grid_start_[i + 1];
  grid_start_.back() = count;
}

/// Twice the area of the corner's triangle over its longest edge squared: at most sin 60°, not positive if reflex.
double PolygonTriangulator::quality(int corner) const {
  const auto c = static_cast<std::size_t>(corner);
  const Vec2 &a = points_[static_cast<std::size_t>(previous_[c])], &b = points_[c];
  const Vec2& d = points_[static_cast<std::size_t>(next_[c])];
  const double longest = std::max({(b - a).squaredNorm(), (d - b).squaredNorm(), (d - a).squaredNorm()});
  return longest > 0 ? cross(b - a, d - b) / longest : 0;
}

/// Whether another corner lies in, or on the edges of, this corner's triangle.
bool PolygonTriangulator::blocked(int corner) {
  const auto c = static_cast<std::size_t>(corner);
  const Vec2 &a = points_[static_cast<std::size_t>(previous_[c])], &b = points_[c];
  const Vec2& d = points_[static_cast<std::size_t>(next_[c])];
  const Vec2 low = a.cwiseMin(b).cwiseMin(d), high = a.cwiseMax(b).cwiseMax(d);
  const double slack = tolerance * std::max({(b - a).squaredNorm(), (d - b).squaredNorm(), (d - a).squaredNorm()});
  const Vec2 from = (low - grid_origin_).cwiseProduct(grid_scale_),
             to = (high - grid_origin_).cwiseProduct(grid_scale_);
  const int x0 = std::clamp(static_cast<int>(from.x() - 1e-6), 0, grid_columns_ - 1);
  const int x1 = std::clamp(static_cast<int>(to.x() + 1e-6), 0, grid_columns_ - 1);
  const int y0 = std::clamp(static_cast<int>(from.y() - 1e-6), 0, grid_rows_ - 1);
  const int y1 = std::clamp(static_cast<int>(to.y() + 1e-6), 0, grid_rows_ - 1);
  for (int y = y0; y <= y1; ++y) {
    const auto row = static_cast<std::size_t>(y * grid_columns_);
    const int begin = grid_start_[row + static_cast<std::size_t>(x0)];
    const int end = grid_start_[row + static_cast<std::size_t>(x1) + 1];
    tests_left_ -= 1 + end - begin;
    for (int k = begin; k < end; ++k) {
      const int other = grid_items_[static_cast<std::size_t>(k)];
      const auto o = static_cast<std::size_t>(other);
      if (!alive_[o] || !reflex_[o] || other == corner || other == previous_[c] || other == next_[c]) continue;
      const Vec2& p = points_[o];
      if (cross(b - a, p - a) < -slack || cross(d - b, p - b) < -slack || cross(a - d, p - d) < -slack) continue;
      if (p == a || p == b || p == d) continue;  // the other end of a keyhole
      return true;
    }
  }
  return false;
}

void PolygonTriangulator::consider(int corner) {
  const double q = quality(corner);
  const auto c = static_cast<std::size_t>(corner);
  reflex_[c] = reflex_[c] && q <= tolerance;
  if (q <= tolerance || (tests_left_ > 0 && blocked(corner))) return;
  heap_.push_back({q, corner, ++stamp_[c]});
  std::push_heap(heap_.begin(), heap_.end());
}

void PolygonTriangulator::clip(int corner) {
  const auto c = static_cast<std::size_t>(corner);
  const int before = previous_[c], after = next_[c];
  triangles_.push_back({before, corner, after});
  alive_[c] = 0;
  --alive_count_;
  next_[static_cast<std::size_t>(before)] = after;
  previous_[static_cast<std::size_t>(after)] = before;
  for (const int neighbour : {before, after}) {
    ++stamp_[static_cast<std::size_t>(neighbour)];
    consider(neighbour);
  }
}

}  // namespace formwright
