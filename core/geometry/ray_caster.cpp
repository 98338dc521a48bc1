// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <bit>

#include "geometry/ray_caster.h"
#include "geometry/ray_triangle.h"
#include "geometry/triangle_bvh.h"

namespace formwright {

struct RayCaster::Implementation {
  TriangleBvh bvh;
};

RayCaster::RayCaster(const TriangleMesh& mesh)
    : implementation_(std::make_unique<Implementation>(Implementation{TriangleBvh(mesh)})) {}
RayCaster::~RayCaster() = default;
RayCaster::RayCaster(RayCaster&&) noexcept = default;
RayCaster& RayCaster::operator=(RayCaster&&) noexcept = default;

namespace {

RayHit hit_in_lane(const BlockHits& hits, const TriangleBvh::Block& block, std::size_t lane) {
  return {block.face[lane], hits.distance[lane],
          Vec3(hits.barycentric[0][lane], hits.barycentric[1][lane], hits.barycentric[2][lane])};
}

}  // namespace

std::optional<RayHit> RayCaster::first_hit(const Vec3& origin, const Vec3& direction, double near, double far) const {
  const ShearedRay ray(origin, direction);
  RayHit best;
  double limit = far;
  implementation_->bvh.along_ray(origin, direction, near, limit, [&](const TriangleBvh::Block& block) {
    BlockHits hits;
    for (unsigned lanes = meet(ray, block, near, limit, hits); lanes != 0; lanes &= lanes - 1) {
      const auto i = static_cast<std::size_t>(std::countr_zero(lanes));
      if (hits.distance[i] > limit) continue;  // beyond that of an earlier lane
      // Among faces at the very same distance the first one wins, whatever the order of the tree.
      if (best.face >= 0 && hits.distance[i] == limit && block.face[i] > best.face) continue;
      best = hit_in_lane(hits, block, i);
      limit = best.distance;
    }
  });
  return best.face >= 0 ? std::optional(best) : std::nullopt;
}

std::vector<RayHit> RayCaster::all_hits(const Vec3& origin, const Vec3& direction, double near, double far) const {
  const ShearedRay ray(origin, direction);
  std::vector<RayHit> found;
  implementation_->bvh.along_ray(origin, direction, near, far, [&](const TriangleBvh::Block& block) {
    BlockHits hits;
    for (unsigned lanes = meet(ray, block, near, far, hits); lanes != 0; lanes &= lanes - 1)
      found.push_back(hit_in_lane(hits, block, static_cast<std::size_t>(std::countr_zero(lanes))));
  });
  std::sort(found.begin(), found.end(), [](const RayHit& a, const RayHit& b) {
    return a.distance != b.distance ? a.distance < b.distance : a.face < b.face;
  });
  return found;
}

}  // namespace formwright
