// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// RayCaster (ray_caster.h says what its functions do) by our own tree: without Embree, that is, in WebAssembly.
#include <optional>
#include <vector>

#include "geometry/queries/ray_hit.h"
#include "geometry/queries/triangle_bvh.h"

namespace formwright {

class BvhRays {
 public:
  explicit BvhRays(const TriangleMesh& mesh) : bvh_(mesh) {}
  std::optional<RayHit> first_hit(const Vec3& origin, const Vec3& direction, double near, double far) const;
  std::vector<RayHit> all_hits(const Vec3& origin, const Vec3& direction, double near, double far) const;

 private:
  TriangleBvh bvh_;
};

}  // namespace formwright
