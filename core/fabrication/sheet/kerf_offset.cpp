// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <polyclipping/clipper.hpp>

#include "fabrication/sheet/contours.h"

namespace formwright {
namespace {

constexpr double units_per_mm = 1e5;  // Clipper counts in whole numbers: hundredths of a micrometre

ClipperLib::Path to_clipper(const Polygon& polygon) {
  ClipperLib::Path path;
  for (const Vec2& p : polygon)
    path.emplace_back(std::llround(units_per_mm * p.x()), std::llround(units_per_mm * p.y()));
  return path;
}

}  // namespace

std::vector<Polygon> offset_polygon(const Polygon& polygon, double outward_mm, double tolerance_mm) {
  ClipperLib::Paths simple;
  ClipperLib::Path path = to_clipper(polygon);
  if (!ClipperLib::Orientation(path)) ClipperLib::ReversePath(path);
  ClipperLib::SimplifyPolygon(path, simple, ClipperLib::pftNonZero);
  ClipperLib::ClipperOffset offset(2, tolerance_mm * units_per_mm);
  offset.AddPaths(simple, ClipperLib::jtRound, ClipperLib::etClosedPolygon);
  ClipperLib::Paths moved;
  offset.Execute(moved, outward_mm * units_per_mm);
  std::vector<Polygon> result;
  for (ClipperLib::Path& one : moved) {
    ClipperLib::CleanPolygon(one, 10);  // points nearer than 0.1 um to their neighbours' line
    if (one.size() < 3) continue;
    Polygon out;
    for (const ClipperLib::IntPoint& p : one)
      out.emplace_back(static_cast<double>(p.X) / units_per_mm, static_cast<double>(p.Y) / units_per_mm);
    const auto nearest = std::min_element(out.begin(), out.end(), [&](const Vec2& a, const Vec2& b) {
      return (a - polygon.front()).squaredNorm() < (b - polygon.front()).squaredNorm();
    });
    std::rotate(out.begin(), nearest, out.end());
    result.push_back(std::move(out));
  }
  return result;
}

}  // namespace formwright
