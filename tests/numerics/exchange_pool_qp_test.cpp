// SPDX-License-Identifier: GPL-3.0-or-later
#include "numerics/qp/exchange/exchange_pool_qp.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/generators/catch_generators.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/index.h"
#include "numerics/bounded_qp_reference.h"

namespace formwright::bounded_qp_detail {
namespace {

/// A clamped beam in a winding corridor: rows are places along it, by turns above the floor and below the ceiling, and
/// S is its response to point forces. Rows beside each other are nearly parallel, and block pivoting loses its way.
double response(double x, double force_at) {
  const double a = std::min(x, force_at), b = std::max(x, force_at);
  return a * a * (3 * b - a) / 6;
}

struct Beam {
  Eigen::MatrixXd gram;
  Eigen::VectorXd limit;  // of sign times place
  Eigen::VectorXd sign;
};

Beam beam(int rows, std::uint64_t seed) {
  test::Random random(seed);
  std::vector<double> place(static_cast<std::size_t>(rows));
  for (double& x : place) x = random.between(0.02, 1);
  Beam result{Eigen::MatrixXd(rows, rows), Eigen::VectorXd(rows), Eigen::VectorXd(rows)};
  for (int a = 0; a < rows; ++a) {
    for (int b = 0; b < rows; ++b) result.gram(a, b) = response(place[index(a)], place[index(b)]);
    const double x = place[index(a)], half_width = 2e-4,
                 middle = 0.02 * std::sin(9 * x) + 0.004 * std::sin(47 * x + 1) + 0.001 * std::sin(211 * x + 2);
    result.sign[a] = a % 2 == 0 ? 1 : -1;
    result.limit[a] = result.sign[a] * middle - half_width;
  }
  return result;
}

PoolProblem in_corridor(const Beam& beam, int rows) {
  PoolProblem p;
  p.B.resize(rows, 0);
  p.d = beam.limit.head(rows);
  for (int a = 0; a < rows; ++a) {
    p.column.push_back(a);
    p.sign.push_back(beam.sign[a]);
  }
  p.equality.assign(index(rows), 0);
  p.P.resize(0, 0);
  p.r.resize(0);
  return p;
}

TEST_CASE("PoolQp.SolvesNearlyParallelRowsAsTheyComeIn") {
  const int rows = 600;
  const auto seed = GENERATE(std::uint64_t{1}, std::uint64_t{2}, std::uint64_t{3});
  const Beam all = beam(rows, seed);
  const double tolerance = 1e-11;
  PoolQp qp;
  Context context;
  std::vector<char> active;
  int pivots = 0;
  for (int known = 100; known <= rows; known += 100) {
    qp.set_problem(all.gram, in_corridor(all, known), known > 100);
    active.resize(index(known), 1);
    const PoolSolution solution = qp.solve(active, Eigen::VectorXd(), tolerance, 1e15, context);
    REQUIRE_FALSE(solution.stopped);
    active = solution.active;
    pivots = solution.pivots;
    // s = S y - d >= 0, y >= 0, s y = 0.
    const Eigen::VectorXd sign = all.sign.head(known);
    const Eigen::VectorXd slack =
        sign.cwiseProduct(all.gram.topLeftCorner(known, known) * sign.cwiseProduct(solution.y)) - all.limit.head(known);
    CHECK(slack.minCoeff() > -100 * tolerance);
    CHECK(solution.y.minCoeff() >= 0);
    double complementarity = 0;
    for (int a = 0; a < known; ++a)
      if (solution.y[a] > 0) complementarity = std::max(complementarity, std::abs(slack[a]));
    CHECK(complementarity < 100 * tolerance);
  }
  INFO("linear systems: " << pivots);
  CHECK(pivots < rows);
}

TEST_CASE("PoolQp.GivesTheSameInOneStep") {
  const Beam all = beam(250, 5);
  Context context;
  PoolQp once, grown;
  once.set_problem(all.gram, in_corridor(all, 250), false);
  const PoolSolution a = once.solve(std::vector<char>(250, 1), Eigen::VectorXd(), 1e-12, 1e15, context);
  PoolSolution b;
  std::vector<char> active;
  for (const int known : {40, 130, 250}) {
    grown.set_problem(all.gram, in_corridor(all, known), known > 40);
    active.resize(index(known), 1);
    b = grown.solve(active, Eigen::VectorXd(), 1e-12, 1e15, context);
    active = b.active;
  }
  // Forces of nearly parallel rows may be shared in many ways; what they do to the beam is one.
  CHECK((all.gram * all.sign.head(250).cwiseProduct(a.y - b.y)).cwiseAbs().maxCoeff() < 1e-9);
}

TEST_CASE("PoolQp.StopsWhenItsWorkIsSpent") {
  const Beam all = beam(400, 9);
  Context context;
  PoolQp qp;
  qp.set_problem(all.gram, in_corridor(all, 400), false);
  const double little = 1e5;
  const PoolSolution solution = qp.solve(std::vector<char>(400, 1), Eigen::VectorXd(), 1e-12, little, context);
  CHECK(solution.stopped);
  CHECK(solution.y.allFinite());
}

}  // namespace
}  // namespace formwright::bounded_qp_detail
