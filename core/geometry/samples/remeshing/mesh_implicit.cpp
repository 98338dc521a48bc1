// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/samples/remeshing/mesh_implicit.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace formwright::samples {

Point ImplicitTarget::project(const Point& p, std::uint32_t, double step, Point& slope) const {
  if (slope == Point{}) {
    const double a = field_({p.x + step, p.y - step, p.z - step}), b = field_({p.x - step, p.y - step, p.z + step}),
                 c = field_({p.x - step, p.y + step, p.z - step}), d = field_({p.x + step, p.y + step, p.z + step});
    const Point gradient = Point{a - b - c + d, c + d - a - b, b + d - a - c} / (4 * step);
    const double g2 = length2(gradient);
    if (!(g2 > 0.01)) return p;
    slope = gradient / g2;
    return p - slope * (0.25 * (a + b + c + d));
  }
  return p - slope * field_(p);
}

Surface mesh_implicit(const ImplicitShape& shape, double area_mm2, int vertex_count, Context& context) {
  // The grid edges crossed by a surface of area A number 1.5 A / cell^2 on average over directions.
  const double cell = std::min(shape.largest_cell_mm, std::sqrt(1.5 * area_mm2 / (1.1 * vertex_count)));
  const Surface rough = marching_cubes(shape, cell, context);
  std::vector<int> patch;
  return remesh(rough, patch, ImplicitTarget(shape.field), vertex_count, context);
}

}  // namespace formwright::samples
