// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/planar/region.h"

#include <algorithm>
#include <cmath>
#include <polyclipping/clipper.hpp>

#include "geometry/planar/plane.h"

namespace formwright {
namespace {

constexpr double units = 1 << 30;  // of Clipper's whole numbers in one of ours
constexpr double max_mitre = 3;    // of the distance, at sharp corners

ClipperLib::Paths to_clipper(const std::vector<std::vector<Vec2>>& rings) {
  ClipperLib::Paths paths;
  for (const std::vector<Vec2>& ring : rings) {
    ClipperLib::Path path;
    for (const Vec2& p : ring) path.emplace_back(std::llround(units * p.x()), std::llround(units * p.y()));
    paths.push_back(std::move(path));
  }
  return paths;
}

Region from_clipper(const ClipperLib::Paths& paths) {
  Region region;
  for (const ClipperLib::Path& path : paths) {
    std::vector<Vec2> ring;
    for (const ClipperLib::IntPoint& p : path)
      ring.emplace_back(static_cast<double>(p.X) / units, static_cast<double>(p.Y) / units);
    if (ring.size() >= 3) region.rings.push_back(std::move(ring));
  }
  return region;
}

Region combined(ClipperLib::ClipType type, const std::vector<std::vector<Vec2>>& a,
                const std::vector<std::vector<Vec2>>& b, ClipperLib::PolyFillType rule) {
  ClipperLib::Clipper clipper;
  clipper.StrictlySimple(true);
  clipper.AddPaths(to_clipper(a), ClipperLib::ptSubject, true);
  clipper.AddPaths(to_clipper(b), ClipperLib::ptClip, true);
  ClipperLib::Paths result;
  clipper.Execute(type, result, rule, rule);
  return from_clipper(result);
}

}  // namespace

double Region::area() const {
  double twice = 0;
  for (const std::vector<Vec2>& ring : rings)
    for (std::size_t k = 0; k < ring.size(); ++k)
      twice += cross(Vec2(ring[k] - ring[0]), Vec2(ring[(k + 1) % ring.size()] - ring[0]));
  return 0.5 * twice;
}

std::pair<Vec2, Vec2> Region::box() const {
  Vec2 low = Vec2::Constant(INFINITY), high = -low;
  for (const std::vector<Vec2>& ring : rings)
    for (const Vec2& p : ring) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
  return {low, high};
}

bool Region::contains(const Vec2& p) const {
  bool inside = false;
  for (const std::vector<Vec2>& ring : rings)
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const Vec2 &a = ring[k], &b = ring[(k + 1) % ring.size()];
      if ((a.y() > p.y()) == (b.y() > p.y())) continue;
      // Positive where p lies to the left of the edge, seen upwards.
      const double side = cross(Vec2(b - a), Vec2(p - a));
      if ((b.y() > a.y()) == (side > 0)) inside = !inside;
    }
  return inside;
}

std::vector<double> Region::crossings(double y) const {
  std::vector<double> found;
  for (const std::vector<Vec2>& ring : rings)
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const Vec2 &a = ring[k], &b = ring[(k + 1) % ring.size()];
      if ((a.y() > y) != (b.y() > y)) found.push_back(a.x() + (b.x() - a.x()) * ((y - a.y()) / (b.y() - a.y())));
    }
  std::ranges::sort(found);
  return found;
}

Region surrounded_by(const std::vector<std::vector<Vec2>>& lines) {
  return combined(ClipperLib::ctUnion, lines, {}, ClipperLib::pftPositive);
}
Region united(const Region& a, const Region& b) {
  return combined(ClipperLib::ctUnion, a.rings, b.rings, ClipperLib::pftNonZero);
}
Region common(const Region& a, const Region& b) {
  return combined(ClipperLib::ctIntersection, a.rings, b.rings, ClipperLib::pftNonZero);
}
Region without(const Region& a, const Region& b) {
  return combined(ClipperLib::ctDifference, a.rings, b.rings, ClipperLib::pftNonZero);
}

Region cleaned(const Region& region, double distance, double min_area) {
  ClipperLib::Paths paths = to_clipper(region.rings);
  ClipperLib::CleanPolygons(paths, distance * units);
  Region result = from_clipper(paths);
  std::erase_if(result.rings,
                [&](const std::vector<Vec2>& ring) { return std::abs(Region{{ring}}.area()) < min_area; });
  return result;
}

Region grown(const Region& region, double distance) {
  ClipperLib::ClipperOffset offset(max_mitre);
  offset.AddPaths(to_clipper(region.rings), ClipperLib::jtMiter, ClipperLib::etClosedPolygon);
  ClipperLib::Paths result;
  offset.Execute(result, distance * units);
  return from_clipper(result);
}

}  // namespace formwright
