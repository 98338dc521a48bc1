// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Even, nearly equilateral triangles of a given number on a known surface: Botsch and Kobbelt 2004
// (split, collapse, flip, relax, project), ended by an exact vertex count.
#include <functional>
#include <vector>

#include "base/context.h"
#include "geometry/samples/remeshing/halfedge_surface.h"

namespace formwright::samples {

/// What the remesher asks of a shape.
class TargetShape {
 public:
  virtual ~TargetShape() = default;
  /// A point nearer to the shape. `patches`: the smooth pieces it must lie on, as bits; `step`: the
  /// scale in mm on which to look, about a tenth of an edge, then less and less. `slope` is kept for the
  /// vertex between calls: zero asks for a fresh look, otherwise a cheaper step along it may do.
  virtual Point project(const Point& p, std::uint32_t patches, double step, Point& slope) const = 0;
};

/// Exactly `vertex_count` vertices. `patch` per triangle as in HalfedgeSurface, changed with the surface.
Surface remesh(const Surface& surface, std::vector<int>& patch, const TargetShape& target, int vertex_count,
               Context& context);

/// The same for a surface with a boundary. side(a, b) tells on which side of the rim (0 to 7) a boundary edge between
/// two points lies; vertices of the rim carry the bits 1 << (first_rim_patch + side), two of them where
/// sides meet, and those stay.
inline constexpr int first_rim_patch = 20;
Surface remesh_open(const Surface& surface, const std::function<int(const Point&, const Point&)>& side,
                    const TargetShape& target, int vertex_count, Context& context);

}  // namespace formwright::samples
