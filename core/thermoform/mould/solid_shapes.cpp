// SPDX-License-Identifier: GPL-3.0-or-later
#include "thermoform/mould/solid_shapes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/planar/plane.h"

namespace formwright {
namespace {

/// `rings` rows of `sides` corners each, counter-clockwise seen from the last row, closed by flat fans.
Triangles stacked_faces(int rings, int sides) {
  Triangles F(2 * sides * (rings - 1) + 2 * (sides - 2), 3);
  Eigen::Index row = 0;
  for (int r = 0; r + 1 < rings; ++r)
    for (int i = 0; i < sides; ++i) {
      const int a = r * sides + i, b = r * sides + (i + 1) % sides;
      F.row(row++) << a, b, b + sides;
      F.row(row++) << a, b + sides, a + sides;
    }
  const int top = (rings - 1) * sides;
  for (int i = 2; i < sides; ++i) {
    F.row(row++) << 0, i, i - 1;
    F.row(row++) << top, top + i - 1, top + i;
  }
  return F;
}

}  // namespace

TriangleMesh vertical_prism(const std::vector<Vec2>& outline, double bottom_mm, double top_mm) {
  const auto sides = static_cast<int>(outline.size());
  TriangleMesh mesh{Positions(2 * sides, 3), stacked_faces(2, sides)};
  for (int i = 0; i < sides; ++i) {
    const Vec2& p = outline[static_cast<std::size_t>(i)];
    mesh.V.row(i) << p.x(), p.y(), bottom_mm;
    mesh.V.row(sides + i) << p.x(), p.y(), top_mm;
  }
  return mesh;
}

TriangleMesh box_mesh(const Vec3& lower, const Vec3& upper) {
  return vertical_prism(
      {{lower.x(), lower.y()}, {upper.x(), lower.y()}, {upper.x(), upper.y()}, {lower.x(), upper.y()}}, lower.z(),
      upper.z());
}

TriangleMesh turned_mesh(const Vec3& centre, int axis, const std::vector<Ring>& rings, int sides) {
  const auto count = static_cast<int>(rings.size());
  TriangleMesh mesh{Positions(count * sides, 3), stacked_faces(count, sides)};
  for (int r = 0; r < count; ++r)
    for (int i = 0; i < sides; ++i) {
      const double angle = 2 * std::numbers::pi * (i + 0.5) / sides;
      const Ring& ring = rings[static_cast<std::size_t>(r)];
      Vec3 p = centre;
      p[axis] += ring.offset_mm;
      p[(axis + 1) % 3] += ring.radius_mm * std::cos(angle);
      p[(axis + 2) % 3] += ring.radius_mm * std::sin(angle);
      mesh.V.row(r * sides + i) = p;
    }
  return mesh;
}

TriangleMesh collected(const std::vector<TriangleMesh>& meshes) {
  Eigen::Index vertices = 0, faces = 0;
  for (const TriangleMesh& mesh : meshes) vertices += mesh.V.rows(), faces += mesh.F.rows();
  TriangleMesh all{Positions(vertices, 3), Triangles(faces, 3)};
  vertices = faces = 0;
  for (const TriangleMesh& mesh : meshes) {
    all.V.middleRows(vertices, mesh.V.rows()) = mesh.V;
    all.F.middleRows(faces, mesh.F.rows()) = mesh.F.array() + static_cast<int>(vertices);
    vertices += mesh.V.rows(), faces += mesh.F.rows();
  }
  return all;
}

std::vector<Vec2> convex_outline(std::vector<Vec2> points) {
  std::ranges::sort(points,
                    [](const Vec2& a, const Vec2& b) { return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y(); });
  std::vector<Vec2> hull;
  for (int pass = 0; pass < 2; ++pass) {  // Andrew's chain: below, then above
    const std::size_t start = hull.size();
    for (const Vec2& p : points) {
      while (hull.size() >= start + 2 && cross(hull.back() - hull[hull.size() - 2], p - hull.back()) <= 0)
        hull.pop_back();
      hull.push_back(p);
    }
    hull.pop_back();
    std::ranges::reverse(points);
  }
  return hull;
}

std::vector<Vec2> widened_outline(const std::vector<Vec2>& outline, double distance_mm, int sides) {
  const double radius =
      distance_mm / std::cos(std::numbers::pi / sides);  // of the corners, so that the sides keep the distance
  std::vector<Vec2> points;
  for (const Vec2& p : outline)
    for (int i = 0; i < sides; ++i) {
      const double angle = 2 * std::numbers::pi * (i + 0.5) / sides;
      points.push_back(p + radius * Vec2(std::cos(angle), std::sin(angle)));
    }
  return convex_outline(std::move(points));
}

}  // namespace formwright
