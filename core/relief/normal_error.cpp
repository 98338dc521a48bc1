// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/normal_error.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace formwright {
namespace {

Vec3 corner_cross(const Positions& P, const Triangles& F, Eigen::Index f) {
  const Vec3 a = P.row(F(f, 0)).transpose();
  return (P.row(F(f, 1)).transpose() - a).cross(P.row(F(f, 2)).transpose() - a);
}

/// atan2 keeps small angles exact, where acos of a dot product would not. 0 if either has no direction.
double angle_deg(const Vec3& a, const Vec3& b) {
  const double sine = a.cross(b).norm(), cosine = a.dot(b);
  return sine == 0 && cosine == 0 ? 0 : std::atan2(sine, cosine) * 180 / std::numbers::pi;
}

/// Area the face covers on the plate (up to a common factor): of the projected triangle.
double image_area(const ViewFrame& frame, const Triangles& F, Eigen::Index f) {
  Eigen::Matrix<double, 3, 2> q;
  for (int k = 0; k < 3; ++k) q.row(k) = frame.P.row(F(f, k)).head<2>() / (1 + frame.kappa * frame.P(F(f, k), 2));
  const Vec2 e1 = (q.row(1) - q.row(0)).transpose(), e2 = (q.row(2) - q.row(0)).transpose();
  return 0.5 * std::abs(e1.x() * e2.y() - e1.y() * e2.x());
}

}  // namespace

NormalError normal_error(const ViewFrame& frame, const Triangles& F, const Visibility& visibility,
                         const Positions& moved) {
  const Eigen::Index n = frame.P.rows();
  NormalError result;
  Positions before = Positions::Zero(n, 3), after = Positions::Zero(n, 3);
  double area_sum = 0, area_angle = 0, image_sum = 0, image_angle = 0;
  for (Eigen::Index f = 0; f < F.rows(); ++f) {
    const Vec3 old_normal = corner_cross(frame.P, F, f), new_normal = corner_cross(moved, F, f);
    for (int k = 0; k < 3; ++k) {
      before.row(F(f, k)) += old_normal.transpose();
      after.row(F(f, k)) += new_normal.transpose();
    }
    if (!visibility.face[static_cast<std::size_t>(f)]) continue;
    const double angle = angle_deg(old_normal, new_normal), area = 0.5 * old_normal.norm(),
                 picture = image_area(frame, F, f);
    area_sum += area;
    area_angle += area * angle;
    image_sum += picture;
    image_angle += picture * angle;
  }
  if (area_sum > 0) result.mean_deg = area_angle / area_sum;
  if (image_sum > 0) result.mean_deg_image = image_angle / image_sum;
  result.vertex_deg.resize(n);
  for (Eigen::Index i = 0; i < n; ++i)
    result.vertex_deg[i] = angle_deg(before.row(i).transpose(), after.row(i).transpose());
  return result;
}

}  // namespace formwright
