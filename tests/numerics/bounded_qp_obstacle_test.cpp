// SPDX-License-Identifier: GPL-3.0-or-later
// A beam pressed between two rails: the fourth-order obstacle problem in one dimension.
#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "numerics/bounded_qp.h"

namespace formwright {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Q = sum over edges of stiffness (u_j - u_i)^2 for a chain: null space the constants.
SparseMatrix chain(int n, double stiffness) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < n; ++i) {
    entries.emplace_back(i, i, stiffness * ((i > 0) + (i + 1 < n)));
    if (i + 1 < n) entries.emplace_back(i + 1, i, -stiffness);
  }
  SparseMatrix Q(n, n);
  Q.setFromTriplets(entries.begin(), entries.end());
  return Q;
}

BoundedQpConstraints free_constraints(int n) {
  BoundedQpConstraints c;
  c.lower = Eigen::VectorXd::Constant(n, -infinity);
  c.upper = Eigen::VectorXd::Constant(n, infinity);
  c.lower_slope = c.upper_slope = Eigen::VectorXd::Ones(n);
  c.group.assign(static_cast<std::size_t>(n), 0);
  c.gauge = Eigen::VectorXd::Constant(n, 1.0 / n);
  return c;
}

BoundedQpSolution solve(const SparseMatrix& Q, const BoundedQpConstraints& c, QpMethod method = QpMethod::automatic) {
  Context context;
  BoundedQp qp;
  qp.set_energy(Q, std::vector<int>(static_cast<std::size_t>(Q.rows()), 0), {}, context);
  BoundedQpOptions options;
  options.method = method;
  return qp.solve(c, options, context);
}

TEST(BoundedQp, WithoutContactNothingMoves) {
  const int n = 30;
  BoundedQpConstraints c = free_constraints(n);
  c.lower.setConstant(-1);
  c.upper.setConstant(1);
  const BoundedQpSolution s = solve(chain(n, 1), c);
  EXPECT_LE(s.u.cwiseAbs().maxCoeff(), 1e-10);
  EXPECT_EQ(s.active_constraints, 0);
}

TEST(BoundedQp, AStringBetweenTwoPinsIsStraight) {
  // One end at least 1 over m, the other at most -1: the string in between is a straight line of slope -2 / (n - 1).
  const int n = 41;
  BoundedQpConstraints c = free_constraints(n);
  c.lower[0] = 1;
  c.upper[n - 1] = -1;
  for (const double stiffness : {1.0, 1e6, 1e-6}) {
    const BoundedQpSolution s = solve(chain(n, stiffness), c);
    for (int i = 0; i < n; ++i) EXPECT_NEAR(s.u[i] - s.m[0], 1 - 2.0 * i / (n - 1), 1e-9) << i;
    EXPECT_NEAR(s.u.mean(), 0, 1e-10);
    EXPECT_NEAR(s.objective, 0.5 * stiffness * 4.0 / (n - 1), 1e-9 * stiffness);
    EXPECT_EQ(s.active_constraints, 2);
    EXPECT_LE(s.kkt_residual, 1e-9);
  }
}

TEST(BoundedQp, AnOrderRowActsLikeABound) {
  const int n = 11;
  BoundedQpConstraints c = free_constraints(n);
  c.lower.setConstant(-100);
  c.upper.setConstant(100);
  c.rows.push_back({{0, n - 1}, {1, -1}, 0, 0, 2});  // u_0 - u_10 >= 2
  const BoundedQpSolution s = solve(chain(n, 1), c);
  for (int i = 0; i < n; ++i) EXPECT_NEAR(s.u[i], 1 - 0.2 * i, 1e-9);
}

TEST(BoundedQp, CrossedBoundsAreSaid) {
  const int n = 5;
  BoundedQpConstraints c = free_constraints(n);
  c.lower.setConstant(0.5);
  c.upper.setConstant(-0.5);
  EXPECT_THROW(solve(chain(n, 1), c), Error);
}

}  // namespace
}  // namespace formwright
