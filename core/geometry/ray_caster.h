// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Rays against a triangle mesh: Embree natively, a CGAL AABB tree in WASM, the same hits.
#include <memory>
#include <optional>
#include <vector>

#include "geometry/triangle_mesh.h"

namespace formwright {

struct RayHit {
  int face = -1;
  double distance = 0;   // along the unit direction, recomputed in double precision
  Vec3 barycentric;      // of the face's three corners, sums to 1
};

class RayCaster {
 public:
  /// Keeps a reference to nothing: the mesh is copied into the acceleration structure.
  explicit RayCaster(const TriangleMesh& mesh);
  ~RayCaster();
  RayCaster(RayCaster&&) noexcept;
  RayCaster& operator=(RayCaster&&) noexcept;

  /// Nearest hit with distance in (near, far]; callable from several threads. `direction` is unit length.
  std::optional<RayHit> first_hit(const Vec3& origin, const Vec3& direction, double near, double far) const;

  /// Every hit with distance in (near, far], sorted by distance; a ray through a shared edge or vertex
  /// reports each face it touches.
  std::vector<RayHit> all_hits(const Vec3& origin, const Vec3& direction, double near, double far) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace formwright
