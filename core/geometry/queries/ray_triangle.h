// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Watertight ray against triangle in double precision: Woop, Benthin, Wald 2013, JCGT 2(1). Along a
// shared edge the two faces compute edge functions that are exact negatives of each other (given no
// fused multiply-add: -ffp-contract=off), so no ray slips between them.
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <limits>
#include <utility>

#include "base/lanes.h"
#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

/// What depends on the ray alone (Sec. 3.1): the axis of its largest component and the shear that makes
/// it the z axis. `tolerance`: see CentredRay.
struct ShearedRay {
  ShearedRay(const Vec3& from, const Vec3& towards, double box_tolerance)
      : origin{from[0], from[1], from[2]}, direction{towards[0], towards[1], towards[2]}, tolerance(box_tolerance) {
    int axis = 0;
    towards.cwiseAbs().maxCoeff(&axis);
    int x_axis = (axis + 1) % 3, y_axis = (axis + 2) % 3;
    if (towards[axis] < 0) std::swap(x_axis, y_axis);  // keeps the winding
    scale_z = 1 / towards[axis];
    shear_x = towards[x_axis] * scale_z;
    shear_y = towards[y_axis] * scale_z;
    x = static_cast<std::size_t>(x_axis);
    y = static_cast<std::size_t>(y_axis);
    z = static_cast<std::size_t>(axis);
  }
  std::array<double, 3> origin, direction;
  double tolerance;
  std::size_t x, y, z;
  double shear_x, shear_y, scale_z;
};

/// Of one triangle (Lane = double) or of four (Lane = Double4).
template <class Lane>
using TriangleCorners = std::array<std::array<Lane, 3>, 3>;  // [corner][axis]

/// `distance` is signed, in units of the direction; barycentric coordinates per corner.
template <class Lane>
struct TriangleHits {
  Lane distance;
  std::array<Lane, 3> barycentric;
};

namespace ray_triangle_detail {

/// Moves `distance` to where the ray is within the box, if it is not already. False if the ray misses the box.
inline bool clamp_to_box(const std::array<double, 3>& direction, const std::array<double, 3>& lower,
                         const std::array<double, 3>& upper, double& distance) {
  double enter = -std::numeric_limits<double>::infinity(), leave = -enter;
  for (std::size_t k = 0; k < 3; ++k) {
    if (direction[k] == 0) {
      if (lower[k] > 0 || upper[k] < 0) return false;
      continue;
    }
    const double a = lower[k] / direction[k], b = upper[k] / direction[k];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  if (!(enter <= leave)) return false;
  distance = std::clamp(distance, enter, leave);
  return true;
}

/// Those of the `candidates` whose boxes (widened by the tolerance) the ray meets, with their distances there.
/// For triangles seen almost edge-on, round-off alone decides the signs of the edge functions, and they may claim
/// a hit far beside the triangle. Without such hits, and only then, every search tree whose boxes hold the
/// triangles' finds the same ones.
template <class Lane>
unsigned keep_in_boxes(const ShearedRay& ray, const TriangleCorners<Lane>& corner, unsigned candidates,
                       Lane& distance) {
  std::array<Lane, 3> lower, upper;  // relative to the origin
  auto inside = distance == distance;
  for (std::size_t k = 0; k < 3; ++k) {
    const Lane a = corner[0][k] - ray.origin[k], b = corner[1][k] - ray.origin[k], c = corner[2][k] - ray.origin[k];
    const Lane lesser_of_two = a < b ? a : b, greater_of_two = a < b ? b : a;
    const Lane low = (lesser_of_two < c ? lesser_of_two : c) - ray.tolerance;
    const Lane high = (greater_of_two < c ? c : greater_of_two) + ray.tolerance;
    const Lane point = distance * ray.direction[k];
    const auto within = (point >= low) & (point <= high);
    inside = inside & within;
    lower[k] = low;
    upper[k] = high;
  }
  for (unsigned outside = candidates & ~lanes_set(inside); outside != 0; outside &= outside - 1) {
    const auto i = static_cast<std::size_t>(std::countr_zero(outside));
    const auto in_lane = [i](const std::array<Lane, 3>& v) {
      return std::array{get_lane(v[0], i), get_lane(v[1], i), get_lane(v[2], i)};
    };
    double moved = get_lane(distance, i);
    if (clamp_to_box(ray.direction, in_lane(lower), in_lane(upper), moved)) set_lane(distance, i, moved);
    else candidates &= ~(1u << i);
  }
  return candidates;
}

}  // namespace ray_triangle_detail

/// Returns the lanes (as bits) whose triangles the ray's line meets within (near, far], edges and corners
/// included. A triangle seen edge-on is not met: its neighbours are. Each lane's answer depends on the ray and
/// its triangle alone, to the last bit, however many lanes there are.
template <class Lane>
unsigned meet(const ShearedRay& ray, const TriangleCorners<Lane>& corner, double near, double far,
              TriangleHits<Lane>& hits) {
  std::array<Lane, 3> x, y, z;  // corners in the ray's frame
  for (std::size_t c = 0; c < 3; ++c) {
    z[c] = corner[c][ray.z] - ray.origin[ray.z];
    x[c] = (corner[c][ray.x] - ray.origin[ray.x]) - ray.shear_x * z[c];
    y[c] = (corner[c][ray.y] - ray.origin[ray.y]) - ray.shear_y * z[c];
  }
  const Lane u = x[2] * y[1] - y[2] * x[1];
  const Lane v = x[0] * y[2] - y[0] * x[2];
  const Lane w = x[1] * y[0] - y[1] * x[0];
  const Lane zero{}, determinant = u + v + w;
  const auto inside = ((u >= zero) & (v >= zero) & (w >= zero)) | ((u <= zero) & (v <= zero) & (w <= zero));
  const unsigned candidates = lanes_set(inside & (determinant != zero));
  if (candidates == 0) return 0;
  hits.barycentric = {u / determinant, v / determinant, w / determinant};
  hits.distance = ray.scale_z * (hits.barycentric[0] * z[0] + hits.barycentric[1] * z[1] + hits.barycentric[2] * z[2]);
  const unsigned kept = ray_triangle_detail::keep_in_boxes(ray, corner, candidates, hits.distance);
  return kept & lanes_set((hits.distance > zero + near) & (hits.distance <= zero + far));
}

}  // namespace formwright
