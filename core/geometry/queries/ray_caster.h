// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Rays against a triangle mesh, in double precision. The tree is Embree's natively (embree_rays.h) and our own in
// WebAssembly (bvh_rays.h); both find triangles by boxes that are certain to hold them and test those by the same
// code (ray_triangle.h), so that hits are equal to the last bit. docs/ray_casting.md
#include <memory>
#include <optional>
#include <vector>

#include "geometry/queries/ray_hit.h"
#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

class RayCaster {
 public:
  /// Keeps a reference to nothing: the mesh is copied into the acceleration structure. Throws as search_sphere
  /// does, and std::bad_alloc.
  explicit RayCaster(const TriangleMesh& mesh);
  ~RayCaster();
  RayCaster(RayCaster&&) noexcept;
  RayCaster& operator=(RayCaster&&) noexcept;

  /// Nearest hit with distance in (near, far], of faces at the same distance the first; callable from several
  /// threads. `direction` is unit length.
  std::optional<RayHit> first_hit(const Vec3& origin, const Vec3& direction, double near, double far) const;

  /// Every hit with distance in (near, far], sorted by distance, then by face; a ray through a shared edge or
  /// vertex reports each face it touches.
  std::vector<RayHit> all_hits(const Vec3& origin, const Vec3& direction, double near, double far) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace formwright
