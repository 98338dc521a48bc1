// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/ribbon/ribbon_bend.h"

#include <algorithm>
#include <cmath>

#include "geometry/planar/plane.h"
#include "geometry/mesh/adjacency.h"

namespace formwright {
namespace {

struct CentreLine {
  std::vector<Vec2> points;
  std::vector<int> faces;  // beyond each point
};

/// From branch to branch or end.
std::vector<CentreLine> centre_lines(const Ribbon& ribbon, const Adjacency& adjacency) {
  const auto sides = [&](int f) {
    int count = 0;
    for (int h = 3 * f; h < 3 * f + 3; ++h) count += adjacency.opposite(h) >= 0;
    return count;
  };
  const auto middle = [&](int h) {
    return Vec2((ribbon.flat_mm[adjacency.from(h)] + ribbon.flat_mm[adjacency.to(h)]) / 2);
  };
  std::vector<CentreLine> lines;
  std::vector<char> walked(std::size_t(3 * adjacency.face_count()), 0);
  for (int f = 0; f < adjacency.face_count(); ++f) {
    if (sides(f) == 2) continue;
    for (int start = 3 * f; start < 3 * f + 3; ++start) {
      if (adjacency.opposite(start) < 0 || walked[start]) continue;
      CentreLine line;
      for (int out = start; out >= 0;) {
        const int in = adjacency.opposite(out), next = in / 3;
        walked[out] = walked[in] = 1;
        line.points.push_back(middle(out));
        line.faces.push_back(next);
        out = -1;
        if (sides(next) == 2)
          for (int h = 3 * next; h < 3 * next + 3; ++h)
            if (h != in && adjacency.opposite(h) >= 0) out = h;
      }
      lines.push_back(std::move(line));
    }
  }
  return lines;
}

/// Of the circle through three points; infinite on a line.
double radius_through(const Vec2& a, const Vec2& b, const Vec2& c) {
  const Vec2 ab = b - a, ac = c - a;
  const double twice_area = std::abs(cross(ab, ac));
  return twice_area > 0 ? ab.norm() * (c - b).norm() * ac.norm() / (2 * twice_area) : 1e300;
}

}  // namespace

std::optional<RibbonBend> tightest_bend(const Ribbon& ribbon, double width_mm) {
  std::optional<RibbonBend> tightest;
  const double reach = width_mm / 2;
  for (const CentreLine& line : centre_lines(ribbon, Adjacency(ribbon.formed()))) {
    std::vector<double> along{0};
    for (std::size_t i = 0; i + 1 < line.points.size(); ++i)
      along.push_back(along.back() + (line.points[i + 1] - line.points[i]).norm());
    const auto at = [&](double place) {
      const auto next = std::clamp<std::ptrdiff_t>(std::upper_bound(along.begin(), along.end(), place) - along.begin(),
                                                   1, static_cast<std::ptrdiff_t>(along.size()) - 1);
      const double step = along[next] - along[next - 1], share = step > 0 ? (place - along[next - 1]) / step : 0;
      return Vec2(line.points[next - 1] + share * (line.points[next] - line.points[next - 1]));
    };
    for (std::size_t i = 0; i < along.size(); ++i) {
      if (along[i] < reach || along[i] > along.back() - reach) continue;
      const double radius = radius_through(at(along[i] - reach), line.points[i], at(along[i] + reach));
      if (!tightest || radius < tightest->radius_mm) tightest = {radius, line.faces[i]};
    }
  }
  return tightest;
}

}  // namespace formwright
