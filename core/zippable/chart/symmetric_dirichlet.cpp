// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/chart/symmetric_dirichlet.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace formwright {
namespace {

struct Singular {
  double larger, smaller;  // > 0
  Vec2 u1, v1;             // J v1 = larger u1; the other pair is a quarter turn on
};

/// Needs det J > 0. With J z = a z + b conj(z) in complex numbers, the singular values are |a| +- |b|.
Singular singular_values(const Eigen::Matrix2d& J) {
  const double ar = 0.5 * (J(0, 0) + J(1, 1)), ai = 0.5 * (J(1, 0) - J(0, 1));
  const double br = 0.5 * (J(0, 0) - J(1, 1)), bi = 0.5 * (J(1, 0) + J(0, 1));
  const double larger = std::sqrt(ar * ar + ai * ai) + std::sqrt(br * br + bi * bi);
  const double angle_a = std::atan2(ai, ar), angle_b = br == 0 && bi == 0 ? 0.0 : std::atan2(bi, br);
  const double u = 0.5 * (angle_a + angle_b), v = 0.5 * (angle_b - angle_a);
  return {larger, J.determinant() / larger, {std::cos(u), std::sin(u)}, {std::cos(v), std::sin(v)}};
}

Vec2 quarter_turn(const Vec2& a) { return {-a.y(), a.x()}; }

}  // namespace

ReferenceTriangle reference_triangle(double length_01, double length_12, double length_20) {
  const double x = (length_01 * length_01 + length_20 * length_20 - length_12 * length_12) / (2 * length_01);
  const double y = std::sqrt(std::max(length_20 * length_20 - x * x, 1e-30 * length_20 * length_20));
  ReferenceTriangle t;
  t.area = 0.5 * length_01 * y;
  // Rows of the inverse of [(length_01, 0), (x, y)].
  t.g[1] = Vec2(1 / length_01, -x / (length_01 * y));
  t.g[2] = Vec2(0, 1 / y);
  t.g[0] = -t.g[1] - t.g[2];
  return t;
}

Eigen::Matrix2d jacobian(const ReferenceTriangle& reference, const std::array<Vec2, 3>& u) {
  return (u[1] - u[0]) * reference.g[1].transpose() + (u[2] - u[0]) * reference.g[2].transpose();
}

double symmetric_dirichlet(const Eigen::Matrix2d& J) {
  const double det = J.determinant();
  if (!(det > 0)) return std::numeric_limits<double>::infinity();
  return J.squaredNorm() * (1 + 1 / (det * det));
}

DirichletTerms symmetric_dirichlet_terms(const ReferenceTriangle& reference, const std::array<Vec2, 3>& u,
                                         bool convex) {
  const Singular s = singular_values(jacobian(reference, u));
  const double a = s.larger, b = s.smaller;
  const Vec2 u2 = quarter_turn(s.u1), v2 = quarter_turn(s.v1);
  DirichletTerms t;
  t.energy = a * a + b * b + 1 / (a * a) + 1 / (b * b);
  const double slope_a = 2 * a - 2 / (a * a * a), slope_b = 2 * b - 2 / (b * b * b);
  const double cubes = a * a * a * b * b * b;
  double twist = 2 - 2 * (a * a - a * b + b * b) / cubes;
  if (convex) twist = std::max(twist, 0.0);
  const std::array<double, 4> eigenvalue{2 + 6 / (a * a * a * a), 2 + 6 / (b * b * b * b),
                                         2 + 2 * (a * a + a * b + b * b) / cubes, twist};
  std::array<Eigen::Matrix<double, 6, 1>, 4> mode;
  for (int k = 0; k < 3; ++k) {
    const double along = s.v1.dot(reference.g[k]), across = v2.dot(reference.g[k]);
    mode[0].segment<2>(2 * k) = along * s.u1;
    mode[1].segment<2>(2 * k) = across * u2;
    mode[2].segment<2>(2 * k) = std::sqrt(0.5) * (across * s.u1 + along * u2);
    mode[3].segment<2>(2 * k) = std::sqrt(0.5) * (across * s.u1 - along * u2);
  }
  t.gradient = slope_a * mode[0] + slope_b * mode[1];
  t.hessian.setZero();
  for (int m = 0; m < 4; ++m)
    for (int j = 0; j < 6; ++j) {
      const double weight = eigenvalue[m] * mode[m][j];
      for (int i = 0; i < 6; ++i) t.hessian(i, j) += weight * mode[m][i];
    }
  return t;
}

}  // namespace formwright
