// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Meshes and rays that ray casters are compared on.
#include <vector>

#include "geometry/mesh/measures.h"
#include "geometry/test_meshes.h"

namespace formwright::test {

struct Shape {
  const char* name;
  TriangleMesh mesh;
};
inline std::vector<Shape> shapes() {
  TriangleMesh bumpy = icosphere(4);
  Random random(5);
  for (int v = 0; v < bumpy.vertex_count(); ++v) bumpy.V.row(v) *= random.uniform(0.8, 1.2);
  TriangleMesh slivers = torus(60, 8);
  slivers.V.col(2) *= 1e-3;
  return {{"cube", cube()},
          {"sphere", icosphere(3)},
          {"torus", torus(40, 24)},
          {"bumpy", bumpy},
          {"slivers", slivers},
          {"grid", grid(16, 16, 0.3)},
          {"far away", moved(torus(30, 20), Vec3(1e5, -2e5, 3e5))},
          {"tiny", moved(icosphere(2), Vec3(0, 0, 0), 1e-7)},
          {"huge", moved(icosphere(2), Vec3(0, 0, 0), 1e9)}};
}

struct Ray {
  Vec3 origin, direction;
};
inline Ray ray_between(const Vec3& from, const Vec3& to) { return {from, (to - from).normalized()}; }

inline std::vector<Ray> random_rays(const TriangleMesh& mesh, int count, std::uint64_t seed) {
  Random random(seed);
  const BoundingBox box = bounding_box(mesh);
  std::vector<Ray> rays;
  for (int i = 0; i < count; ++i) {
    const Vec3 origin = box.centre() + 0.5 * box.diagonal() * (i % 3 == 0 ? 0.5 : 2) * random.direction();
    rays.push_back(ray_between(origin, box.centre() + 0.35 * box.diagonal() * random.in_cube()));
  }
  return rays;
}

/// Rays through vertices and edges; rays that graze: tangential to a face, or along an axis.
inline std::vector<Ray> awkward_rays(const TriangleMesh& mesh, int count, std::uint64_t seed) {
  Random random(seed);
  const BoundingBox box = bounding_box(mesh);
  const double radius = box.diagonal() / 2;
  std::vector<Ray> rays;
  for (int i = 0; i < count; ++i) {
    const Vec3 origin = box.centre() + 2 * radius * random.direction();
    const int f = random.below(mesh.face_count());
    const Vec3 a = mesh.V.row(mesh.F(f, 0)), b = mesh.V.row(mesh.F(f, 1)), c = mesh.V.row(mesh.F(f, 2));
    rays.push_back(ray_between(origin, i % 2 == 0 ? a : Vec3(a + random.uniform() * (b - a))));
    const Vec3 tangent = random.uniform(-1, 1) * (b - a) + random.uniform(-1, 1) * (c - a);
    rays.push_back(
        ray_between((a + b + c) / 3 - 5 * tangent, (a + b + c) / 3 + tangent + 1e-9 * radius * random.in_cube()));
    Vec3 axis = Vec3::Zero();
    axis[i % 3] = i % 2 == 0 ? 1 : -1;
    rays.push_back({a - 3 * radius * axis, axis});
  }
  return rays;
}

}  // namespace formwright::test
