// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The projective map that moves the viewpoint of a ViewFrame to infinity: rays become parallel to z and keep the place
// (x, y) where they cross the plate's front; lines and planes stay lines and planes, and what is nearer stays nearer.
// Straight on it changes nothing.
#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

/// `p`: before the viewpoint, 1 + kappa z > 0.
inline Vec3 straightened(const Vec3& p, double kappa) { return p / (1 + kappa * p.z()); }
/// Depth z of a point that the map has brought to `straight_z`.
inline double depth_from_straight(double straight_z, double kappa) { return straight_z / (1 - kappa * straight_z); }
/// The point of view coordinates at depth z on the ray that crosses the plate's front at `on_plate`.
inline Vec3 on_ray(const Vec2& on_plate, double z, double kappa) {
  const Vec2 xy = on_plate * (1 + kappa * z);
  return {xy.x(), xy.y(), z};
}

inline Positions straightened(const Positions& V, double kappa) {
  return V.array().colwise() / (1 + kappa * V.col(2).array());
}

}  // namespace formwright
