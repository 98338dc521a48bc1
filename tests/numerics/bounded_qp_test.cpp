// SPDX-License-Identifier: GPL-3.0-or-later
// Exact answers, invariants and bad input.
#include "numerics/qp/bounded_qp.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <chrono>

#include "base/error.h"
#include "numerics/bounded_qp_reference.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

using test::infinity;
using test::Random;

SparseMatrix graph_laplacian(int n, const std::vector<std::pair<int, int>>& edges) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < n; ++i) entries.emplace_back(i, i, 0.0);
  for (const auto& [a, b] : edges) {
    entries.emplace_back(a, a, 1);
    entries.emplace_back(b, b, 1);
    entries.emplace_back(a, b, -1);
    entries.emplace_back(b, a, -1);
  }
  SparseMatrix L(n, n);
  L.setFromTriplets(entries.begin(), entries.end());
  return L;
}

std::vector<std::pair<int, int>> path(int n, int first = 0) {
  std::vector<std::pair<int, int>> edges;
  for (int i = 1; i < n; ++i) edges.emplace_back(first + i - 1, first + i);
  return edges;
}

std::vector<std::pair<int, int>> grid(int width, int height) {
  std::vector<std::pair<int, int>> edges;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (x > 0) edges.emplace_back(y * width + x - 1, y * width + x);
      if (y > 0) edges.emplace_back((y - 1) * width + x, y * width + x);
    }
  }
  return edges;
}

SparseMatrix lower_of(const SparseMatrix& Q) {
  SparseMatrix lower = Q.triangularView<Eigen::Lower>();
  return lower;
}

BoundedQpConstraints unbounded(int n) {
  BoundedQpConstraints c;
  c.lower = Eigen::VectorXd::Constant(n, -infinity);
  c.upper = Eigen::VectorXd::Constant(n, infinity);
  c.lower_slope = c.upper_slope = Eigen::VectorXd::Zero(n);
  c.group.assign(static_cast<std::size_t>(n), 0);
  c.gauge = Eigen::VectorXd::Zero(n);
  return c;
}

/// u - m in [-z - thickness, -z], gauge: mean zero.
BoundedQpConstraints slab(const Eigen::VectorXd& z, double thickness) {
  BoundedQpConstraints c = unbounded(static_cast<int>(z.size()));
  c.upper = -z;
  c.lower = c.upper.array() - thickness;
  c.lower_slope = c.upper_slope = Eigen::VectorXd::Ones(z.size());
  c.gauge = Eigen::VectorXd::Constant(z.size(), 1.0 / static_cast<double>(z.size()));
  return c;
}

struct Problem {
  SparseMatrix lower_Q;
  std::vector<int> component;
  BoundedQpConstraints constraints;
};

BoundedQpSolution solve(const Problem& p, QpMethod method = QpMethod::automatic) {
  Context context;
  BoundedQp qp;
  qp.set_energy(p.lower_Q, p.component, {}, context);
  BoundedQpOptions options;
  options.method = method;
  return qp.solve(p.constraints, options, context);
}

Eigen::VectorXd bumps(int width, int height, std::uint64_t seed, double size) {
  Random random(seed);
  Eigen::VectorXd z = Eigen::VectorXd::Zero(width * height);
  for (int k = 0; k < 12; ++k) {
    const double cx = random.unit() * width, cy = random.unit() * height, r = random.between(0.05, 0.3) * width,
                 h = random.between(-1, 1) * size;
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x)
        z[y * width + x] += h * std::exp(-((x - cx) * (x - cx) + (y - cy) * (y - cy)) / (r * r));
    }
  }
  return z;
}

Problem relief(int width, int height, double thickness, std::uint64_t seed = 1) {
  const SparseMatrix L = graph_laplacian(width * height, grid(width, height));
  return {lower_of(L * L), std::vector<int>(static_cast<std::size_t>(width * height), 0),
          slab(bumps(width, height, seed, 10), thickness)};
}

TEST_CASE("BoundedQp.SpringFillsTheSlab") {
  Problem p{lower_of(graph_laplacian(2, path(2))), {0, 0}, slab(Eigen::Vector2d(0, 10), 2)};
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
      Problem p{lower_of(graph_laplacian(n, path(n))), std::vector<int>(n, 0), unbounded(n)};
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
  Problem p{lower_of(L * L), std::vector<int>(n, 0), unbounded(n)};
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
  Problem p = relief(20, 15, 1);
  const double depth = -p.constraints.upper.minCoeff() + p.constraints.upper.maxCoeff();
  p = relief(20, 15, 1.01 * depth);
  for (const QpMethod method : {QpMethod::exchange, QpMethod::interior_point}) {
    const auto s = solve(p, method);
    CHECK(s.u.cwiseAbs().maxCoeff() < 1e-10);
    CHECK(s.objective < 1e-18);
    CHECK(s.violation_max <= 1e-9);
  }
}

TEST_CASE("BoundedQp.EveryBoundHoldsExactly") {
  for (const double thickness : {3.0, 0.3, 0.03}) {
    const Problem p = relief(30, 20, thickness);
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
    const Problem p = relief(40, 30, thickness, 7);
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
  Problem p = relief(25, 20, 0.2);
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
  Problem p = relief(25, 20, 0.5);
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
  Problem p = relief(25, 20, 0.5);
  const auto a = solve(p);
  p.constraints.lower *= 1000;
  p.constraints.upper *= 1000;
  const auto b = solve(p);
  CHECK((1000 * a.u - b.u).cwiseAbs().maxCoeff() < 1e-6);
}

TEST_CASE("BoundedQp.NumberingDoesNotMatter") {
  const int width = 22, height = 17, n = width * height;
  const Problem p = relief(width, height, 0.4);
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
  Problem q{lower_of(L * L), p.component, p.constraints};
  for (int i = 0; i < n; ++i) {
    q.constraints.lower[to[static_cast<std::size_t>(i)]] = p.constraints.lower[i];
    q.constraints.upper[to[static_cast<std::size_t>(i)]] = p.constraints.upper[i];
  }
  const auto b = solve(q);
  for (int i = 0; i < n; ++i) CHECK_THAT(a.u[i], WithinAbs(b.u[to[static_cast<std::size_t>(i)]], 1e-9));
}

TEST_CASE("BoundedQp.TranslationOfTheSlabMovesOnlyM") {
  Problem p = relief(20, 20, 0.5);
  const auto a = solve(p);
  p.constraints.lower.array() += 7;
  p.constraints.upper.array() += 7;
  const auto b = solve(p);
  CHECK((a.u - b.u).cwiseAbs().maxCoeff() < 1e-9);
  CHECK_THAT(b.m[0], WithinAbs(a.m[0] - 7, 1e-9));
}

TEST_CASE("BoundedQp.MirroredBoundsGiveTheMirroredResult") {
  Problem p = relief(20, 20, 0.5);
  const auto a = solve(p);
  std::swap(p.constraints.lower, p.constraints.upper);
  p.constraints.lower *= -1;
  p.constraints.upper *= -1;
  const auto b = solve(p);
  CHECK((a.u + b.u).cwiseAbs().maxCoeff() < 1e-9);
}

TEST_CASE("BoundedQp.WarmStartEqualsColdStart") {
  const Problem p = relief(40, 30, 1);
  Context context;
  BoundedQp warm;
  warm.set_energy(p.lower_Q, p.component, {}, context);
  for (const double thickness : {1.0, 0.9, 0.5, 0.1, 0.11, 3.0, 1.0}) {
    const Problem now = relief(40, 30, thickness);
    const auto a = warm.solve(now.constraints, {}, context), b = solve(now);
    INFO(thickness);
    CHECK((a.u - b.u).cwiseAbs().maxCoeff() < 1e-9);
    CHECK_THAT(a.m[0], WithinAbs(b.m[0], 1e-9));
  }
  // The same again costs no round.
  const auto again = warm.solve(relief(40, 30, 1.0).constraints, {}, context);
  CHECK(again.rounds == 0);
}

TEST_CASE("BoundedQp.ExchangeAfterInteriorPointFindsItsFactorAgain") {
  const Problem p = relief(25, 20, 0.2);
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
  const Problem p = relief(15, 12, 0.5, 1), q = relief(12, 12, 0.3, 2);
  const int n = 180, k = 144;
  std::vector<std::pair<int, int>> edges = grid(15, 12);
  for (auto [a, b] : grid(12, 12)) edges.emplace_back(a + n, b + n);
  const SparseMatrix L = graph_laplacian(n + k, edges);
  Problem both{lower_of(L * L), std::vector<int>(n + k, 0), unbounded(n + k)};
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
  Problem p{lower_of(Q), {0, 0, 1, 1}, slab(Eigen::Vector4d(0, 3, -100, -99), 2)};
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
  Problem p{lower_of(Q), {0, 0, 1, 1, 2, 2}, unbounded(6)};
  p.constraints.lower[2] = 3;  // part 1 must rise to 3, and does so without a change of shape
  p.constraints.upper[4] = 5;  // part 2 need not move
  const auto s = solve(p);
  const Eigen::VectorXd expected = (Eigen::VectorXd(6) << 0, 0, 3, 3, 0, 0).finished();
  CHECK((s.u - expected).cwiseAbs().maxCoeff() < 1e-9);
  CHECK_THAT(s.m[0], WithinAbs(0, 1e-12));
}

TEST_CASE("BoundedQp.UndeterminedOffsetIsTheSmallest") {
  Problem p{lower_of(graph_laplacian(2, path(2))), {0, 0}, slab(Eigen::Vector2d(5, 6), 10)};
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
  Problem p{lower_of(graph_laplacian(2 * n, edges)), std::vector<int>(2 * n, 0), unbounded(2 * n)};
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
  Problem p = relief(15, 12, 0.5);
  const auto a = solve(p);
  for (int copy = 0; copy < 3; ++copy) {
    for (int i = 0; i < 180; ++i)
      p.constraints.rows.push_back({{i}, {1.0}, -1.0, 0, p.constraints.lower[i]});  // the lower bounds again
  }
  const auto b = solve(p);
  CHECK((a.u - b.u).cwiseAbs().maxCoeff() < 1e-8);
}

template <class Action>
ErrorCode code_of(Action action, std::string* message = nullptr) {
  try {
    action();
  } catch (const Error& error) {
    if (message) *message = error.what();
    return error.code();
  }
  FAIL_CHECK("no error");
  return ErrorCode::internal;
}

TEST_CASE("BoundedQp.CrossedBoundsAreCounted") {
  Problem p = relief(10, 10, 0.5);
  for (const int i : {3, 4, 77}) p.constraints.lower[i] = p.constraints.upper[i] + 0.1;
  std::string message;
  CHECK(code_of([&] { solve(p); }, &message) == ErrorCode::invalid_input);
  INFO(message);
  CHECK(message.find("lower bound is above the upper bound for 3 unknowns") != std::string::npos);
}

TEST_CASE("BoundedQp.ContradictionsAreFound") {
  for (const QpMethod method : {QpMethod::exchange, QpMethod::automatic, QpMethod::interior_point}) {
    {
      Problem p = relief(10, 10, 0.5);  // u_0 - u_1 >= 50 does not fit into the slab
      p.constraints.rows.push_back({{0, 1}, {1.0, -1.0}, 0, 0, 50});
      CHECK(code_of([&] { solve(p, method); }) == ErrorCode::could_not_solve);
    }
    {
      Problem p = relief(10, 10, 0.5);  // two rows against each other, though bounds allow either
      p.constraints.rows.push_back({{0, 1}, {1.0, -1.0}, 0, 0, 0.1});
      p.constraints.rows.push_back({{1, 0}, {1.0, -1.0}, 0, 0, 0.1});
      CHECK(code_of([&] { solve(p, method); }) == ErrorCode::could_not_solve);
    }
  }
}

TEST_CASE("BoundedQp.BadInputNamesItsPlace") {
  Context context;
  const Problem good = relief(6, 5, 0.5);
  BoundedQp qp;
  CHECK(code_of([&] { qp.set_energy(good.lower_Q, std::vector<int>(7, 0), {}, context); }) == ErrorCode::invalid_input);
  SparseMatrix shifted = good.lower_Q;
  for (int i = 0; i < 30; ++i) shifted.coeffRef(i, i) += 1;  // constants no longer free
  CHECK(code_of([&] { qp.set_energy(shifted, good.component, {}, context); }) == ErrorCode::invalid_input);
  std::vector<int> torn = good.component;
  torn[3] = 1;
  CHECK(code_of([&] { qp.set_energy(good.lower_Q, torn, {}, context); }) == ErrorCode::invalid_input);

  const auto rejected = [&](auto change) {
    Problem p = good;
    change(p.constraints);
    return code_of([&] { solve(p); }) == ErrorCode::invalid_input;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(rejected([&](auto& c) { c.lower[2] = nan; }));
  CHECK(rejected([&](auto& c) { c.upper[2] = -infinity; }));
  CHECK(rejected([&](auto& c) { c.lower_slope[2] = infinity; }));
  CHECK(rejected([&](auto& c) { c.gauge[0] = nan; }));
  CHECK(rejected([&](auto& c) { c.group[1] = 1; }));
  CHECK(rejected([&](auto& c) { c.upper.conservativeResize(5); }));
  CHECK(rejected([&](auto& c) { c.rows.push_back({{30}, {1.0}, 0, 0, 0}); }));
  CHECK(rejected([&](auto& c) { c.rows.push_back({{3, 4}, {1.0}, 0, 0, 0}); }));
  CHECK(rejected([&](auto& c) { c.rows.push_back({{3}, {nan}, 0, 0, 0}); }));
}

TEST_CASE("BoundedQp.CancelStopsBothMethods") {
  // By the clock, because single-threaded WASM has no second thread.
  using Clock = std::chrono::steady_clock;
  const Problem p = relief(60, 50, 0.05);
  for (const QpMethod method : {QpMethod::exchange, QpMethod::interior_point}) {
    Context quiet;
    BoundedQp qp;
    qp.set_energy(p.lower_Q, p.component, {}, quiet);
    BoundedQpOptions options;
    options.method = method;
    for (const int milliseconds : {1, 5, 30}) {
      const Clock::time_point due = Clock::now() + std::chrono::milliseconds(milliseconds);
      Host host;
      host.cancel_requested = [&] { return Clock::now() >= due; };
      Context context(host);
      CHECK(code_of([&] {
              for (;;) qp.solve(p.constraints, options, context);
            }) == ErrorCode::cancelled);
    }
    // Still usable.
    const auto s = qp.solve(p.constraints, {}, quiet);
    CHECK(s.violation_max == 0);
  }
}

}  // namespace
}  // namespace formwright
