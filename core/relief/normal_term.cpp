// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/normal_term.h"

#include <Eigen/Geometry>
#include <cmath>

#include "base/index.h"
#include "base/parallel.h"

namespace formwright {
namespace {
constexpr std::size_t faces_per_chunk = 4096;

/// Twice the area that a face covers on the plate.
double picture_area(const ViewFrame& frame, const std::array<int, 3>& corner) {
  Eigen::Matrix<double, 3, 2> q;
  for (int k = 0; k < 3; ++k)
    q.row(k) = frame.P.row(corner[index(k)]).head<2>() / (1 + frame.kappa * frame.P(corner[index(k)], 2));
  const Eigen::RowVector2d a = q.row(1) - q.row(0), b = q.row(2) - q.row(0);
  return std::abs(a.x() * b.y() - a.y() * b.x());
}
}  // namespace

NormalTerm::NormalTerm(const ViewFrame& frame, const Triangles& F, const Visibility& visibility,
                       const Eigen::VectorXd& painted_weight)
    : P_(frame.P) {
  rays_ = frame.kappa * frame.P;
  rays_.col(2).array() += 1;
  double sum = 0;
  for (Eigen::Index f = 0; f < F.rows(); ++f) {
    if (!visibility.face[static_cast<std::size_t>(f)]) continue;
    const std::array<int, 3> corner{F(f, 0), F(f, 1), F(f, 2)};
    const Vec3 a = P_.row(corner[0]).transpose();
    const Vec3 normal = (P_.row(corner[1]).transpose() - a).cross(P_.row(corner[2]).transpose() - a);
    const double length = normal.norm();
    double area = picture_area(frame, corner);
    if (!(length > 0) || !(area > 0)) continue;
    if (painted_weight.size() > 0)
      area *= Vec3(painted_weight[corner[0]], painted_weight[corner[1]], painted_weight[corner[2]]).squaredNorm() / 3;
    corners_.push_back(corner);
    normal_.push_back(normal / length);
    share_.push_back(area);
    sum += area;
  }
  for (double& share : share_) share /= sum;
}

double NormalTerm::operator()(const Eigen::VectorXd& u) const {
  double sum = 0;
  for (std::size_t f = 0; f < corners_.size(); ++f) {
    std::array<Vec3, 3> x;
    for (std::size_t k = 0; k < 3; ++k)
      x[k] = (P_.row(corners_[f][k]) + u[corners_[f][k]] * rays_.row(corners_[f][k])).transpose();
    const Vec3 normal = (x[1] - x[0]).cross(x[2] - x[0]);
    const double length = normal.norm();
    sum += length > 0 ? 0.5 * share_[f] * (normal / length - normal_[f]).squaredNorm() : share_[f];
  }
  return sum;
}

double NormalTerm::linearise(const Eigen::VectorXd& u, Eigen::VectorXd& gradient, std::vector<FaceModel>& faces) const {
  faces.resize(corners_.size());
  std::vector<double> values(corners_.size());
  parallel_for(corners_.size(), faces_per_chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      std::array<Vec3, 3> x, ray;
      for (std::size_t k = 0; k < 3; ++k) {
        ray[k] = rays_.row(corners_[f][k]).transpose();
        x[k] = P_.row(corners_[f][k]).transpose() + u[corners_[f][k]] * ray[k];
      }
      Vec3 normal = (x[1] - x[0]).cross(x[2] - x[0]);
      const double length = normal.norm();
      FaceModel& model = faces[f];
      if (!(length > 0)) {
        model = {};
        values[f] = share_[f];
        continue;
      }
      normal /= length;
      std::array<Vec3, 3> change;  // of the unit normal with each u
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 turned = ray[k].cross(x[(k + 1) % 3] - x[(k + 2) % 3]);
        change[k] = (turned - normal.dot(turned) * normal) / length;
        model.gradient[k] = -share_[f] * change[k].dot(normal_[f]);
        model.hessian[k] = share_[f] * change[k].squaredNorm();
      }
      model.hessian[3] = share_[f] * change[1].dot(change[0]);
      model.hessian[4] = share_[f] * change[2].dot(change[0]);
      model.hessian[5] = share_[f] * change[2].dot(change[1]);
      values[f] = 0.5 * share_[f] * (normal - normal_[f]).squaredNorm();
    }
  });
  gradient.setZero(P_.rows());
  double sum = 0;
  for (std::size_t f = 0; f < corners_.size(); ++f) {
    for (std::size_t k = 0; k < 3; ++k) gradient[corners_[f][k]] += faces[f].gradient[k];
    sum += values[f];
  }
  return sum;
}

}  // namespace formwright
