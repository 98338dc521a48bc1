// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The symmetric Dirichlet energy of a triangle's map into the plane, |J|^2 + |J^-1|^2 (Smith & Schaefer 2015), with its
// gradient and Hessian from the singular values of J (Smith, de Goes, Kim 2019, "Analytic Eigensystems"): stretching
// and flipping modes are always convex, only the twist may not be.
#include <Eigen/Core>
#include <Eigen/LU>
#include <array>

#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

/// d(reference coordinates) as gradients of the three hat functions: J = sum over corners of u_k g_k^T.
struct ReferenceTriangle {
  std::array<Vec2, 3> g;  // 1 / mm
  double area = 0;        // mm^2
};

/// From side lengths; corner 0 at the origin, side 01 along x. Needs a triangle with area.
ReferenceTriangle reference_triangle(double length_01, double length_12, double length_20);

Eigen::Matrix2d jacobian(const ReferenceTriangle& reference, const std::array<Vec2, 3>& u);

/// 4 where the map is a rigid motion, more elsewhere, infinite where the triangle is not positively oriented.
double symmetric_dirichlet(const Eigen::Matrix2d& J);

struct DirichletTerms {
  double energy = 0;                     // without the area
  Eigen::Matrix<double, 6, 1> gradient;  // by (x0, y0, x1, y1, x2, y2)
  Eigen::Matrix<double, 6, 6> hessian;
};

/// Needs a positively oriented map. With `convex`, a negative twist eigenvalue counts as 0: the Hessian is then
/// positive semidefinite.
DirichletTerms symmetric_dirichlet_terms(const ReferenceTriangle& reference, const std::array<Vec2, 3>& u, bool convex);

}  // namespace formwright
