// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/photographs/camera_start.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace formwright {

std::optional<double> focal_of_maps(std::span<const PlaneMap> maps, double scale_px) {
  // h1 and h2 are images of perpendicular directions of equal length, so that with w = 1 / focal^2:
  // w (h1 . h2 of x and y) + z1 z2 = 0 and w (|h1|^2 - |h2|^2 of x and y) + z1^2 - z2^2 = 0.
  double numerator = 0, denominator = 0;
  for (const PlaneMap& map : maps) {
    Vec3 a = map.matrix.col(0), b = map.matrix.col(1);
    a.head<2>() /= scale_px;
    b.head<2>() /= scale_px;
    const double size = a.norm() * b.norm();
    if (!(size > 0)) continue;
    for (const auto& [p, q] : {std::pair{a.head<2>().dot(b.head<2>()) / size, a.z() * b.z() / size},
                               std::pair{(a.head<2>().squaredNorm() - b.head<2>().squaredNorm()) / size,
                                         (a.z() * a.z() - b.z() * b.z()) / size}}) {
      numerator -= p * q;
      denominator += q * q;  // solves for focal^2 = -p / q, weighted by q^2
    }
  }
  if (!(denominator > 0) || !(numerator > 0)) return std::nullopt;
  const double focal = std::sqrt(numerator / denominator);
  if (!(focal > 0.2 && focal < 20)) return std::nullopt;
  return focal * scale_px;
}

std::optional<Pose> pose_of_map(const PlaneMap& map, double focal_px, double plane_z_mm) {
  Eigen::Matrix3d m = map.matrix;
  m.topRows<2>() /= focal_px;
  const double size = 0.5 * (m.col(0).norm() + m.col(1).norm());
  if (!(size > 0) || !m.allFinite()) return std::nullopt;
  m /= m(2, 2) < 0 ? -size : size;  // the board lies in front of the camera
  Eigen::Matrix3d frame;
  frame << m.col(0), m.col(1), m.col(0).cross(m.col(1));
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(frame, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Pose pose;
  pose.rotation = svd.matrixU() * svd.matrixV().transpose();
  if (pose.rotation.determinant() < 0) return std::nullopt;
  pose.translation = m.col(2) - pose.rotation.col(2) * plane_z_mm;
  return pose;
}

std::optional<Vec3> nearest_point(std::span<const SightRay> rays) {
  if (rays.size() < 2) return std::nullopt;
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Vec3 right = Vec3::Zero();
  for (const SightRay& ray : rays) {
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - ray.direction * ray.direction.transpose();
    normal += across;
    right += across * ray.origin;
  }
  const Eigen::LDLT<Eigen::Matrix3d> solver(normal);
  if (!(solver.vectorD().minCoeff() > 1e-7)) return std::nullopt;
  const Vec3 point = solver.solve(right);
  if (!point.allFinite()) return std::nullopt;
  return point;
}

double widest_angle_rad(std::span<const SightRay> rays) {
  double widest = 0;
  for (std::size_t i = 0; i < rays.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      widest = std::max(widest, std::atan2(rays[i].direction.cross(rays[j].direction).norm(),
                                           rays[i].direction.dot(rays[j].direction)));
  return widest;
}

}  // namespace formwright
