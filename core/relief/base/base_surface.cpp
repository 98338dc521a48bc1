// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/base/base_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace formwright {
namespace {

/// The part of a polygon on one side of a plane through one axis (Sutherland and Hodgman 1974): side * p[axis] <=
/// limit.
std::vector<Vec3> clipped(const std::vector<Vec3>& polygon, int axis, double side, double limit) {
  std::vector<Vec3> inside;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vec3 &p = polygon[k], &q = polygon[(k + 1) % polygon.size()];
    const double a = side * p[axis] - limit, b = side * q[axis] - limit;
    if (a <= 0) inside.push_back(p);
    if ((a < 0 && b > 0) || (a > 0 && b < 0)) inside.push_back(p + (q - p) * (a / (a - b)));
  }
  return inside;
}

}  // namespace

BaseSurface::BaseSurface(const TriangleMesh& mesh, std::optional<BaseBands> bands,
                         std::shared_ptr<const BaseParts> parts)
    : mesh_(mesh),
      bands_(std::move(bands)),
      parts_(std::move(parts)),
      caster_(std::make_shared<const RayCaster>(mesh)) {
  front_ = std::min(0.0, mesh.V.col(2).minCoeff()) - 1;
  far_ = 4 * (mesh.V.rowwise().norm().maxCoeff() + 1) - front_;
}

double BaseSurface::max_along_z() const {
  double longest = 1;
  for (int band = 0; bands_ && band < bands_->count(); ++band) longest = std::max(longest, bands_->along_z(band));
  return longest;
}

std::optional<double> BaseSurface::depth_on_ray(const ViewFrame& frame, Eigen::Index vertex, double shift) const {
  if (is_flat()) return shift;
  const Vec3 p = frame.P.row(vertex).transpose();
  if (bands_) return bands_->depth_on_ray(frame, bands_->of_ray(frame, p), p, shift);
  if (frame.kappa == 0) {
    const std::optional<double> depth = depth_at(p.x(), p.y());
    if (!depth) return std::nullopt;
    return *depth + shift;
  }
  // The viewpoint is moved instead of the base.
  const Vec3 viewpoint(0, 0, -1 / frame.kappa), origin = viewpoint - Vec3(0, 0, shift);
  const Vec3 direction = (p - viewpoint).normalized();
  const auto hit = caster_->first_hit(origin, direction, 0, far_ + 2 / frame.kappa);
  if (!hit) return std::nullopt;
  return (origin + hit->distance * direction).z() + shift;
}

std::optional<double> BaseSurface::depth_at(double x, double y) const {
  if (is_flat()) return 0.0;
  const auto hit = caster_->first_hit(Vec3(x, y, front_), Vec3::UnitZ(), 0, far_);
  if (!hit) return std::nullopt;
  return front_ + hit->distance;
}

std::optional<std::pair<double, double>> BaseSurface::depth_range(double half_x, double half_y) const {
  if (is_flat()) return std::pair{0.0, 0.0};
  double least = INFINITY, largest = -INFINITY;
  for (Eigen::Index f = 0; f < mesh_.F.rows(); ++f) {
    Eigen::Matrix3d corner;  // one a row
    for (int k = 0; k < 3; ++k) corner.row(k) = mesh_.V.row(mesh_.F(f, k));
    const Vec3 low = corner.colwise().minCoeff(), high = corner.colwise().maxCoeff();
    if (low.z() >= least && high.z() <= largest) continue;  // changes nothing
    if (high.x() < -half_x || low.x() > half_x || high.y() < -half_y || low.y() > half_y) continue;
    std::vector<Vec3> polygon{corner.row(0), corner.row(1), corner.row(2)};
    for (const auto& [axis, limit] : {std::pair{0, half_x}, std::pair{1, half_y}})
      for (const double side : {-1.0, 1.0}) polygon = clipped(polygon, axis, side, limit);
    for (const Vec3& p : polygon) {
      least = std::min(least, p.z());
      largest = std::max(largest, p.z());
    }
  }
  if (!(least <= largest)) return std::nullopt;
  return std::pair{least, largest};
}

}  // namespace formwright
