// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Closed thin shapes made by code: two sheets that nearly touch, seen through each other from the front. Their depth
// order conditions nearly depend on each other.
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "geometry/test_meshes.h"

namespace formwright::test {

/// A point of a sheet's middle and half of its thickness there, for s and t in [0, 1].
struct SheetPoint {
  Vec3 middle;
  double half_thickness;
};

/// Two copies of a columns x rows grid, `half_thickness` in front of and behind the middle, sewn along the border,
/// where the thickness does not count: 2 columns rows - 2 (columns + rows) + 4 vertices.
inline TriangleMesh closed_sheet(int columns, int rows, const std::function<SheetPoint(double s, double t)>& sheet) {
  std::vector<Vec3> points;
  std::vector<std::array<int, 3>> faces;
  std::vector<int> front(static_cast<std::size_t>(columns * rows)), back = front;
  const auto at = [&](int i, int j) { return sheet(double(i) / (columns - 1), double(j) / (rows - 1)); };
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const auto k = static_cast<std::size_t>(j * columns + i);
      const SheetPoint p = at(i, j);
      const bool border = i == 0 || j == 0 || i == columns - 1 || j == rows - 1;
      if (border) {
        front[k] = back[k] = static_cast<int>(points.size());
        points.push_back(p.middle);
        continue;
      }
      const Vec3 normal =
          (at(i + 1, j).middle - at(i - 1, j).middle).cross(at(i, j + 1).middle - at(i, j - 1).middle).normalized();
      front[k] = static_cast<int>(points.size());
      points.push_back(p.middle + p.half_thickness * normal);
      back[k] = static_cast<int>(points.size());
      points.push_back(p.middle - p.half_thickness * normal);
    }
  }
  for (int j = 0; j + 1 < rows; ++j) {
    for (int i = 0; i + 1 < columns; ++i) {
      const auto k = static_cast<std::size_t>(j * columns + i), up = k + static_cast<std::size_t>(columns);
      const std::array<std::size_t, 4> q{k, k + 1, up + 1, up};
      // At a corner of the grid the diagonal must not join two border vertices on both sides.
      const bool turned = (i == 0 && j == 0) || (i + 2 == columns && j + 2 == rows);
      const std::array<std::array<std::size_t, 3>, 2> cut =
          turned ? std::array<std::array<std::size_t, 3>, 2>{{{q[0], q[1], q[2]}, {q[0], q[2], q[3]}}}
                 : std::array<std::array<std::size_t, 3>, 2>{{{q[0], q[1], q[3]}, {q[1], q[2], q[3]}}};
      for (const auto& f : cut) {
        faces.push_back({front[f[0]], front[f[1]], front[f[2]]});
        faces.push_back({back[f[0]], back[f[2]], back[f[1]]});
      }
    }
  }
  return make_mesh(points, faces);
}

/// A leaf with a midrib and side veins, curled; a five hundredth of its width thick.
inline TriangleMesh leaf(int vertices) {
  const int rows = static_cast<int>(std::sqrt(vertices / 1.2)), columns = std::max(5, vertices / (2 * rows));
  return closed_sheet(columns, rows, [](double s, double t) {
    const double y = 2 * t - 1, half = 0.05 + 0.45 * std::sin(std::numbers::pi * t) * (1.2 - 0.4 * t), a = 2 * s - 1;
    const double x = half * a;
    const double veins = 0.015 * std::sin(40 * (y - 0.5 * std::abs(a))) * std::abs(a) * (1 - a * a);
    const double z = 0.25 * y * y - 0.35 * x * x + 0.12 * x * y + 0.03 * std::exp(-200 * x * x) + veins;
    return SheetPoint{{x, y, z}, 0.001 * (1 + 2 * std::exp(-100 * x * x))};
  });
}

/// A round body whose two wings are sheets of feathers, raised and swept towards the viewer.
inline TriangleMesh wings(int vertices) {
  const int columns = static_cast<int>(std::sqrt(vertices * 1.1)), rows = std::max(5, vertices / (2 * columns));
  return closed_sheet(columns, rows, [](double s, double t) {
    const double x = 2 * s - 1, away = std::abs(x), chord = 0.5 * (1 - 0.7 * away * away) + 0.05;
    const double b = 2 * t - 1, y = chord * b + 0.35 * away * away;
    const double feathers = 0.01 * std::sin(60 * x + 8 * b) * away * (0.5 - 0.5 * b);
    const double z = 0.55 * std::pow(away, 1.6) - 0.2 * b * b * away + feathers;
    return SheetPoint{{x, y, z}, 0.0015 + 0.2 * std::exp(-25 * x * x) * (1 - b * b)};
  });
}

/// A hanging cloth, folded over itself: up to six sheets behind each other.
inline TriangleMesh cloth(int vertices) {
  const int columns = static_cast<int>(std::sqrt(vertices * 1.0)), rows = std::max(5, vertices / (2 * columns));
  return closed_sheet(columns, rows, [](double s, double t) {
    const double phase = 2 * std::numbers::pi * (5 * s + 0.3 * std::sin(3 * t)), depth = 0.4 + 0.6 * (1 - t);
    const double x = 2 * s - 1 + 0.09 * depth * std::sin(2 * phase), y = 2 * t - 1 + 0.03 * std::sin(phase);
    const double z = 0.16 * depth * std::cos(phase) + 0.05 * std::sin(4 * t + 2 * s);
    return SheetPoint{{x, y, z}, 0.002};
  });
}

/// Flat rings on a square grid, neighbours joined by upright rings (Japanese weave), turned a little.
inline TriangleMesh chain_mail(int vertices) {
  constexpr int side = 6, ring_count = side * side + 2 * side * (side - 1);
  const int around = std::max(4, static_cast<int>(std::sqrt(vertices / ring_count / 3.0))),
            along = std::max(8, vertices / ring_count / around);
  std::vector<Vec3> points;
  std::vector<std::array<int, 3>> faces;
  const auto ring = [&](const Vec3& centre, const Vec3& e1, const Vec3& e2, double radius, double wire) {
    const int first = static_cast<int>(points.size());
    const Vec3 axis = e1.cross(e2);
    const auto index = [&](int i, int j) { return first + (i % along) * around + j % around; };
    for (int i = 0; i < along; ++i) {
      const double a = 2 * std::numbers::pi * i / along;
      const Vec3 out = std::cos(a) * e1 + std::sin(a) * e2;
      for (int j = 0; j < around; ++j) {
        const double b = 2 * std::numbers::pi * j / around;
        points.push_back(centre + (radius + wire * std::cos(b)) * out + wire * std::sin(b) * axis);
        faces.push_back({index(i, j), index(i + 1, j), index(i + 1, j + 1)});
        faces.push_back({index(i, j), index(i + 1, j + 1), index(i, j + 1)});
      }
    }
  };
  const Vec3 X = Vec3::UnitX(), Y = Vec3::UnitY(), Z = Vec3::UnitZ();
  constexpr double pitch = 2.4;
  for (int j = 0; j < side; ++j) {
    for (int i = 0; i < side; ++i) {
      const Vec3 centre(pitch * i, pitch * j, 0.3 * std::sin(i + 0.7 * j));
      ring(centre, X, Y, 1, 0.12);
      if (i + 1 < side)
        ring(Vec3(pitch * (i + 0.5), pitch * j, 0.15 * std::sin(i + 0.7 * j) + 0.15 * std::sin(i + 1 + 0.7 * j)), Z, X,
             0.55, 0.1);
      if (j + 1 < side)
        ring(Vec3(pitch * i, pitch * (j + 0.5), 0.15 * std::sin(i + 0.7 * j) + 0.15 * std::sin(i + 0.7 * (j + 1))), Y,
             Z, 0.55, 0.1);
    }
  }
  TriangleMesh mesh = make_mesh(points, faces);
  const Eigen::Matrix3d turn =
      (Eigen::AngleAxisd(0.5, Vec3::UnitX()) * Eigen::AngleAxisd(0.3, Vec3::UnitY())).toRotationMatrix();
  mesh.V = (mesh.V * turn.transpose()).eval();
  return mesh;
}

struct ThinShape {
  const char* name;
  TriangleMesh (*make)(int vertices);
};
inline const std::vector<ThinShape>& thin_shapes() {
  static const std::vector<ThinShape> all{
      {"leaf", leaf}, {"wings", wings}, {"cloth", cloth}, {"chain_mail", chain_mail}};
  return all;
}

}  // namespace formwright::test
