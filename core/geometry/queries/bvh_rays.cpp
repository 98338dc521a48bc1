// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/queries/bvh_rays.h"

#include <algorithm>
#include <bit>

#include "geometry/queries/ray_triangle.h"

namespace formwright {
namespace {

using BlockHits = TriangleHits<Double4>;

RayHit hit_in_lane(const BlockHits& hits, const TriangleBvh::Block& block, std::size_t lane) {
  return {block.face[lane], hits.distance[lane],
          Vec3(hits.barycentric[0][lane], hits.barycentric[1][lane], hits.barycentric[2][lane])};
}

}  // namespace

std::optional<RayHit> BvhRays::first_hit(const Vec3& origin, const Vec3& direction, double near, double far) const {
  const CentredRay centred(bvh_.sphere(), origin, direction);
  const ShearedRay ray(origin, direction, centred.tolerance);
  RayHit best;
  double limit = far;
  bvh_.along_ray(centred, near, limit, [&](const TriangleBvh::Block& block) {
    BlockHits hits;
    for (unsigned lanes = meet(ray, block.corner, near, limit, hits); lanes != 0; lanes &= lanes - 1) {
      const RayHit hit = hit_in_lane(hits, block, static_cast<std::size_t>(std::countr_zero(lanes)));
      if (best.face >= 0 && !comes_before(hit, best)) continue;
      best = hit;
      limit = best.distance;
    }
  });
  return best.face >= 0 ? std::optional(best) : std::nullopt;
}

std::vector<RayHit> BvhRays::all_hits(const Vec3& origin, const Vec3& direction, double near, double far) const {
  const CentredRay centred(bvh_.sphere(), origin, direction);
  const ShearedRay ray(origin, direction, centred.tolerance);
  std::vector<RayHit> found;
  bvh_.along_ray(centred, near, far, [&](const TriangleBvh::Block& block) {
    BlockHits hits;
    for (unsigned lanes = meet(ray, block.corner, near, far, hits); lanes != 0; lanes &= lanes - 1)
      found.push_back(hit_in_lane(hits, block, static_cast<std::size_t>(std::countr_zero(lanes))));
  });
  std::sort(found.begin(), found.end(), comes_before);
  return found;
}

}  // namespace formwright
