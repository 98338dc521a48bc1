// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a clip shows: lines are cut exactly where they leave it.
#include <cstdint>
#include <vector>

#include "fabrication/planar/polygon.h"
#include "fabrication/svg/grammar/curve_flattening.h"

namespace formwright {

enum class FillRule { nonzero, evenodd };

/// The union of shapes, each with a fill rule of its own, in mm.
class ClipRegion {
 public:
  struct Shape {
    std::vector<Polygon> rings;
    FillRule rule = FillRule::nonzero;
  };
  ClipRegion(std::vector<Shape> shapes, DrawingLimits& limits);

  /// The pieces of a line that lie inside or on the edge; the line itself where all of it does.
  std::vector<CurveFlattener::Subpath> lines_inside(CurveFlattener::Subpath line) const;

  /// The outlines of what a filled shape shows; the shape itself where all of it is inside.
  std::vector<CurveFlattener::Subpath> areas_inside(std::vector<CurveFlattener::Subpath> shape, FillRule rule) const;

 private:
  struct Edge {
    Vec2 a, b;
    std::uint32_t shape;
  };
  std::size_t bucket_of(double y) const;
  bool holds(const Vec2& p) const;
  /// Parameters of a to b, from 0 to 1, at which it meets an edge; sorted.
  void meetings(const Vec2& a, const Vec2& b, std::vector<double>& at) const;

  /// Clipper keeps every crossing of two edges: it must not meet too many.
  void count_crossings() const;

  std::vector<Shape> shapes_;
  std::vector<Edge> edges_;
  std::vector<std::vector<std::uint32_t>> buckets_;  // edges by the heights they reach
  double min_y_ = 0, bucket_height_ = 1;
  DrawingLimits& limits_;
};

}  // namespace formwright
