// SPDX-License-Identifier: GPL-3.0-or-later
// Bounds that nothing satisfies, bad input, cancelling.
#include <catch2/catch_test_macros.hpp>

#include <chrono>

#include "base/error.h"
#include "numerics/bounded_qp_problems.h"

namespace formwright {
namespace {
using namespace test;

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
  QpProblem p = bumpy_relief(10, 10, 0.5);
  for (const int i : {3, 4, 77}) p.constraints.lower[i] = p.constraints.upper[i] + 0.1;
  std::string message;
  CHECK(code_of([&] { solve(p); }, &message) == ErrorCode::invalid_input);
  INFO(message);
  CHECK(message.find("lower bound is above the upper bound for 3 unknowns") != std::string::npos);
}

TEST_CASE("BoundedQp.ContradictionsAreFound") {
  for (const QpMethod method : {QpMethod::exchange, QpMethod::automatic, QpMethod::interior_point}) {
    {
      QpProblem p = bumpy_relief(10, 10, 0.5);  // u_0 - u_1 >= 50 does not fit into the slab
      p.constraints.rows.push_back({{0, 1}, {1.0, -1.0}, 0, 0, 50});
      CHECK(code_of([&] { solve(p, method); }) == ErrorCode::could_not_solve);
    }
    {
      QpProblem p = bumpy_relief(10, 10, 0.5);  // two rows against each other, though bounds allow either
      p.constraints.rows.push_back({{0, 1}, {1.0, -1.0}, 0, 0, 0.1});
      p.constraints.rows.push_back({{1, 0}, {1.0, -1.0}, 0, 0, 0.1});
      CHECK(code_of([&] { solve(p, method); }) == ErrorCode::could_not_solve);
    }
  }
}

TEST_CASE("BoundedQp.BadInputNamesItsPlace") {
  Context context;
  const QpProblem good = bumpy_relief(6, 5, 0.5);
  BoundedQp qp;
  CHECK(code_of([&] { qp.set_energy(good.lower_Q, std::vector<int>(7, 0), {}, context); }) == ErrorCode::invalid_input);
  SparseMatrix shifted = good.lower_Q;
  for (int i = 0; i < 30; ++i) shifted.coeffRef(i, i) += 1;  // constants no longer free
  CHECK(code_of([&] { qp.set_energy(shifted, good.component, {}, context); }) == ErrorCode::invalid_input);
  std::vector<int> torn = good.component;
  torn[3] = 1;
  CHECK(code_of([&] { qp.set_energy(good.lower_Q, torn, {}, context); }) == ErrorCode::invalid_input);

  const auto rejected = [&](auto change) {
    QpProblem p = good;
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
  const QpProblem p = bumpy_relief(60, 50, 0.05);
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
