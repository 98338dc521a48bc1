// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/planar/thick_lines.h"

#include <algorithm>
#include <cmath>
#include <polyclipping/clipper.hpp>

namespace formwright {

std::vector<Polygon> outlines_of(const std::vector<ThickLine>& lines, double tolerance_mm) {
  constexpr double units_per_mm = 1e5;  // Clipper counts in whole numbers: hundredths of a micrometre
  ClipperLib::Clipper all;
  for (const ThickLine& line : lines) {
    ClipperLib::Path path;
    for (const Vec2& p : line.points_mm)
      path.emplace_back(std::llround(units_per_mm * p.x()), std::llround(units_per_mm * p.y()));
    ClipperLib::ClipperOffset offset(2, tolerance_mm * units_per_mm);
    offset.AddPath(path, ClipperLib::jtRound, ClipperLib::etOpenRound);
    ClipperLib::Paths thick;
    offset.Execute(thick, line.width_mm / 2 * units_per_mm);
    all.AddPaths(thick, ClipperLib::ptSubject, true);
  }
  ClipperLib::Paths together;
  all.Execute(ClipperLib::ctUnion, together, ClipperLib::pftNonZero, ClipperLib::pftNonZero);
  std::vector<Polygon> result;
  for (ClipperLib::Path& one : together) {
    ClipperLib::CleanPolygon(one, 10);  // points nearer than 0.1 um to their neighbours' line
    if (one.size() < 3) continue;
    Polygon out;
    for (const ClipperLib::IntPoint& p : one)
      out.emplace_back(static_cast<double>(p.X) / units_per_mm, static_cast<double>(p.Y) / units_per_mm);
    result.push_back(std::move(out));
  }
  return result;
}

NearestOnLine nearest_on_line(const std::vector<Vec2>& line, bool closed, const Vec2& from) {
  NearestOnLine nearest{line.front(), (line.front() - from).norm()};
  const std::size_t segments = line.size() - (closed ? 0 : 1);
  for (std::size_t i = 0; i < segments; ++i) {
    const Vec2 &a = line[i], b = line[(i + 1) % line.size()] - a;
    const double along = b.squaredNorm() > 0 ? std::clamp(b.dot(from - a) / b.squaredNorm(), 0.0, 1.0) : 0.0;
    const Vec2 point = a + along * b;
    if (const double distance = (point - from).norm(); distance < nearest.distance_mm) nearest = {point, distance};
  }
  return nearest;
}

}  // namespace formwright
