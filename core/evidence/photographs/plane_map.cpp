// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/photographs/plane_map.h"

#include <Eigen/Dense>
#include <cmath>

namespace formwright {
namespace {

/// Moves the points' mean to 0 and their mean distance from it to the square root of 2.
Eigen::Matrix3d centred_scale(std::span<const Vec2> points) {
  Vec2 mean(0, 0);
  for (const Vec2& p : points) mean += p / static_cast<double>(points.size());
  double distance = 0;
  for (const Vec2& p : points) distance += (p - mean).norm() / static_cast<double>(points.size());
  const double scale = std::sqrt(2.0) / std::max(distance, 1e-300);
  Eigen::Matrix3d m;
  m << scale, 0, -scale * mean.x(), 0, scale, -scale * mean.y(), 0, 0, 1;
  return m;
}

}  // namespace

std::optional<PlaneMap> fit_plane_map(std::span<const Vec2> from, std::span<const Vec2> to) {
  if (from.size() < 4 || from.size() != to.size()) return std::nullopt;
  const Eigen::Matrix3d a = centred_scale(from), b = centred_scale(to);
  Eigen::Matrix<double, 9, 9> normal = Eigen::Matrix<double, 9, 9>::Zero();
  for (std::size_t i = 0; i < from.size(); ++i) {
    const Vec3 p = a * from[i].homogeneous(), q = b * to[i].homogeneous();
    Eigen::Matrix<double, 2, 9> rows;
    rows << p.transpose(), Eigen::RowVector3d::Zero(), -q.x() * p.transpose(), Eigen::RowVector3d::Zero(),
        p.transpose(), -q.y() * p.transpose();
    normal += rows.transpose() * rows;
  }
  if (!normal.allFinite()) return std::nullopt;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 9, 9>> eigen(normal);
  // The second smallest eigenvalue tells whether more than one map fits.
  if (eigen.info() != Eigen::Success || !(eigen.eigenvalues()[1] > 1e-9 * eigen.eigenvalues()[8])) return std::nullopt;
  const Eigen::Matrix<double, 9, 1> h = eigen.eigenvectors().col(0);
  Eigen::Matrix3d m;
  m << h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], h[8];
  m = b.inverse() * m * a;
  if (!m.allFinite() || !(m.norm() > 0)) return std::nullopt;
  return PlaneMap{m / m.norm()};
}

}  // namespace formwright
