// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/planar/polygon.h"

#include <algorithm>
#include <cmath>

#include "geometry/planar/plane.h"

namespace formwright {

double signed_area_mm2(const Polygon& polygon) {
  double twice = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i)
    twice += cross(polygon[i] - polygon[0], polygon[(i + 1) % polygon.size()] - polygon[0]);
  return twice / 2;
}

Polygon convex_hull(std::vector<Vec2> points) {
  const auto before = [](const Vec2& a, const Vec2& b) { return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y()); };
  std::sort(points.begin(), points.end(), before);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  const std::size_t count = points.size();
  if (count < 3) return points;
  Polygon hull(2 * count);
  std::size_t k = 0;
  const auto add = [&](const Vec2& p, std::size_t minimum) {
    while (k >= minimum && cross(hull[k - 1] - hull[k - 2], p - hull[k - 2]) <= 0) --k;
    hull[k++] = p;
  };
  for (std::size_t i = 0; i < count; ++i) add(points[i], 2);
  const std::size_t lower = k + 1;
  for (std::size_t i = count - 1; i-- > 0;) add(points[i], lower);
  hull.resize(k - 1);
  return hull;
}

std::vector<Vec2> offset_steps(const Polygon& polygon, const std::vector<double>& left_mm) {
  const std::size_t count = polygon.size();
  std::vector<Vec2> normals(count), steps(count, Vec2::Zero());
  const auto normal_of = [&](std::size_t i) {
    const Vec2 along = polygon[(i + 1) % count] - polygon[i];
    const double length = along.norm();
    return length > 0 ? Vec2(-along.y() / length, along.x() / length) : Vec2(0, 0);
  };
  for (std::size_t i = 0; i < count; ++i) normals[i] = normal_of(i);
  // An edge without length takes part as the next one that has some.
  for (std::size_t i = 2 * count; i-- > 0;)
    if (normals[i % count].isZero()) normals[i % count] = normals[(i + 1) % count];
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t before = (i + count - 1) % count;
    const Vec2 &m = normals[before], &n = normals[i];
    const double d = left_mm[before], e = left_mm[i], limit = 2 * std::max(std::abs(d), std::abs(e));
    if (limit == 0) continue;
    // The step x has m . x = d and n . x = e.
    const double sine = cross(m, n);
    if (std::abs(sine) > 1e-9) steps[i] = Vec2(d * n.y() - e * m.y(), e * m.x() - d * n.x()) / sine;
    else steps[i] = (d * m + e * n) / 2;
    // Along nearly straight stretches with one distance both formulas agree; the first one is short of digits there.
    if (d == e && m.dot(n) > 0) steps[i] = (m + n) * (d / (1 + m.dot(n)));
    if (const double length = steps[i].norm(); length > limit) steps[i] *= limit / length;
  }
  return steps;
}

bool triangles_overlap(const std::array<Vec2, 3>& a, const std::array<Vec2, 3>& b, double touching_mm) {
  const auto apart = [&](const std::array<Vec2, 3>& of, const std::array<Vec2, 3>& other) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec2 along = of[(k + 1) % 3] - of[k];
      const double length = along.norm();
      if (!(length > 0)) continue;
      const Vec2 normal(-along.y() / length, along.x() / length);
      double low = 1e300, high = -1e300, other_low = 1e300, other_high = -1e300;
      for (std::size_t i = 0; i < 3; ++i) {
        const double x = normal.dot(of[i] - of[k]), y = normal.dot(other[i] - of[k]);
        low = std::min(low, x), high = std::max(high, x), other_low = std::min(other_low, y),
        other_high = std::max(other_high, y);
      }
      if (std::min(high, other_high) - std::max(low, other_low) <= touching_mm) return true;
    }
    return false;
  };
  return !apart(a, b) && !apart(b, a);
}

}  // namespace formwright
