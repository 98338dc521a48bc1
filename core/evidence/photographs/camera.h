// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A pinhole with a lens: where a point in space lies in a photograph, with derivatives.
#include <Eigen/Core>
#include <optional>

#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

/// x = X / Z, r^2 = |x|^2; picture = centre + focal (1 + k1 r^2 + k2 r^4) x (Hartley and Zisserman 2004, 7.4).
struct Lens {
  int width = 0, height = 0;  // of its photographs
  double focal_px = 0;
  Vec2 centre_px{0, 0};
  double k1 = 0, k2 = 0;

  static constexpr int unknowns = 5;  // focal / scale, centre / scale (x, y), k1, k2; scale is the longer side
  double scale_px() const { return std::max(width, height); }
  void add(const Eigen::Matrix<double, unknowns, 1>& step);
  /// The direction (x, y, 1) that is seen at a place in the picture, by Newton's method on the radius; none where the
  /// lens does not reach.
  std::optional<Vec3> ray(const Vec2& picture_px) const;
};

/// Machine coordinates to the camera's: x to the right, y down, z forwards.
struct Pose {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Vec3 translation{0, 0, 0};

  static constexpr int unknowns = 6;  // a turn (vector of axis and angle) after the rotation, a shift
  Vec3 operator()(const Vec3& p) const { return rotation * p + translation; }
  Vec3 centre() const { return -rotation.transpose() * translation; }
  void add(const Eigen::Matrix<double, unknowns, 1>& step);
};

/// Derivatives of a projection, in pixels.
struct ProjectionDerivatives {
  Eigen::Matrix<double, 2, Lens::unknowns> lens;
  Eigen::Matrix<double, 2, Pose::unknowns> pose;
  Eigen::Matrix<double, 2, 3> point;
};

/// None behind the camera, or so far beside it that the lens' polynomial has turned back.
std::optional<Vec2> project(const Lens& lens, const Pose& pose, const Vec3& point_mm,
                            ProjectionDerivatives* derivatives = nullptr);

}  // namespace formwright
