// SPDX-License-Identifier: GPL-3.0-or-later
// Exact answers and invariants.
#include "numerics/qp/bounded_qp.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include "base/error.h"
#include "numerics/bounded_qp_problems.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

using namespace test;

TEST_CASE("BoundedQp.SpringFillsTheSlab") {
  QpProblem p{lower_of(graph_laplacian(2, path(2))), {0, 0}, slab(Eigen::Vector2d(0, 10), 2)};
  const auto s = solve(p);
  CHECK_THAT(s.u[0], WithinAbs(4, 1e-13));
  CHECK_THAT(s.u[1], WithinAbs(-4, 1e-13));
  CHECK_THAT(s.m[0], WithinAbs(6, 1e-13));
  CHECK_THAT(s.objective, WithinAbs(32, 1e-12));
  CHECK(s.active_constraints == 2);
}

TEST_CASE("BoundedQp.StringOverObstaclesIsTheirConcaveHull") {
  // A string held at 0 at both ends above obstacles: its least energy is the upper hull of ends and obstacles.
  for (const QpMethod method : {QpMethod::exchange, QpMethod::interior_point}) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      CAPTURE(seed);
      Random random(seed);
      const int n = 60;
      QpProblem p{lower_of(graph_laplacian(n, path(n))), std::vector<int>(n, 0), unbounded(n)};
      Eigen::VectorXd obstacle(n);
      for (int i = 0; i < n; ++i)
        obstacle[i] = 8 - 0.009 * (i - 20.0) * (i - 20.0) + random.unit() - 4 * random.unit() * (i % 3);
      obstacle[0] = obstacle[n - 1] = 0;
      p.constraints.lower = obstacle;
      p.constraints.upper[0] = p.constraints.upper[n - 1] = 0;
      std::vector<int> hull;
      for (int i = 0; i < n; ++i) {
        while (hull.size() > 1) {
          const int a = hull[hull.size() - 2], b = hull.back();
          if ((obstacle[b] - obstacle[a]) * (i - a) > (obstacle[i] - obstacle[a]) * (b - a)) break;
          hull.pop_back();
        }
        hull.push_back(i);
      }
      const auto s = solve(p, method);
      for (std::size_t k = 1; k < hull.size(); ++k) {
        const int a = hull[k - 1], b = hull[k];
        for (int i = a; i <= b; ++i)
          CHECK_THAT(s.u[i], WithinAbs(obstacle[a] + (obstacle[b] - obstacle[a]) * (i - a) / (b - a), 1e-11));
      }
    }
  }
}

TEST_CASE("BoundedQp.ClampedBeamOnAPointSupportIsCubic") {
  // Fourth differences vanish off the support at k: u_i = i (i - 1) (a + b i) up to it, symmetric; the two cubics may
  // differ by a multiple of x (x^2 - 1), x = i - k, which leaves all but one fourth difference at zero.
  const int k = 12, n = 2 * k + 1;
  const double h = 3, ratio = -(3.0 * k * k - 2 * k + 1) / (2.0 * k - 1), b = h / (k * (k - 1.0) * (ratio + k));
  const SparseMatrix L = graph_laplacian(n, path(n));
  QpProblem p{lower_of(L * L), std::vector<int>(n, 0), unbounded(n)};
  for (const int i : {0, 1, n - 2, n - 1}) p.constraints.lower[i] = p.constraints.upper[i] = 0;
  p.constraints.lower[k] = h;
  const auto s = solve(p);
  for (int i = 0; i <= k; ++i) {
    const double u = i * (i - 1.0) * b * (ratio + i);
    CHECK_THAT(s.u[i], WithinAbs(u, 1e-11));
    CHECK_THAT(s.u[n - 1 - i], WithinAbs(u, 1e-11));
  }
}

TEST_CASE("BoundedQp.InactiveBoundsLeaveEverythingAtRest") {
  QpProblem p = bumpy_relief(20, 15, 1);
  const double depth = -p.constraints.upper.minCoeff() + p.constraints.upper.maxCoeff();
  p = bumpy_relief(20, 15, 1.01 * depth);
  for (const QpMethod method : {QpMethod::exchange, QpMethod::interior_point}) {
    const auto s = solve(p, method);
    CHECK(s.u.cwiseAbs().maxCoeff() < 1e-10);
    CHECK(s.objective < 1e-18);
    CHECK(s.violation_max <= 1e-9);
  }
}

TEST_CASE("BoundedQp.EveryBoundHoldsExactly") {
  for (const double thickness : {3.0, 0.3, 0.03}) {
    const QpProblem p = bumpy_relief(30, 20, thickness);
    const auto s = solve(p);
    const auto& c = p.constraints;
    for (int i = 0; i < s.u.size(); ++i) {
      CHECK(c.lower[i] + s.m[0] <= s.u[i]);
      CHECK(s.u[i] <= c.upper[i] + s.m[0]);
    }
    CHECK(s.violation_max == 0);
    CHECK(s.kkt_residual < 1e-8);
  }
}

TEST_CASE("BoundedQp.InteriorPointEqualsExchange") {
  for (const double thickness : {2.0, 0.2, 0.02}) {
    const QpProblem p = bumpy_relief(40, 30, thickness, 7);
    const auto a = solve(p, QpMethod::exchange), b = solve(p, QpMethod::interior_point);
    CHECK(a.method_used == QpMethod::exchange);
    CHECK(b.method_used == QpMethod::interior_point);
    CHECK(b.interior_point_iterations > 3);
    CHECK_THAT(a.objective, WithinAbs(b.objective, 1e-10 * a.objective));
    CHECK((a.u - b.u).cwiseAbs().maxCoeff() < 1e-8);
    CHECK(a.active_constraints == b.active_constraints);
  }
}

TEST_CASE("BoundedQp.HandingOverToTheInteriorPointChangesNothing") {
  QpProblem p = bumpy_relief(25, 20, 0.2);
  for (const bool with_order_rows : {false, true}) {
    if (with_order_rows) {  // neighbours held half-way to where the middle of the slab, which is feasible, has them
      const auto flat = solve(p, QpMethod::exchange);
      for (int i = 0; i + 1 < 500; i += 7) {
        const double now = flat.u[i] - flat.u[i + 1], middle = p.constraints.upper[i] - p.constraints.upper[i + 1];
        if (now < middle) p.constraints.rows.push_back({{i, i + 1}, {1.0, -1.0}, 0, 0, 0.5 * (now + middle)});
      }
      REQUIRE(p.constraints.rows.size() > 10u);
    }
    const auto pool = solve(p, QpMethod::exchange);
    Context context;
    BoundedQp qp;
    qp.set_energy(p.lower_Q, p.component, {}, context);
    BoundedQpOptions options;
    for (const double work : {1.0, 1e5, 1e7}) {
      options.max_exchange_work = work;
      const auto handed = qp.solve(p.constraints, options, context);
      CHECK((handed.u - pool.u).cwiseAbs().maxCoeff() < 1e-8);
      CHECK_THAT(handed.objective, WithinAbs(pool.objective, 1e-10 * pool.objective));
      CHECK(handed.kkt_residual < 1e-9);
      CHECK(handed.relative_gap == 0);
      if (work == 1) CHECK(handed.method_used == QpMethod::interior_point);
    }
  }
}

TEST_CASE("BoundedQp.ScalingTheEnergyChangesNothing") {
  QpProblem p = bumpy_relief(25, 20, 0.5);
  const auto a = solve(p);
  p.lower_Q *= 1e6;
  const auto b = solve(p);
  p.lower_Q *= 1e-14;
  const auto c = solve(p);
  CHECK((a.u - b.u).cwiseAbs().maxCoeff() < 1e-9);
  CHECK((a.u - c.u).cwiseAbs().maxCoeff() < 1e-9);
  CHECK_THAT(b.objective, WithinAbs(1e6 * a.objective, 1e-3 * a.objective));
}

TEST_CASE("BoundedQp.ScalingTheLengthsScalesTheResult") {
  QpProblem p = bumpy_relief(25, 20, 0.5);
  const auto a = solve(p);
  p.constraints.lower *= 1000;
  p.constraints.upper *= 1000;
  const auto b = solve(p);
  CHECK((1000 * a.u - b.u).cwiseAbs().maxCoeff() < 1e-6);
}

TEST_CASE("BoundedQp.NumberingDoesNotMatter") {
  const int width = 22, height = 17, n = width * height;
  const QpProblem p = bumpy_relief(width, height, 0.4);
  const auto a = solve(p);
  Random random(5);
  std::vector<int> to(n);
  for (int i = 0; i < n; ++i) to[static_cast<std::size_t>(i)] = i;
  for (int i = n - 1; i > 0; --i)
    std::swap(to[static_cast<std::size_t>(i)], to[static_cast<std::size_t>(random.below(i + 1))]);
  std::vector<std::pair<int, int>> edges = grid(width, height);
  for (auto& [x, y] : edges) {
    x = to[static_cast<std::size_t>(x)];
    y = to[static_cast<std::size_t>(y)];
  }
  const SparseMatrix L = graph_laplacian(n, edges);
  QpProblem q{lower_of(L * L), p.component, p.constraints};
  for (int i = 0; i < n; ++i) {
    q.constraints.lower[to[static_cast<std::size_t>(i)]] = p.constraints.lower[i];
    q.constraints.upper[to[static_cast<std::size_t>(i)]] = p.constraints.upper[i];
  }
  const auto b = solve(q);
  for (int i = 0; i < n; ++i) CHECK_THAT(a.u[i], WithinAbs(b.u[to[static_cast<std::size_t>(i)]], 1e-9));
}

TEST_CASE("BoundedQp.TranslationOfTheSlabMovesOnlyM") {
  QpProblem p = bumpy_relief(20, 20, 0.5);
  const auto a = solve(p);
  p.constraints.lower.array() += 7;
  p.constraints.upper.array() += 7;
  const auto b = solve(p);
  CHECK((a.u - b.u).cwiseAbs().maxCoeff() < 1e-9);
  CHECK_THAT(b.m[0], WithinAbs(a.m[0] - 7, 1e-9));
}

TEST_CASE("BoundedQp.MirroredBoundsGiveTheMirroredResult") {
  QpProblem p = bumpy_relief(20, 20, 0.5);
  const auto a = solve(p);
  std::swap(p.constraints.lower, p.constraints.upper);
  p.constraints.lower *= -1;
  p.constraints.upper *= -1;
  const auto b = solve(p);
  CHECK((a.u + b.u).cwiseAbs().maxCoeff() < 1e-9);
}

TEST_CASE("BoundedQp.WarmStartEqualsColdStart") {
  const QpProblem p = bumpy_relief(40, 30, 1);
  Context context;
  BoundedQp warm;
  warm.set_energy(p.lower_Q, p.component, {}, context);
  for (const double thickness : {1.0, 0.9, 0.5, 0.1, 0.11, 3.0, 1.0}) {
    const QpProblem now = bumpy_relief(40, 30, thickness);
    const auto a = warm.solve(now.constraints, {}, context), b = solve(now);
    INFO(thickness);
    CHECK((a.u - b.u).cwiseAbs().maxCoeff() < 1e-9);
    CHECK_THAT(a.m[0], WithinAbs(b.m[0], 1e-9));
  }
  // The same again costs no round.
  const auto again = warm.solve(bumpy_relief(40, 30, 1.0).constraints, {}, context);
  CHECK(again.rounds == 0);
}

TEST_CASE("BoundedQp.ExchangeAfterInteriorPointFindsItsFactorAgain") {
  const QpProblem p = bumpy_relief(25, 20, 0.2);
  Context context;
  BoundedQp qp;
  qp.set_energy(p.lower_Q, p.component, {}, context);
  BoundedQpOptions options;
  const auto a = qp.solve(p.constraints, options, context);
  options.method = QpMethod::interior_point;
  const auto b = qp.solve(p.constraints, options, context);
  options.method = QpMethod::exchange;
  const auto c = qp.solve(p.constraints, options, context);
  CHECK((a.u - b.u).cwiseAbs().maxCoeff() < 1e-8);
  CHECK((a.u - c.u).cwiseAbs().maxCoeff() < 1e-9);
}

TEST_CASE("BoundedQp.GroupsOfSeparatePartsDoNotMix") {
  const QpProblem p = bumpy_relief(15, 12, 0.5, 1), q = bumpy_relief(12, 12, 0.3, 2);
  const int n = 180, k = 144;
  std::vector<std::pair<int, int>> edges = grid(15, 12);
  for (auto [a, b] : grid(12, 12)) edges.emplace_back(a + n, b + n);
  const SparseMatrix L = graph_laplacian(n + k, edges);
  QpProblem both{lower_of(L * L), std::vector<int>(n + k, 0), unbounded(n + k)};
  auto& c = both.constraints;
  c.lower << p.constraints.lower, q.constraints.lower;
  c.upper << p.constraints.upper, q.constraints.upper;
  c.lower_slope.setOnes();
  c.upper_slope.setOnes();
  c.gauge.setOnes();
  c.group_count = 2;
  for (int i = n; i < n + k; ++i)
    both.component[static_cast<std::size_t>(i)] = c.group[static_cast<std::size_t>(i)] = 1;
  const auto a = solve(p), b = solve(q), s = solve(both);
  // One gauge for both leaves one move free: both parts against each other, each with its own m.
  const double shift_a = (s.u.head(n) - a.u).mean(), shift_b = (s.u.tail(k) - b.u).mean();
  CHECK(((s.u.head(n) - a.u).array() - shift_a).abs().maxCoeff() < 1e-8);
  CHECK(((s.u.tail(k) - b.u).array() - shift_b).abs().maxCoeff() < 1e-8);
  CHECK_THAT(s.m[0] - a.m[0], WithinAbs(shift_a, 1e-8));
  CHECK_THAT(s.m[1] - b.m[0], WithinAbs(shift_b, 1e-8));
  CHECK_THAT(n * shift_a + k * shift_b, WithinAbs(0, 1e-8));
  // Of those it is the smallest: |u|^2 + |m|^2 does not change along the move (k, -n).
  CHECK_THAT(k * (s.u.head(n).sum() + s.m[0]) - n * (s.u.tail(k).sum() + s.m[1]), WithinAbs(0, 1e-6));
  CHECK_THAT(s.objective, WithinAbs(a.objective + b.objective, 1e-9 * s.objective));
}

TEST_CASE("BoundedQp.PartsSharingASlabFitTogether") {
  // Two springs far apart in depth, one slab: each is squashed to fit, neither twists the other.
  const SparseMatrix Q = graph_laplacian(4, {{0, 1}, {2, 3}});
  QpProblem p{lower_of(Q), {0, 0, 1, 1}, slab(Eigen::Vector4d(0, 3, -100, -99), 2)};
  const auto s = solve(p);
  const Eigen::Vector4d z(0, 3, -100, -99), moved = z + s.u;
  CHECK_THAT(moved[1] - moved[0], WithinAbs(2, 1e-12));  // squashed from 3 to 2
  CHECK_THAT(moved[3] - moved[2], WithinAbs(1, 1e-12));  // fits
  CHECK_THAT(s.u[2] - s.u[3], WithinAbs(0, 1e-12));
  CHECK(moved.maxCoeff() - moved.minCoeff() <= 2 + 1e-12);
  CHECK_THAT(s.objective, WithinAbs(0.5, 1e-12));
  // The second moves no further than it must: up until its far end enters the slab.
  CHECK_THAT(moved[2], WithinAbs(moved[0], 1e-9));
}

TEST_CASE("BoundedQp.FreePartsStayWhereTheyAreOrAsNearAsTheyMay") {
  const SparseMatrix Q = graph_laplacian(6, {{0, 1}, {2, 3}, {4, 5}});
  QpProblem p{lower_of(Q), {0, 0, 1, 1, 2, 2}, unbounded(6)};
  p.constraints.lower[2] = 3;  // part 1 must rise to 3, and does so without a change of shape
  p.constraints.upper[4] = 5;  // part 2 need not move
  const auto s = solve(p);
  const Eigen::VectorXd expected = (Eigen::VectorXd(6) << 0, 0, 3, 3, 0, 0).finished();
  CHECK((s.u - expected).cwiseAbs().maxCoeff() < 1e-9);
  CHECK_THAT(s.m[0], WithinAbs(0, 1e-12));
}

TEST_CASE("BoundedQp.UndeterminedOffsetIsTheSmallest") {
  QpProblem p{lower_of(graph_laplacian(2, path(2))), {0, 0}, slab(Eigen::Vector2d(5, 6), 10)};
  // z in [5, 6] in a slab [m - 10, m]: any m in [6, 15] will do.
  const auto s = solve(p);
  CHECK_THAT(s.m[0], WithinAbs(6, 1e-10));
  CHECK(s.u.cwiseAbs().maxCoeff() < 1e-12);
}

TEST_CASE("BoundedQp.OrderRowsPush") {
  // Two strings, one above the other, fixed at their ends at 0 and 1; the lower one is lifted to 3 in its middle.
  const int n = 11;
  std::vector<std::pair<int, int>> edges = path(n);
  for (auto e : path(n, n)) edges.push_back(e);
  QpProblem p{lower_of(graph_laplacian(2 * n, edges)), std::vector<int>(2 * n, 0), unbounded(2 * n)};
  for (int i = n; i < 2 * n; ++i) p.component[static_cast<std::size_t>(i)] = 1;
  auto& c = p.constraints;
  for (const int i : {0, n - 1}) c.lower[i] = c.upper[i] = 0;
  for (const int i : {n, 2 * n - 1}) c.lower[i] = c.upper[i] = 1;
  c.lower[n / 2] = 3;
  for (int i = 0; i < n; ++i) c.rows.push_back({{i + n, i}, {1, -1}, 0, 0, 0.5});
  for (const QpMethod method : {QpMethod::exchange, QpMethod::interior_point}) {
    const auto s = solve(p, method);
    for (int i = 0; i < n; ++i) {
      const double part = 1 - std::abs(i - 5) / 5.0;
      CHECK_THAT(s.u[i], WithinAbs(3 * part, 1e-11));
      CHECK_THAT(s.u[i + n], WithinAbs(1 + 2.5 * part, 1e-11));
    }
  }
}

TEST_CASE("BoundedQp.RepeatedAndRedundantRowsDoNoHarm") {
  QpProblem p = bumpy_relief(15, 12, 0.5);
  const auto a = solve(p);
  for (int copy = 0; copy < 3; ++copy) {
    for (int i = 0; i < 180; ++i)
      p.constraints.rows.push_back({{i}, {1.0}, -1.0, 0, p.constraints.lower[i]});  // the lower bounds again
  }
  const auto b = solve(p);
  CHECK((a.u - b.u).cwiseAbs().maxCoeff() < 1e-8);
}

}  // namespace
}  // namespace formwright
