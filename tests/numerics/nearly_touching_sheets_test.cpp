// SPDX-License-Identifier: GPL-3.0-or-later
// Two sheets that nearly touch: order rows that nearly depend on each other, against exact answers.
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include "numerics/bounded_qp_problems.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

using test::infinity;
using test::QpProblem;
using test::solve;

/// The bi-Laplacian of a path with n unknowns, `copies` of them side by side.
SparseMatrix beams(int n, int copies) {
  Eigen::MatrixXd Q = Eigen::MatrixXd::Zero(n * copies, n * copies);
  for (int c = 0; c < copies; ++c) {
    Eigen::MatrixXd L = Eigen::MatrixXd::Zero(n, n);
    for (int i = 0; i + 1 < n; ++i) {
      L(i, i) += 1;
      L(i + 1, i + 1) += 1;
      L(i, i + 1) -= 1;
      L(i + 1, i) -= 1;
    }
    Q.block(c * n, c * n, n, n) = L * L;
  }
  return test::lower_triangle(Q);
}

/// `copies` beams of n unknowns, clamped at both ends, each `gap` above the one before; the lowest is lifted by 1 in
/// the middle. Between beams, a row for every unknown and one for a point of the lower beam just beside it.
QpProblem stacked_beams(int n, int copies, double gap) {
  QpProblem p{beams(n, copies), {}, {}};
  BoundedQpConstraints& c = p.constraints;
  const int all = n * copies;
  c.lower = Eigen::VectorXd::Constant(all, -infinity);
  c.upper = Eigen::VectorXd::Constant(all, infinity);
  c.lower_slope = c.upper_slope = c.gauge = Eigen::VectorXd::Zero(all);
  c.group.assign(static_cast<std::size_t>(all), 0);
  for (int i = 0; i < all; ++i) p.component.push_back(i / n);
  for (int k = 0; k < copies; ++k) {
    for (const int i : {0, 1, n - 2, n - 1}) c.lower[k * n + i] = c.upper[k * n + i] = 0;
  }
  c.lower[n / 2] = 1;
  for (int k = 1; k < copies; ++k) {
    const int below = (k - 1) * n, above = k * n;
    for (int i = 0; i < n; ++i) {
      c.rows.push_back({{above + i, below + i}, {1, -1}, 0, 0, -gap});
      if (i + 1 < n)
        c.rows.push_back({{above + i, below + i, below + i + 1}, {1, -1 + 1e-9, -1e-9}, 0, 0, -gap - 1e-9});
    }
  }
  return p;
}

TEST_CASE("NearlyTouchingSheets.EveryBeamTakesTheShapeOfTheLowest") {
  // Beam k alone, lifted by 1 - k gap, is the lowest beam's cubic times that; it keeps its distance elsewhere, so that
  // it is the optimum with all rows. However small the gap is.
  const int half = 12, n = 2 * half + 1, copies = 5;
  const double ratio = -(3.0 * half * half - 2 * half + 1) / (2.0 * half - 1),
               b = 1 / (half * (half - 1.0) * (ratio + half));
  for (const double gap : {0.1, 1e-4, 1e-8, 1e-12}) {
    const QpProblem p = stacked_beams(n, copies, gap);
    for (const QpMethod method : {QpMethod::automatic, QpMethod::interior_point}) {
      INFO("gap " << gap << ", method " << static_cast<int>(method));
      const auto s = solve(p, method);
      for (int k = 0; k < copies; ++k) {
        for (int i = 0; i <= half; ++i) {
          const double u = i * (i - 1.0) * b * (ratio + i) * (1 - k * gap);
          CHECK_THAT(s.u[k * n + i], WithinAbs(u, 1e-9));
          CHECK_THAT(s.u[k * n + n - 1 - i], WithinAbs(u, 1e-9));
        }
      }
      CHECK(s.kkt_residual < 1e-9);
      CHECK(s.violation_max <= 1e-9);
    }
  }
}

TEST_CASE("NearlyTouchingSheets.RowsRepeatedManyTimesChangeNothing") {
  QpProblem p = stacked_beams(25, 2, 1e-7);
  const auto once = solve(p, QpMethod::interior_point);
  const std::vector<InequalityRow> rows = p.constraints.rows;
  for (int copy = 1; copy <= 20; ++copy) {
    for (InequalityRow row : rows) {
      row.coefficient[0] += 1e-11 * copy;
      p.constraints.rows.push_back(row);
    }
  }
  for (const QpMethod method : {QpMethod::automatic, QpMethod::interior_point}) {
    const auto s = solve(p, method);
    CHECK((s.u - once.u).cwiseAbs().maxCoeff() < 1e-8);
    CHECK_THAT(s.objective, WithinAbs(once.objective, 1e-9 * once.objective));
  }
}

}  // namespace
}  // namespace formwright
