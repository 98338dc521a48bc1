// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Small analytic meshes for the tests of this module: each with a known topology and measure.
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include "geometry/mesh/triangle_mesh.h"

namespace formwright::test {

/// splitmix64 (Steele, Lea, Flood 2014): the same numbers on every platform, unlike std distributions.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint64_t bits() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ull);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return z ^ (z >> 31);
  }
  double uniform() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
  double uniform(double from, double to) { return from + (to - from) * uniform(); }
  int below(int count) { return static_cast<int>(bits() % static_cast<std::uint64_t>(count)); }
  Vec3 in_cube() {
    const double x = uniform(-1, 1), y = uniform(-1, 1), z = uniform(-1, 1);
    return {x, y, z};
  }
  Vec3 direction() {
    for (;;) {
      const Vec3 p = in_cube();
      if (const double length = p.norm(); length > 0.1 && length <= 1) return p / length;
    }
  }

 private:
  std::uint64_t state_;
};

inline TriangleMesh make_mesh(const std::vector<Vec3>& points, const std::vector<std::array<int, 3>>& faces) {
  TriangleMesh mesh;
  mesh.V.resize(static_cast<Eigen::Index>(points.size()), 3);
  for (std::size_t i = 0; i < points.size(); ++i) mesh.V.row(static_cast<Eigen::Index>(i)) = points[i];
  mesh.F.resize(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t i = 0; i < faces.size(); ++i)
    for (int k = 0; k < 3; ++k) mesh.F(static_cast<Eigen::Index>(i), k) = faces[i][static_cast<std::size_t>(k)];
  return mesh;
}

inline TriangleMesh tetrahedron() {
  return make_mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{{0, 2, 1}}, {{0, 1, 3}}, {{0, 3, 2}}, {{1, 2, 3}}});
}

/// [0, 1]^3 with outward faces: 8 vertices, 12 triangles.
inline TriangleMesh cube() {
  std::vector<Vec3> points;
  for (int i = 0; i < 8; ++i) points.emplace_back(i & 1, (i >> 1) & 1, (i >> 2) & 1);
  return make_mesh(points, {{{0, 2, 3}},
                            {{0, 3, 1}},
                            {{4, 5, 7}},
                            {{4, 7, 6}},
                            {{0, 1, 5}},
                            {{0, 5, 4}},
                            {{2, 6, 7}},
                            {{2, 7, 3}},
                            {{0, 4, 6}},
                            {{0, 6, 2}},
                            {{1, 3, 7}},
                            {{1, 7, 5}}});
}

/// Icosahedron split `levels` times and pushed to the unit sphere: 10 * 4^levels + 2 vertices.
inline TriangleMesh icosphere(int levels) {
  const double t = std::numbers::phi;
  std::vector<Vec3> points{{-1, t, 0},  {1, t, 0},  {-1, -t, 0}, {1, -t, 0}, {0, -1, t},  {0, 1, t},
                           {0, -1, -t}, {0, 1, -t}, {t, 0, -1},  {t, 0, 1},  {-t, 0, -1}, {-t, 0, 1}};
  for (Vec3& p : points) p.normalize();
  std::vector<std::array<int, 3>> faces{{{0, 11, 5}}, {{0, 5, 1}},  {{0, 1, 7}},   {{0, 7, 10}}, {{0, 10, 11}},
                                        {{1, 5, 9}},  {{5, 11, 4}}, {{11, 10, 2}}, {{10, 7, 6}}, {{7, 1, 8}},
                                        {{3, 9, 4}},  {{3, 4, 2}},  {{3, 2, 6}},   {{3, 6, 8}},  {{3, 8, 9}},
                                        {{4, 9, 5}},  {{2, 4, 11}}, {{6, 2, 10}},  {{8, 6, 7}},  {{9, 8, 1}}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<int, int>, int> middle;
    const auto midpoint = [&](int a, int b) {
      const auto [found, fresh] = middle.try_emplace(std::minmax(a, b), static_cast<int>(points.size()));
      if (fresh) {
        const Vec3 p = points[static_cast<std::size_t>(a)] + points[static_cast<std::size_t>(b)];
        points.push_back(p.normalized());
      }
      return found->second;
    };
    std::vector<std::array<int, 3>> finer;
    for (const auto& [a, b, c] : faces) {
      const int ab = midpoint(a, b), bc = midpoint(b, c), ca = midpoint(c, a);
      finer.insert(finer.end(), {{{a, ab, ca}}, {{b, bc, ab}}, {{c, ca, bc}}, {{ab, bc, ca}}});
    }
    faces = std::move(finer);
  }
  return make_mesh(points, faces);
}

/// Radii 1 and `tube`; around * across vertices, genus 1.
inline TriangleMesh torus(int around, int across, double tube = 0.4) {
  std::vector<Vec3> points;
  std::vector<std::array<int, 3>> faces;
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < across; ++j) {
      const double u = 2 * std::numbers::pi * i / around, v = 2 * std::numbers::pi * j / across;
      const double r = 1 + tube * std::cos(v);
      points.emplace_back(r * std::cos(u), r * std::sin(u), tube * std::sin(v));
      const int a = i * across + j, b = ((i + 1) % around) * across + j;
      const int c = ((i + 1) % around) * across + (j + 1) % across, d = i * across + (j + 1) % across;
      faces.push_back({a, b, c});
      faces.push_back({a, c, d});
    }
  return make_mesh(points, faces);
}

/// [0, 1]^2 in the plane z = 0, facing +z: (nx + 1) (ny + 1) vertices; inner vertices moved about by
/// `jitter` of a cell.
inline TriangleMesh grid(int nx, int ny, double jitter = 0, std::uint64_t seed = 1) {
  Random random(seed);
  std::vector<Vec3> points;
  std::vector<std::array<int, 3>> faces;
  for (int j = 0; j <= ny; ++j)
    for (int i = 0; i <= nx; ++i) {
      Vec3 p(static_cast<double>(i) / nx, static_cast<double>(j) / ny, 0);
      const double dx = random.uniform(-jitter, jitter) / nx, dy = random.uniform(-jitter, jitter) / ny;
      if (i > 0 && i < nx && j > 0 && j < ny) p += Vec3(dx, dy, 0);
      points.push_back(p);
    }
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      const int a = j * (nx + 1) + i, b = a + 1, c = b + nx + 1, d = a + nx + 1;
      faces.push_back({a, b, c});
      faces.push_back({a, c, d});
    }
  return make_mesh(points, faces);
}

/// Side of a cylinder of radius 1 and height 1, open at both ends, facing outwards.
inline TriangleMesh tube(int around, int rows) {
  std::vector<Vec3> points;
  std::vector<std::array<int, 3>> faces;
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i < around; ++i) {
      const double u = 2 * std::numbers::pi * i / around;
      points.emplace_back(std::cos(u), std::sin(u), static_cast<double>(j) / rows);
      if (j == rows) continue;
      const int a = j * around + i, b = j * around + (i + 1) % around;
      faces.push_back({a, b, b + around});
      faces.push_back({a, b + around, a + around});
    }
  return make_mesh(points, faces);
}

/// One half twist: not orientable, one boundary loop.
inline TriangleMesh moebius_band(int around) {
  std::vector<Vec3> points;
  std::vector<std::array<int, 3>> faces;
  for (int i = 0; i < around; ++i) {
    const double u = 2 * std::numbers::pi * i / around;
    for (const double s : {-0.3, 0.3}) {
      const double r = 1 + s * std::cos(u / 2);
      points.emplace_back(r * std::cos(u), r * std::sin(u), s * std::sin(u / 2));
    }
    const int a = 2 * i, b = 2 * i + 1;
    const int c = i + 1 < around ? a + 2 : 1, d = i + 1 < around ? b + 2 : 0;
    faces.push_back({a, c, d});
    faces.push_back({a, d, b});
  }
  return make_mesh(points, faces);
}

inline TriangleMesh joined(const TriangleMesh& first, const TriangleMesh& second) {
  TriangleMesh mesh;
  mesh.V.resize(first.V.rows() + second.V.rows(), 3);
  mesh.V << first.V, second.V;
  mesh.F.resize(first.F.rows() + second.F.rows(), 3);
  mesh.F << first.F, (second.F.array() + first.vertex_count()).matrix();
  return mesh;
}

inline TriangleMesh moved(TriangleMesh mesh, const Vec3& shift, double scale = 1) {
  mesh.V = (mesh.V * scale).rowwise() + shift.transpose();
  return mesh;
}

inline TriangleMesh rotated(TriangleMesh mesh, const Vec3& axis, double angle) {
  const Eigen::Matrix3d rotation = Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
  mesh.V = (mesh.V * rotation.transpose()).eval();
  return mesh;
}

inline TriangleMesh reversed(TriangleMesh mesh) {
  mesh.F.col(1).swap(mesh.F.col(2));
  return mesh;
}

/// Every triangle with three vertices of its own, as STL files have them.
inline TriangleMesh unwelded(const TriangleMesh& mesh) {
  TriangleMesh soup;
  soup.V.resize(3 * mesh.F.rows(), 3);
  soup.F.resize(mesh.F.rows(), 3);
  for (int f = 0; f < mesh.face_count(); ++f)
    for (int k = 0; k < 3; ++k) {
      soup.V.row(3 * f + k) = mesh.V.row(mesh.F(f, k));
      soup.F(f, k) = 3 * f + k;
    }
  return soup;
}

}  // namespace formwright::test
