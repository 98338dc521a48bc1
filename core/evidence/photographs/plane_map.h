// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// From a plane to its photograph: a homography of any number of points.
#include <optional>
#include <span>

#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

/// (x, y, 1) -> (x', y', 1) up to scale, of norm 1.
struct PlaneMap {
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Identity();
  Vec2 operator()(const Vec2& p) const { return (matrix * Vec3(p.x(), p.y(), 1)).hnormalized(); }
};

/// Least squares in the algebraic distance of centred, scaled points (Hartley and Zisserman 2004, alg. 4.2). None where
/// the points do not determine one: fewer than four, or all near a line. Both lists have equal length.
std::optional<PlaneMap> fit_plane_map(std::span<const Vec2> from, std::span<const Vec2> to);

}  // namespace formwright
