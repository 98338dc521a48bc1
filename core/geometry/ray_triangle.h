// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Watertight ray against triangle in double precision: Woop, Benthin, Wald 2013, JCGT 2(1). Along a
// shared edge the two faces compute edge functions that are exact negatives of each other (given no
// fused multiply-add: -ffp-contract=off), so no ray slips between them.
#include <array>
#include <utility>

#include "geometry/triangle_bvh.h"

namespace formwright {

/// What depends on the ray alone (Sec. 3.1): the axis of its largest component and the shear that makes
/// it the z axis.
struct ShearedRay {
  ShearedRay(const Vec3& origin, const Vec3& direction) {
    int axis = 0;
    direction.cwiseAbs().maxCoeff(&axis);
    int x_axis = (axis + 1) % 3, y_axis = (axis + 2) % 3;
    if (direction[axis] < 0) std::swap(x_axis, y_axis);  // keeps the winding
    scale_z = 1 / direction[axis];
    shear_x = direction[x_axis] * scale_z;
    shear_y = direction[y_axis] * scale_z;
    origin_x = origin[x_axis];
    origin_y = origin[y_axis];
    origin_z = origin[axis];
    x = static_cast<std::size_t>(x_axis);
    y = static_cast<std::size_t>(y_axis);
    z = static_cast<std::size_t>(axis);
  }
  std::size_t x, y, z;
  double origin_x, origin_y, origin_z, shear_x, shear_y, scale_z;
};

/// `distance` is signed, in units of the direction; barycentric coordinates per corner.
struct BlockHits {
  Double4 distance;
  std::array<Double4, 3> barycentric;
};

/// Returns the lanes (as bits) of `block` whose triangles the ray's line meets within (near, far], edges
/// and corners included. A triangle seen edge-on is not met: its neighbours are.
inline unsigned meet(const ShearedRay& ray, const TriangleBvh::Block& block, double near, double far, BlockHits& hits) {
  std::array<Double4, 3> x, y, z;  // corners in the ray's frame
  for (std::size_t c = 0; c < 3; ++c) {
    z[c] = block.corner[c][ray.z] - ray.origin_z;
    x[c] = (block.corner[c][ray.x] - ray.origin_x) - ray.shear_x * z[c];
    y[c] = (block.corner[c][ray.y] - ray.origin_y) - ray.shear_y * z[c];
  }
  const Double4 u = x[2] * y[1] - y[2] * x[1];
  const Double4 v = x[0] * y[2] - y[0] * x[2];
  const Double4 w = x[1] * y[0] - y[1] * x[0];
  const Double4 zero{}, determinant = u + v + w;
  const auto inside = ((u >= zero) & (v >= zero) & (w >= zero)) | ((u <= zero) & (v <= zero) & (w <= zero));
  const unsigned candidates = lanes_set(inside & (determinant != zero));
  if (candidates == 0) return 0;
  hits.barycentric = {u / determinant, v / determinant, w / determinant};
  hits.distance = ray.scale_z * (hits.barycentric[0] * z[0] + hits.barycentric[1] * z[1] + hits.barycentric[2] * z[2]);
  return candidates & lanes_set((hits.distance > zero + near) & (hits.distance <= zero + far));
}

}  // namespace formwright
