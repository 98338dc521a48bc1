// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Other people's ray casters, to compare ours with: CGAL's AABB tree with exact predicates (native and
// WASM) and Embree's single-precision triangles (native).
#include <memory>
#include <optional>
#include <vector>

#include "geometry/mesh/triangle_mesh.h"

namespace formwright::test {

class CgalRays {
 public:
  explicit CgalRays(const TriangleMesh& mesh);
  ~CgalRays();
  /// Faces that the closed half-line meets, ascending, by exact predicates.
  std::vector<int> all_faces(const Vec3& origin, const Vec3& direction) const;
  /// Distance to the first intersection point.
  std::optional<double> first_distance(const Vec3& origin, const Vec3& direction) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

#ifndef __EMSCRIPTEN__
class EmbreeTriangles {
 public:
  explicit EmbreeTriangles(const TriangleMesh& mesh);
  ~EmbreeTriangles();
  struct Hit {
    int face;
    double distance;  // single precision
  };
  std::optional<Hit> first_hit(const Vec3& origin, const Vec3& direction) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};
#endif

}  // namespace formwright::test
