// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/photographs/camera.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace formwright {

void Lens::add(const Eigen::Matrix<double, unknowns, 1>& step) {
  focal_px += scale_px() * step[0];
  centre_px += scale_px() * Vec2(step[1], step[2]);
  k1 += step[3];
  k2 += step[4];
}

std::optional<Vec3> Lens::ray(const Vec2& picture_px) const {
  const Vec2 distorted = (picture_px - centre_px) / focal_px;
  const double target = distorted.norm();
  double r = target;
  for (int round = 0; round < 30; ++round) {
    const double r2 = r * r, value = r * (1 + k1 * r2 + k2 * r2 * r2) - target,
                 slope = 1 + 3 * k1 * r2 + 5 * k2 * r2 * r2;
    if (!(slope > 0.05)) return std::nullopt;
    const double step = value / slope;
    r = std::max(0.0, r - step);
    if (std::abs(step) < 1e-15 * (1 + r)) break;
  }
  if (!std::isfinite(r)) return std::nullopt;
  const Vec2 x = target > 0 ? Vec2(distorted * (r / target)) : distorted;
  return Vec3(x.x(), x.y(), 1);
}

void Pose::add(const Eigen::Matrix<double, unknowns, 1>& step) {
  const Vec3 turn = step.head<3>();
  if (const double angle = turn.norm(); angle > 0) {
    rotation = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix() * rotation;
    rotation = Eigen::Quaterniond(rotation).normalized().toRotationMatrix();
  }
  translation += step.tail<3>();
}

std::optional<Vec2> project(const Lens& lens, const Pose& pose, const Vec3& point_mm,
                            ProjectionDerivatives* derivatives) {
  const Vec3 turned = pose.rotation * point_mm, c = turned + pose.translation;
  if (!(c.z() > 1e-6)) return std::nullopt;
  const double x = c.x() / c.z(), y = c.y() / c.z(), r2 = x * x + y * y;
  const double d = 1 + lens.k1 * r2 + lens.k2 * r2 * r2, slope = 1 + 3 * lens.k1 * r2 + 5 * lens.k2 * r2 * r2;
  if (!(slope > 0.02) || !(d > 0)) return std::nullopt;
  const double f = lens.focal_px, s = lens.scale_px();
  if (derivatives) {
    const double e = 2 * lens.k1 + 4 * lens.k2 * r2;  // grad d = e (x, y)
    Eigen::Matrix2d by_x;
    by_x << d + e * x * x, e * x * y, e * x * y, d + e * y * y;
    Eigen::Matrix<double, 2, 3> by_c;
    by_c << 1 / c.z(), 0, -x / c.z(), 0, 1 / c.z(), -y / c.z();
    by_c = f * by_x * by_c;
    derivatives->lens << s * d * x, s, 0, f * x * r2, f * x * r2 * r2, s * d * y, 0, s, f * y * r2, f * y * r2 * r2;
    Eigen::Matrix3d by_turn;  // of w x turned
    by_turn << 0, turned.z(), -turned.y(), -turned.z(), 0, turned.x(), turned.y(), -turned.x(), 0;
    derivatives->pose << by_c * by_turn, by_c;
    derivatives->point = by_c * pose.rotation;
  }
  return Vec2(lens.centre_px + f * d * Vec2(x, y));
}

}  // namespace formwright
