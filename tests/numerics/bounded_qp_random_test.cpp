// SPDX-License-Identifier: GPL-3.0-or-later
// Random problems against an independent dense solver.
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include "base/error.h"
#include "numerics/qp/bounded_qp.h"
#include "numerics/bounded_qp_reference.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

using test::infinity;
using test::RandomProblem;
using test::RandomProblemSettings;

BoundedQpSolution solve_random(const RandomProblem& p, const BoundedQpOptions& options = {}) {
  Context context;
  BoundedQp qp;
  qp.set_energy(test::lower_triangle(p.Q), p.component, {}, context);
  return qp.solve(p.constraints, options, context);
}

// Recomputed here, so that the solver's own word is not taken for it.
double violation(const BoundedQpConstraints& c, const BoundedQpSolution& s) {
  double worst = 0;
  for (Eigen::Index i = 0; i < s.u.size(); ++i) {
    const double m = s.m[c.group[static_cast<std::size_t>(i)]];
    worst = std::max({worst, c.lower[i] + c.lower_slope[i] * m - s.u[i], s.u[i] - c.upper[i] - c.upper_slope[i] * m});
  }
  for (const InequalityRow& row : c.rows) {
    double value = row.slope * s.m[row.group] - row.bound;
    for (std::size_t k = 0; k < row.index.size(); ++k) value += row.coefficient[k] * s.u[row.index[k]];
    worst = std::max(worst, -value);
  }
  return worst;
}

/// The same problem with a point to start from that is anywhere within the bounds, whatever the rows say.
RandomProblem with_start(RandomProblem p, std::uint64_t seed) {
  test::Random random(seed);
  BoundedQpConstraints& c = p.constraints;
  c.start_u = p.feasible_u;
  c.start_m = p.feasible_m;
  for (Eigen::Index i = 0; i < c.start_u.size(); ++i) {
    const double m = c.start_m[c.group[static_cast<std::size_t>(i)]];
    const double low = std::max(c.lower[i] + c.lower_slope[i] * m, c.start_u[i] - 1),
                 high = std::min(c.upper[i] + c.upper_slope[i] * m, c.start_u[i] + 1);
    c.start_u[i] = random.between(low, high);
  }
  return p;
}

struct Case {
  const char* name;
  RandomProblemSettings settings;
};

std::vector<Case> cases() {
  std::vector<Case> all;
  all.push_back({"one part", {}});
  all.push_back({"tight", {.size = 30, .tightness = 0.95}});
  all.push_back({"order rows", {.size = 24, .rows = 20}});
  all.push_back({"parts and groups", {.size = 30, .components = 3, .groups = 2}});
  all.push_back({"groups across parts", {.size = 30, .components = 2, .groups = 4, .rows = 8}});
  all.push_back({"perspective", {.size = 24, .groups = 2, .rows = 6, .perspective = true}});
  all.push_back({"perspective parts",
                 {.size = 30, .components = 3, .groups = 1, .rows = 6, .perspective = true, .tightness = 0.9}});
  all.push_back({"equal bounds", {.size = 24, .rows = 4, .equal_bounds = 0.2}});
  all.push_back({"mostly free", {.size = 24, .components = 4, .groups = 2, .rows = 3, .free_bounds = 0.8}});
  all.push_back({"nearly dependent rows", {.size = 24, .rows = 12, .near_copies = 3}});
  all.push_back({"nearly dependent rows, tight", {.size = 20, .rows = 20, .tightness = 0.9, .near_copies = 2}});
  all.push_back({"nearly dependent rows, parts and groups",
                 {.size = 30, .components = 2, .groups = 2, .rows = 10, .perspective = true, .near_copies = 2}});
  all.push_back({"tiny", {.size = 4, .components = 2, .rows = 1}});
  return all;
}

TEST_CASE("BoundedQpRandom.EqualsDenseReference") {
  for (const Case& example : cases()) {
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
      INFO(std::string(example.name) + ", seed " + std::to_string(seed));
      const RandomProblem p = test::random_problem(seed, example.settings);
      const test::DenseProblem dense = test::dense_problem(p.Q, p.constraints);
      const test::DenseSolution reference = test::solve_dense(dense);
      {
        INFO("the reference itself");
        REQUIRE(reference.gap < 1e-6 * (1 + reference.objective));
        REQUIRE(reference.violation < 1e-7);
      }
      for (const QpMethod method : {QpMethod::automatic, QpMethod::interior_point}) {
        INFO(EnumNames<QpMethod>::names.at(static_cast<std::size_t>(method)));
        const BoundedQpSolution s = solve_random(p, {.method = method});
        CHECK(violation(p.constraints, s) <= 1e-9);
        CHECK_THAT(p.constraints.gauge.dot(s.u), WithinAbs(0, 1e-9));
        CHECK_THAT(0.5 * s.u.dot(p.Q * s.u), WithinAbs(reference.objective, 2e-6 * (1 + reference.objective)));
        // Summed here without care for cancellation.
        CHECK_THAT(s.objective, WithinAbs(0.5 * s.u.dot(p.Q * s.u),
                                          1e-12 + 1e-14 * s.u.cwiseAbs().dot(p.Q.cwiseAbs() * s.u.cwiseAbs())));
        Eigen::VectorXd x(s.u.size() + s.m.size());
        x << s.u, s.m;
        if (s.objective > 1e-12) {
          // Multipliers on fewer rows prove as much, and nearly equal columns cost NNLS digits.
          const double gap = std::min(test::stationarity_gap(dense, x, 1e-8), test::stationarity_gap(dense, x, 1e-12));
          CHECK(gap < 1e-8);
        }
        CHECK(s.kkt_residual < 1e-9);
      }
    }
  }
}

TEST_CASE("BoundedQpRandom.IsTheSameFromAnyPointWithinTheBounds") {
  for (const Case& example : cases()) {
    for (std::uint64_t seed = 0; seed < 30; ++seed) {
      INFO(std::string(example.name) + ", seed " + std::to_string(seed));
      const RandomProblem p = test::random_problem(seed, example.settings);
      const BoundedQpSolution usual = solve_random(p);
      const BoundedQpSolution s = solve_random(with_start(p, seed), {.method = QpMethod::interior_point});
      CHECK(violation(p.constraints, s) <= 1e-9);
      CHECK_THAT(s.objective, WithinAbs(usual.objective, 1e-9 * (1 + usual.objective)));
    }
  }
}

}  // namespace
}  // namespace formwright
