// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/queries/ray_caster.h"

#ifdef FORMWRIGHT_EMBREE
#include "geometry/queries/embree_rays.h"
#else
#include "geometry/queries/bvh_rays.h"
#endif

namespace formwright {

#ifdef FORMWRIGHT_EMBREE
using Rays = EmbreeRays;
#else
using Rays = BvhRays;
#endif

struct RayCaster::Implementation {
  Rays rays;
};

RayCaster::RayCaster(const TriangleMesh& mesh)
    : implementation_(std::make_unique<Implementation>(Implementation{Rays(mesh)})) {}
RayCaster::~RayCaster() = default;
RayCaster::RayCaster(RayCaster&&) noexcept = default;
RayCaster& RayCaster::operator=(RayCaster&&) noexcept = default;

std::optional<RayHit> RayCaster::first_hit(const Vec3& origin, const Vec3& direction, double near, double far) const {
  return implementation_->rays.first_hit(origin, direction, near, far);
}

std::vector<RayHit> RayCaster::all_hits(const Vec3& origin, const Vec3& direction, double near, double far) const {
  return implementation_->rays.all_hits(origin, direction, near, far);
}

}  // namespace formwright
