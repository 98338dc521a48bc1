// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/samples/shapes.h"

#include <algorithm>

#include "base/parallel.h"

namespace formwright::samples {

double edge_length_of(double area_mm2, int vertices) { return std::sqrt(area_mm2 * 2 / (std::sqrt(3.0) * vertices)); }

namespace {
double linear(int byte) {
  const double v = byte / 255.0;
  if (v <= 0.04045) return v / 12.92;
  // ((v + 0.055) / 1.055)^2.4 = u^2 * (u^2)^(1/5); the fifth root by Newton, for the same bits everywhere.
  const double u = (v + 0.055) / 1.055, a = u * u;
  double r = 0.2 + 0.8 * a;
  for (int k = 0; k < 30; ++k) r = (4 * r + a / (r * r * r * r)) / 5;
  return a * r;
}
}  // namespace

Point srgb(int red, int green, int blue) { return {linear(red), linear(green), linear(blue)}; }

Model finished(const Surface& surface, const Colouring& colouring, Point* shift_out) {
  Point low = surface.points[0], high = low;
  for (const Point& p : surface.points) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const Point shift{(low.x + high.x) / 2, low.y, (low.z + high.z) / 2};
  if (shift_out != nullptr) *shift_out = shift;
  Model model;
  const auto vertices = static_cast<Eigen::Index>(surface.points.size()),
             faces = static_cast<Eigen::Index>(surface.triangles.size());
  model.mesh.V.resize(vertices, 3);
  model.mesh.F.resize(faces, 3);
  std::vector<Point> normals(surface.points.size(), Point{0, 0, 0});
  for (Eigen::Index f = 0; f < faces; ++f) {
    const Corners& t = surface.triangles[static_cast<std::size_t>(f)];
    model.mesh.F.row(f) << t[0], t[1], t[2];
    const Point &a = surface.points[static_cast<std::size_t>(t[0])],
                &b = surface.points[static_cast<std::size_t>(t[1])],
                &c = surface.points[static_cast<std::size_t>(t[2])];
    const Point n = cross(b - a, c - a);
    for (int corner : t) normals[static_cast<std::size_t>(corner)] += n;
  }
  model.vertex_colours.resize(vertices, 3);
  parallel_for(surface.points.size(), 1024, [&](std::size_t from, std::size_t to) {
    for (std::size_t v = from; v < to; ++v) {
      const Point& p = surface.points[v];
      const auto row = static_cast<Eigen::Index>(v);
      const Point q = p - shift;
      model.mesh.V.row(row) << q.x, q.y, q.z;
      const Point c = colouring(p, normalized(normals[v]));
      model.vertex_colours.row(row) << clamp(c.x, 0, 1), clamp(c.y, 0, 1), clamp(c.z, 0, 1);
    }
  });
  return model;
}

}  // namespace formwright::samples
