// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Even triangles on the zero set of a field.
#include "base/context.h"
#include "geometry/samples/remeshing/remesh.h"

namespace formwright::samples {

/// Newton's step p - f g / |g|^2 with value f and gradient g from four samples at the corners of a tetrahedron of size
/// `step`; with a known slope one sample does (a chord step).
class ImplicitTarget : public TargetShape {
 public:
  explicit ImplicitTarget(const Field& field) : field_(field) {}
  Point project(const Point& p, std::uint32_t patches, double step, Point& slope) const override;

 private:
  const Field& field_;
};

/// Marching cubes on a fitting grid, then remesh.
Surface mesh_implicit(const ImplicitShape& shape, double area_mm2, int vertex_count, Context& context);

}  // namespace formwright::samples
