// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/baselines.h"

#include <cmath>

namespace formwright {
namespace {

/// The affine map of `z` over the marked vertices onto [-thickness, 0]; all at 0 when they have one depth.
Eigen::VectorXd fitted_to_slab(const Eigen::VectorXd& z, double thickness, const std::vector<char>& marked) {
  double low = INFINITY, high = -INFINITY;
  for (Eigen::Index i = 0; i < z.size(); ++i)
    if (marked[static_cast<std::size_t>(i)]) {
      low = std::min(low, z[i]);
      high = std::max(high, z[i]);
    }
  if (!(high > low)) return Eigen::VectorXd::Zero(z.size());
  return (z.array() - high) * (thickness / (high - low));
}

Eigen::VectorXd to_u(const ViewFrame& frame, const Eigen::VectorXd& z) {
  Eigen::VectorXd u(z.size());
  for (int i = 0; i < z.size(); ++i) u[i] = frame.u_for_depth(i, z[i]);
  return u;
}

}  // namespace

Eigen::VectorXd linear_compression(const ViewFrame& frame, const DepthBounds& bounds) {
  double low = INFINITY, high = -INFINITY;
  for (Eigen::Index i = 0; i < frame.P.rows(); ++i)
    if (bounds.bounded[static_cast<std::size_t>(i)]) {
      low = std::min(low, frame.P(i, 2));
      high = std::max(high, frame.P(i, 2));
    }
  Eigen::VectorXd z = bounds.farthest;
  if (high > low)
    for (Eigen::Index i = 0; i < z.size(); ++i)
      z[i] += (frame.P(i, 2) - high) * ((bounds.farthest[i] - bounds.nearest[i]) / (high - low));
  return to_u(frame, z);
}

Eigen::VectorXd gradient_domain_compression(const ViewFrame& frame, const Triangles& F, const Visibility& visibility,
                                            double thickness, const GradientCompressionOptions& options,
                                            Context& context) {
  const Eigen::Index n = frame.P.rows();
  const Eigen::VectorXd linear = fitted_to_slab(frame.P.col(2), thickness, visibility.vertex);
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd rhs = Eigen::VectorXd::Zero(n), diagonal = Eigen::VectorXd::Zero(n);
  Positions picture(n, 3);
  for (Eigen::Index i = 0; i < n; ++i)
    picture.row(i) << frame.P.row(i).head<2>() / (1 + frame.kappa * frame.P(i, 2)), 0.0;

  for (Eigen::Index f = 0; f < F.rows(); ++f) {
    if (!visibility.face[static_cast<std::size_t>(f)]) continue;
    const Eigen::RowVector2d a = picture.row(F(f, 0)).head<2>(), b = picture.row(F(f, 1)).head<2>(),
                             c = picture.row(F(f, 2)).head<2>();
    const double doubled = (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
    if (std::abs(doubled) < 1e-14) continue;  // edge-on: no gradient in the picture
    Eigen::Matrix<double, 3, 2> shape;        // gradients of the three hat functions
    shape << b.y() - c.y(), c.x() - b.x(), c.y() - a.y(), a.x() - c.x(), a.y() - b.y(), b.x() - a.x();
    shape /= doubled;
    const Vec3 z(frame.P(F(f, 0), 2), frame.P(F(f, 1), 2), frame.P(F(f, 2), 2));
    Vec2 gradient = shape.transpose() * z;
    const double length = gradient.norm();
    if (length > options.steepest_slope) gradient.setZero();
    else if (length > 0) gradient *= std::log1p(options.compression * length) / (options.compression * length);
    const double area = 0.5 * std::abs(doubled);
    for (int j = 0; j < 3; ++j) {
      rhs[F(f, j)] += area * shape.row(j).dot(gradient);
      for (int k = 0; k < 3; ++k) {
        const double value = area * shape.row(j).dot(shape.row(k));
        if (j == k) diagonal[F(f, j)] += value;
        else if (F(f, j) > F(f, k)) entries.emplace_back(F(f, j), F(f, k), value);
      }
    }
  }
  // A weak spring fixes the free constant of every visible patch; hidden vertices follow it alone.
  const double spring = 1e-6 * std::max(diagonal.mean(), 1e-12);
  const double spread = thickness > 0 ? (frame.P.col(2).maxCoeff() - frame.P.col(2).minCoeff()) / thickness : 1;
  for (int i = 0; i < n; ++i) {
    entries.emplace_back(i, i, diagonal[i] + spring);
    rhs[i] += spring * linear[i] * spread * 0.3;
  }
  SparseMatrix A(n, n);
  A.setFromTriplets(entries.begin(), entries.end());
  SparseCholesky cholesky;
  cholesky.analyze(A, picture, context);
  cholesky.factorize(A, context);
  Eigen::MatrixXd z = rhs;
  cholesky.solve(z);
  Eigen::VectorXd fitted = fitted_to_slab(z, thickness, visibility.vertex);
  for (int i = 0; i < n; ++i)
    if (!visibility.vertex[static_cast<std::size_t>(i)]) fitted[i] = linear[i];
  return to_u(frame, fitted);
}

}  // namespace formwright
