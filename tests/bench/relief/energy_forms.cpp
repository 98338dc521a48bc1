// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/relief/energy_forms.h"

#include <Eigen/Geometry>
#include <cmath>
#include <utility>
#include <vector>

#include "geometry/operators/laplacian.h"

namespace formwright::test {
namespace {

/// Area-weighted.
Positions vertex_normals(const Positions& P, const Triangles& F) {
  Positions normals = Positions::Zero(P.rows(), 3);
  for (Eigen::Index f = 0; f < F.rows(); ++f) {
    const Vec3 a = P.row(F(f, 0)), b = P.row(F(f, 1)), c = P.row(F(f, 2));
    const Vec3 normal = (b - a).cross(c - a);
    for (int k = 0; k < 3; ++k) normals.row(F(f, k)) += normal.transpose();
  }
  return normals;
}

/// With its sign, but no smaller than the share of the mean.
Eigen::VectorXd floored(const Eigen::VectorXd& curvature, double floor_share) {
  const double floor = floor_share * curvature.cwiseAbs().mean();
  return curvature.unaryExpr([floor](double h) { return std::copysign(std::max(std::abs(h), floor), h); });
}

Positions scaled_rows(const Positions& rows, const Eigen::VectorXd& factor) { return factor.asDiagonal() * rows; }

}  // namespace

EnergyForms::EnergyForms(const ViewFrame& frame, Triangles F)
    : frame_(frame), F_(std::move(F)), rays_(frame.kappa * frame.P), model_(surface_at(frame.P)) {
  rays_.col(2).array() += 1;
}

EnergyForms::Surface EnergyForms::surface_at(const Positions& P) const {
  const TriangleMesh mesh{P, F_};
  Surface surface{cotangent_laplacian(mesh), vertex_areas(mesh), {}, {}};
  surface.mean_curvature_normal = surface.area.cwiseInverse().asDiagonal() * (surface.laplacian * P);
  surface.curvature = surface.mean_curvature_normal.rowwise().norm();
  const Positions normals = vertex_normals(P, F_);
  for (Eigen::Index i = 0; i < P.rows(); ++i)
    if (surface.mean_curvature_normal.row(i).dot(normals.row(i)) < 0) surface.curvature[i] *= -1;
  return surface;
}

Positions EnergyForms::laplacian_of_model(const Surface& surface) const {
  return surface.area.cwiseInverse().asDiagonal() * (surface.laplacian * frame_.P);
}

/// Term i: weight_i ((L D_u ray)_i + own_slope_i u_i + constant_i).
LeastSquares EnergyForms::rows_of(const Surface& surface, const Eigen::VectorXd& weight, const Positions& own_slope,
                                  const Positions& constant) const {
  const Eigen::Index n = weight.size();
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(static_cast<std::size_t>(3 * surface.laplacian.nonZeros()));
  LeastSquares result{SparseMatrix(3 * n, n), Eigen::VectorXd(3 * n)};
  for (int j = 0; j < n; ++j)
    for (SparseMatrix::InnerIterator it(surface.laplacian, j); it; ++it) {
      const auto i = static_cast<int>(it.row());
      for (int k = 0; k < 3; ++k) {
        double slope = it.value() / surface.area[i] * rays_(j, k);
        if (i == j) slope += own_slope(i, k);
        entries.emplace_back(3 * i + k, j, weight[i] * slope);
      }
    }
  result.rows.setFromTriplets(entries.begin(), entries.end());
  for (Eigen::Index i = 0; i < n; ++i) result.constant.segment<3>(3 * i) = weight[i] * constant.row(i).transpose();
  return result;
}

LeastSquares EnergyForms::proposed() const {
  // (L0 x0)_i (s_i - 1) = (L0 p)_i kappa u_i, because L annihilates constants and x0 = p + e_z / kappa.
  return rows_of(model_, model_.area.cwiseSqrt(), -frame_.kappa * model_.mean_curvature_normal,
                 Positions::Zero(frame_.P.rows(), 3));
}

LeastSquares EnergyForms::scale_dependent() const {
  const Positions none = Positions::Zero(frame_.P.rows(), 3);
  return rows_of(model_, model_.area.cwiseSqrt(), none, none);
}

LeastSquares EnergyForms::curvature_divided(double floor_share) const {
  const Eigen::VectorXd weight = model_.area.cwiseSqrt().cwiseQuotient(floored(model_.curvature, floor_share));
  return rows_of(model_, weight, -frame_.kappa * model_.mean_curvature_normal, Positions::Zero(frame_.P.rows(), 3));
}

LeastSquares EnergyForms::updated(const Eigen::VectorXd& deformed) const {
  const Surface now = surface_at(frame_.moved(deformed));
  // The deformed vertices are p + D_u ray.
  const Eigen::VectorXd shrinking = (1 + frame_.kappa * deformed.array()).inverse();
  const Positions target = scaled_rows(model_.mean_curvature_normal, shrinking);
  return rows_of(now, now.area.cwiseSqrt(), Positions::Zero(frame_.P.rows(), 3), laplacian_of_model(now) - target);
}

LeastSquares EnergyForms::updated_normals(const Eigen::VectorXd& deformed, double floor_share) const {
  const Surface now = surface_at(frame_.moved(deformed));
  const Eigen::VectorXd curvature = floored(now.curvature, floor_share);
  // Term i of eq. (3.6) times H_i, which the weight divides out again.
  const Positions target =
      scaled_rows(model_.mean_curvature_normal, curvature.cwiseQuotient(floored(model_.curvature, floor_share)));
  return rows_of(now, now.area.cwiseSqrt().cwiseQuotient(curvature), Positions::Zero(frame_.P.rows(), 3),
                 laplacian_of_model(now) - target);
}

double EnergyForms::curvature_range(double floor_share) const {
  const Eigen::VectorXd size = floored(model_.curvature, floor_share).cwiseAbs();
  return size.maxCoeff() / size.minCoeff();
}

}  // namespace formwright::test
