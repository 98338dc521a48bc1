// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// RayCaster (ray_caster.h says what its functions do) by Embree's tree (Wald et al. 2014, "Embree: a kernel
// framework for efficient CPU ray tracing"). Embree traverses in single precision; our own test decides in double.
#include <memory>
#include <optional>
#include <vector>

#include "geometry/queries/ray_hit.h"
#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

class EmbreeRays {
 public:
  /// Builds the tree of a large mesh with as many threads as a parallel_for begun here would use.
  explicit EmbreeRays(const TriangleMesh& mesh);
  ~EmbreeRays();
  EmbreeRays(EmbreeRays&&) noexcept;
  EmbreeRays& operator=(EmbreeRays&&) noexcept;
  std::optional<RayHit> first_hit(const Vec3& origin, const Vec3& direction, double near, double far) const;
  std::vector<RayHit> all_hits(const Vec3& origin, const Vec3& direction, double near, double far) const;

 private:
  struct Scene;
  std::unique_ptr<Scene> scene_;
};

}  // namespace formwright
