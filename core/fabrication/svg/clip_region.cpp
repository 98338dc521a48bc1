// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/svg/clip_region.h"

#include <algorithm>
#include <cmath>
#include <polyclipping/clipper.hpp>

#include "geometry/planar/plane.h"

namespace formwright {
namespace {

constexpr double touching_mm = 1e-4;  // as near to an edge as this is on it
constexpr std::size_t max_buckets = 512;
constexpr double clipper_units_per_mm = 1e5;

double distance_to(const Vec2& p, const Vec2& a, const Vec2& b) {
  const Vec2 d = b - a;
  const double square = d.squaredNorm();
  const double t = square > 0 ? std::clamp((p - a).dot(d) / square, 0.0, 1.0) : 0;
  return (p - a - t * d).norm();
}

ClipperLib::Path to_clipper(const Polygon& ring) {
  ClipperLib::Path path;
  for (const Vec2& p : ring)
    path.emplace_back(std::llround(clipper_units_per_mm * p.x()), std::llround(clipper_units_per_mm * p.y()));
  return path;
}

ClipperLib::PolyFillType clipper_rule(FillRule rule) {
  return rule == FillRule::evenodd ? ClipperLib::pftEvenOdd : ClipperLib::pftNonZero;
}

}  // namespace

ClipRegion::ClipRegion(std::vector<Shape> shapes, DrawingLimits& limits) : shapes_(std::move(shapes)), limits_(limits) {
  double max_y = 0;
  for (std::size_t s = 0; s < shapes_.size(); ++s)
    for (const Polygon& ring : shapes_[s].rings)
      for (std::size_t i = 0; i < ring.size(); ++i) {
        const Edge edge{ring[i], ring[(i + 1) % ring.size()], static_cast<std::uint32_t>(s)};
        min_y_ = edges_.empty() ? edge.a.y() : std::min(min_y_, edge.a.y());
        max_y = edges_.empty() ? edge.a.y() : std::max(max_y, edge.a.y());
        edges_.push_back(edge);
      }
  // An edge takes up as much as a path does: 40 bytes, and its place in the buckets.
  limits_.add_points(4 * edges_.size());
  buckets_.resize(std::clamp<std::size_t>(edges_.size() / 2, 1, max_buckets));
  bucket_height_ = std::max((max_y - min_y_) / static_cast<double>(buckets_.size()), 1e-3);
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    const auto [low, high] = std::minmax(edges_[e].a.y(), edges_[e].b.y());
    const std::size_t last = bucket_of(high + touching_mm);
    for (std::size_t i = bucket_of(low - touching_mm); i <= last; ++i) {
      buckets_[i].push_back(static_cast<std::uint32_t>(e));
      limits_.add_points(1);
    }
  }
}

std::size_t ClipRegion::bucket_of(double y) const {
  return static_cast<std::size_t>(
      std::clamp(std::floor((y - min_y_) / bucket_height_), 0.0, static_cast<double>(buckets_.size() - 1)));
}

bool ClipRegion::holds(const Vec2& p) const {
  const auto& bucket = buckets_[bucket_of(p.y())];
  limits_.add_steps(2 * bucket.size());
  for (const std::uint32_t e : bucket)
    if (distance_to(p, edges_[e].a, edges_[e].b) < touching_mm) return true;
  // Turns around the point, from the edges that a ray to the right crosses; edges of one shape stand together.
  int turns = 0, crossings = 0;
  for (std::size_t i = 0; i < bucket.size(); ++i) {
    const Edge& edge = edges_[bucket[i]];
    if ((edge.a.y() <= p.y()) != (edge.b.y() <= p.y())) {
      const bool upwards = edge.a.y() <= p.y();
      if ((cross(edge.b - edge.a, p - edge.a) > 0) == upwards) {
        turns += upwards ? 1 : -1;
        ++crossings;
      }
    }
    if (i + 1 < bucket.size() && edges_[bucket[i + 1]].shape == edge.shape) continue;
    if (shapes_[edge.shape].rule == FillRule::evenodd ? crossings % 2 != 0 : turns != 0) return true;
    turns = crossings = 0;
  }
  return false;
}

void ClipRegion::meetings(const Vec2& a, const Vec2& b, std::vector<double>& at) const {
  at.clear();
  const Vec2 d = b - a;
  const auto [low, high] = std::minmax(a.y(), b.y());
  const std::size_t last = bucket_of(high);
  for (std::size_t i = bucket_of(low); i <= last; ++i) {
    limits_.add_steps(3 * buckets_[i].size());
    for (const std::uint32_t e : buckets_[i]) {
      const Vec2 f = edges_[e].b - edges_[e].a, g = edges_[e].a - a;
      const double across = cross(d, f);
      const double reach = touching_mm / std::max(f.norm(), touching_mm);
      if (std::abs(across) > 1e-12 * d.norm() * f.norm()) {
        const double t = cross(g, f) / across, u = cross(g, d) / across;
        if (t > 0 && t < 1 && u >= -reach && u <= 1 + reach) at.push_back(t);
      }
      // Where the line runs along the edge it enters or leaves at the edge's ends.
      for (const Vec2& end : {edges_[e].a, edges_[e].b})
        if (distance_to(end, a, b) < touching_mm) {
          const double t = (end - a).dot(d) / d.squaredNorm();
          if (t > 0 && t < 1) at.push_back(t);
        }
    }
  }
  std::sort(at.begin(), at.end());
}

std::vector<CurveFlattener::Subpath> ClipRegion::lines_inside(CurveFlattener::Subpath line) const {
  using Subpath = CurveFlattener::Subpath;
  std::vector<Subpath> pieces;
  Subpath piece;
  bool whole = true;
  const auto end_piece = [&] {
    if (piece.points_mm.size() > 1) {
      limits_.add_path();
      pieces.push_back(std::move(piece));
    }
    piece = {};
  };
  const auto add = [&](const Vec2& p) {
    if (!piece.points_mm.empty() && piece.points_mm.back() == p) return;
    limits_.add_points(1);
    piece.points_mm.push_back(p);
  };
  const auto& points = line.points_mm;
  const std::size_t segments = line.closed ? points.size() : points.size() - 1;
  std::vector<double> at;
  bool first_inside = false;
  for (std::size_t i = 0; i < segments; ++i) {
    const Vec2 a = points[i], b = points[(i + 1) % points.size()];
    meetings(a, b, at);
    at.push_back(1);
    const double length = (b - a).norm();
    double from = 0;
    for (const double to : at) {
      if ((to - from) * length < touching_mm / 10 && to < 1) continue;
      const Vec2 p = a + from * (b - a), q = to < 1 ? Vec2(a + to * (b - a)) : b;
      if (holds((p + q) / 2)) {
        if (i == 0 && from == 0) first_inside = true;
        add(p);
        add(q);
      } else {
        whole = false;
        end_piece();
      }
      from = to;
    }
  }
  if (whole) return {std::move(line)};
  const bool last_inside = piece.points_mm.size() > 1;
  end_piece();
  // A closed line begins where it ends: the first piece is the last one's other half.
  if (line.closed && first_inside && last_inside && pieces.size() > 1) {
    auto& last = pieces.back().points_mm;
    const auto& first = pieces.front().points_mm;
    last.insert(last.end(), first.begin() + 1, first.end());
    limits_.add_points(first.size());
    pieces.erase(pieces.begin());
  }
  return pieces;
}

void ClipRegion::count_crossings() const {
  std::vector<double> at;
  for (const Edge& edge : edges_) {
    meetings(edge.a, edge.b, at);
    limits_.add_points(4 * at.size());
    limits_.add_steps(64);
  }
}

std::vector<CurveFlattener::Subpath> ClipRegion::areas_inside(std::vector<CurveFlattener::Subpath> shape,
                                                              FillRule rule) const {
  bool whole = true;
  std::size_t corners = 0;
  for (const auto& subpath : shape) {
    CurveFlattener::Subpath outline = subpath;
    outline.closed = outline.points_mm.size() > 2;
    const auto inside = lines_inside(outline);
    whole = whole && inside.size() == 1 && inside[0].points_mm.size() == outline.points_mm.size() &&
            inside[0].closed == outline.closed;
    corners += subpath.points_mm.size();
  }
  // A hole of the clip in the middle of the shape is met by no outline.
  for (const Edge& edge : edges_) {
    if (!whole || corners == 0) break;
    limits_.add_steps(corners);
    int turns = 0, crossings = 0;
    for (const auto& subpath : shape)
      for (std::size_t i = 0; i < subpath.points_mm.size(); ++i) {
        const Vec2 &a = subpath.points_mm[i], &b = subpath.points_mm[(i + 1) % subpath.points_mm.size()];
        if ((a.y() <= edge.a.y()) == (b.y() <= edge.a.y())) continue;
        const bool upwards = a.y() <= edge.a.y();
        if ((cross(b - a, edge.a - a) > 0) != upwards) continue;
        turns += upwards ? 1 : -1;
        ++crossings;
      }
    if (rule == FillRule::evenodd ? crossings % 2 != 0 : turns != 0) whole = false;
  }
  if (whole) return shape;
  Shape own{{}, rule};
  for (const auto& subpath : shape) own.rings.push_back(subpath.points_mm);
  ClipRegion({std::move(own)}, limits_).count_crossings();
  count_crossings();
  ClipperLib::Paths region, shown;
  for (const Shape& part : shapes_) {
    ClipperLib::Clipper unite;
    for (const Polygon& ring : part.rings) unite.AddPath(to_clipper(ring), ClipperLib::ptSubject, true);
    ClipperLib::Paths simple;
    unite.Execute(ClipperLib::ctUnion, simple, clipper_rule(part.rule), clipper_rule(part.rule));
    region.insert(region.end(), simple.begin(), simple.end());
  }
  ClipperLib::Clipper clipper;
  for (const auto& subpath : shape) clipper.AddPath(to_clipper(subpath.points_mm), ClipperLib::ptSubject, true);
  clipper.AddPaths(region, ClipperLib::ptClip, true);
  clipper.Execute(ClipperLib::ctIntersection, shown, clipper_rule(rule), ClipperLib::pftNonZero);
  std::vector<CurveFlattener::Subpath> result;
  for (const ClipperLib::Path& path : shown) {
    if (path.size() < 3) continue;
    CurveFlattener::Subpath outline;
    outline.closed = true;
    limits_.add_path();
    limits_.add_points(path.size());
    for (const ClipperLib::IntPoint& p : path)
      outline.points_mm.emplace_back(static_cast<double>(p.X) / clipper_units_per_mm,
                                     static_cast<double>(p.Y) / clipper_units_per_mm);
    result.push_back(std::move(outline));
  }
  return result;
}

}  // namespace formwright
