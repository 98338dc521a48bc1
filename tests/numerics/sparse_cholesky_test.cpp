// SPDX-License-Identifier: GPL-3.0-or-later
#include "numerics/sparse/sparse_cholesky.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <Eigen/Cholesky>
#include <atomic>
#include <cmath>
#include <limits>
#include <string>
#include <thread>

#include "base/error.h"
#include "base/parallel.h"
#include "numerics/sparse_matrices.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

using test::MatrixRandom;

SparseCholesky factored_with(const SparseMatrix& lower, const Positions& positions, Context& context) {
  SparseCholesky cholesky;
  cholesky.analyze(lower, positions, context);
  cholesky.factorize(lower, context);
  return cholesky;
}

SparseCholesky factored(const SparseMatrix& lower, const Positions& positions = {}) {
  Context context;
  return factored_with(lower, positions, context);
}

Eigen::VectorXd dense_of(const SparseVector& sparse, int n) {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(n);
  for (std::size_t k = 0; k < sparse.index.size(); ++k) result[sparse.index[k]] += sparse.value[k];
  return result;
}

double relative_residual(const SparseMatrix& lower, const Eigen::MatrixXd& x, const Eigen::MatrixXd& b) {
  return (lower.selfadjointView<Eigen::Lower>() * x - b).norm() / b.norm();
}

ErrorCode thrown_code(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.code();
  }
  FAIL_CHECK("nothing was thrown");
  return ErrorCode::internal;
}

TEST_CASE("SparseCholesky.SolvesLikeDenseCholesky") {
  std::uint64_t seed = 1;
  for (const int n : {1, 2, 3, 4, 5, 8, 13, 40, 129, 300}) {
    for (const double per_row : {0.0, 1.0, 3.0, 12.0, 60.0}) {
      const SparseMatrix A = test::random_spd(n, per_row, ++seed);
      const Eigen::MatrixXd b = test::random_matrix(n, 3, seed), expected = test::dense_of(A).llt().solve(b);
      Eigen::MatrixXd x = b;
      factored(A).solve(x);
      INFO("n " << n << ", per row " << per_row);
      CHECK((x - expected).norm() <= 1e-13 * expected.norm() * std::sqrt(n));
    }
  }
}

TEST_CASE("SparseCholesky.SolvesAFullMatrix") {
  const int n = 400;  // more than three blocks of columns
  const Eigen::MatrixXd half = test::random_matrix(n, n, 3);
  const SparseMatrix full =
      Eigen::MatrixXd(half * half.transpose() + 20 * Eigen::MatrixXd::Identity(n, n)).sparseView();
  SparseMatrix A = full.triangularView<Eigen::Lower>();
  A.makeCompressed();
  const Eigen::MatrixXd b = test::random_matrix(n, 1, 4);
  Eigen::MatrixXd x = b;
  const SparseCholesky cholesky = factored(A);
  cholesky.solve(x);
  CHECK(relative_residual(A, x, b) <= 1e-12);
  CHECK(cholesky.factor_entries() == 0.5 * n * (n + 1));
}

TEST_CASE("SparseCholesky.ResidualIsRoundOffForEveryNumberOfSides") {
  const SparseMatrix A = test::torus_bilaplacian(70, 50, 1.0);  // condition number about 140
  const SparseCholesky cholesky = factored(A, test::torus_positions(70, 50));
  for (const int sides : {1, 2, 7, 8, 9, 17}) {
    const Eigen::MatrixXd b = test::random_matrix(3500, sides, 5);
    Eigen::MatrixXd x = b;
    cholesky.solve(x);
    INFO(sides);
    CHECK(relative_residual(A, x, b) <= 1e-12);
  }
}

TEST_CASE("SparseCholesky.ForwardAndBackwardAreTheTwoHalvesOfSolve") {
  const SparseMatrix A = test::torus_bilaplacian(40, 30, 0.5);
  const SparseCholesky cholesky = factored(A);
  const Eigen::VectorXd b = test::random_matrix(1200, 1, 6);
  Eigen::VectorXd y = b;
  cholesky.forward(Eigen::Ref<Eigen::VectorXd>(y));
  Eigen::MatrixXd x = b;
  cholesky.solve(x);
  CHECK_THAT(y.squaredNorm(), WithinAbs(b.dot(x.col(0)), 1e-12 * y.squaredNorm()));  // |L^-1 P b|^2 = b^T A^-1 b
  cholesky.backward(y);
  CHECK((y - x.col(0)).norm() == 0);
}

TEST_CASE("SparseCholesky.SparseForwardEqualsDenseForward") {
  const SparseMatrix A = test::torus_bilaplacian(60, 45, 0.2);
  const SparseCholesky cholesky = factored(A);
  MatrixRandom random(7);
  std::vector<SparseVector> sides(21);
  std::vector<Eigen::VectorXd> expected;
  for (std::size_t k = 0; k < sides.size(); ++k) {
    for (std::size_t e = 0; e < k % 6; ++e) {  // some empty, some with a repeated index
      sides[k].index.push_back(random.below(2700));
      sides[k].value.push_back(random.uniform());
    }
    expected.push_back(dense_of(sides[k], 2700));
    cholesky.forward(Eigen::Ref<Eigen::VectorXd>(expected.back()));
  }
  const std::vector<SparseVector> together = cholesky.forward(sides);
  REQUIRE(together.size() == sides.size());
  for (std::size_t k = 0; k < sides.size(); ++k) {
    const SparseVector alone = cholesky.forward(sides[k]);
    for (const SparseVector& y : {alone, together[k]}) {
      CHECK(std::is_sorted(y.index.begin(), y.index.end()));
      INFO(k);
      CHECK((dense_of(y, 2700) - expected[k]).norm() <= 1e-14 * expected[k].norm());
    }
    // Only the path is visited: far fewer rows than there are.
    CHECK(alone.index.size() < 1400u);
  }
}

TEST_CASE("SparseCholesky.ForwardMayRunInSeveralThreads") {
  const SparseMatrix A = test::torus_bilaplacian(50, 50, 0.2);
  const SparseCholesky cholesky = factored(A);
  std::vector<SparseVector> expected, found(200);
  for (int k = 0; k < 200; ++k) expected.push_back(cholesky.forward(SparseVector{{k * 12, k * 12 + 3}, {1.0, -2.0}}));
  parallel_for(found.size(), 1, [&](std::size_t begin, std::size_t) {
    const int k = static_cast<int>(begin);
    found[begin] = cholesky.forward(SparseVector{{k * 12, k * 12 + 3}, {1.0, -2.0}});
  });
  for (std::size_t k = 0; k < found.size(); ++k) {
    CHECK(found[k].index == expected[k].index);
    CHECK(found[k].value == expected[k].value);
  }
}

TEST_CASE("SparseCholesky.EmptyAndOneByOne") {
  const SparseMatrix empty(0, 0);
  const SparseCholesky none = factored(empty);
  CHECK(none.size() == 0);
  CHECK(none.factor_entries() == 0);
  Eigen::MatrixXd nothing(0, 2);
  CHECK_NOTHROW(none.solve(nothing));
  CHECK(none.forward(SparseVector{}).index.empty());

  const SparseCholesky one = factored(test::lower_of(1, {{0, 0, 4.0}}));
  Eigen::MatrixXd x = Eigen::MatrixXd::Constant(1, 1, 3.0);
  one.solve(x);
  CHECK(x(0, 0) == 0.75);
  const SparseVector y = one.forward(SparseVector{{0}, {3.0}});
  CHECK(y.index == std::vector<int>{0});
  CHECK(y.value == std::vector<double>{1.5});
}

TEST_CASE("SparseCholesky.DisconnectedPartsAreSolvedApart") {
  const SparseMatrix torus = test::torus_bilaplacian(30, 20, 0.7), grid = test::grid_laplacian(25, 17, 0.3);
  std::vector<Eigen::Triplet<double>> entries;
  int n = 0;
  const auto add = [&](const SparseMatrix& block) {
    for (int j = 0; j < block.cols(); ++j) {
      for (SparseMatrix::InnerIterator it(block, j); it; ++it)
        entries.emplace_back(n + static_cast<int>(it.row()), n + j, it.value());
    }
    n += static_cast<int>(block.cols());
  };
  add(torus);
  for (int k = 0; k < 700; ++k) add(test::lower_of(1, {{0, 0, 4.0}}));
  add(grid);
  add(torus);
  const SparseMatrix A = test::lower_of(n, entries);
  const SparseCholesky cholesky = factored(A);
  const Eigen::MatrixXd b = test::random_matrix(n, 2, 8);
  Eigen::MatrixXd x = b, alone = b.bottomRows(600);
  cholesky.solve(x);
  factored(torus).solve(alone);
  CHECK(relative_residual(A, x, b) <= 1e-13);
  CHECK((x.bottomRows(600) - alone).norm() <= 1e-12 * alone.norm());
  CHECK(x(600, 0) == b(600, 0) / 4);
  // A force on one part moves no other.
  const SparseVector y = cholesky.forward(SparseVector{{n - 1}, {1.0}});
  Eigen::VectorXd moved = dense_of(y, n);
  cholesky.backward(moved);
  CHECK(moved.head(n - 600).norm() == 0);
  CHECK(moved.tail(600).norm() > 0);
}

TEST_CASE("SparseCholesky.AnArrowStaysSparse") {
  for (const bool full_row_first : {false, true}) {
    const int n = 20000, hub = full_row_first ? 0 : n - 1;
    std::vector<Eigen::Triplet<double>> entries;
    for (int i = 0; i < n; ++i) {
      entries.emplace_back(i, i, i == hub ? n : 2.0);
      if (i != hub) entries.emplace_back(std::max(i, hub), std::min(i, hub), 1.0);
    }
    const SparseMatrix A = test::lower_of(n, entries);
    const SparseCholesky cholesky = factored(A);
    CHECK(cholesky.factor_entries() < 2.1 * n);  // 2 n - 1 and a few stored zeros
    const Eigen::MatrixXd b = test::random_matrix(n, 1, 9);
    Eigen::MatrixXd x = b;
    cholesky.solve(x);
    CHECK(relative_residual(A, x, b) <= 1e-12);
  }
}

TEST_CASE("SparseCholesky.RefusesAMatrixThatIsNotPositiveDefinite") {
  SparseMatrix A = test::torus_bilaplacian(40, 40, 1.0);
  for (const double bad :
       {0.0, -3.0, -std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    std::vector<Eigen::Triplet<double>> entries;
    for (int i = 0; i < 50; ++i) entries.emplace_back(i, i, i == 37 ? bad : 1.0);
    Context context;
    SparseCholesky cholesky;
    const SparseMatrix D = test::lower_of(50, entries);
    cholesky.analyze(D, {}, context);
    try {
      cholesky.factorize(D, context);
      FAIL_CHECK("accepted " << bad);
    } catch (const Error& error) {
      CHECK(error.code() == ErrorCode::could_not_solve);
      INFO(error.what());
      CHECK(std::string(error.what()).find("no unique solution") != std::string::npos);
    }
  }
}

TEST_CASE("SparseCholesky.RefusesASingularMatrix") {
  // Constants cost nothing, so the last pivot is zero but for round-off of either sign.
  for (const int width : {12, 25, 60}) {
    const SparseMatrix A = test::torus_bilaplacian(width, 20, 0.0);
    INFO(width);
    CHECK(thrown_code([&] { factored(A); }) == ErrorCode::could_not_solve);
  }
}

TEST_CASE("SparseCholesky.FactorsAgainAfterAFailureAndWithOtherValues") {
  SparseMatrix A = test::torus_bilaplacian(30, 30, 1.0);
  const SparseMatrix singular = test::torus_bilaplacian(30, 30, 0.0);
  Context context;
  SparseCholesky cholesky;
  cholesky.analyze(A, {}, context);
  CHECK(thrown_code([&] { cholesky.factorize(singular, context); }) == ErrorCode::could_not_solve);
  Eigen::MatrixXd x = Eigen::MatrixXd::Ones(900, 1);
  CHECK(thrown_code([&] { cholesky.solve(x); }) == ErrorCode::internal);
  for (const double scale : {1.0, 0.25, 8.0}) {
    const SparseMatrix scaled = scale * A;
    cholesky.factorize(scaled, context);
    Eigen::MatrixXd y = x;
    cholesky.solve(y);
    CHECK((y * scale - x).norm() <= 1e-12 * x.norm());  // A 1 = 1
  }
}

TEST_CASE("SparseCholesky.RefusesWhatItDoesNotUnderstand") {
  Context context;
  SparseCholesky cholesky;
  const auto analyze = [&](const SparseMatrix& A) { return thrown_code([&] { cholesky.analyze(A, {}, context); }); };
  CHECK(analyze(SparseMatrix(2, 3)) == ErrorCode::invalid_input);
  CHECK(analyze(test::lower_of(2, {{0, 0, 1.0}, {0, 1, 1.0}, {1, 1, 3.0}})) == ErrorCode::invalid_input);
  CHECK(analyze(test::lower_of(2, {{0, 0, 1.0}, {1, 0, 1.0}})) == ErrorCode::invalid_input);
  cholesky.analyze(test::grid_laplacian(4, 4, 1.0), {}, context);
  CHECK(thrown_code([&] { cholesky.factorize(test::grid_laplacian(4, 5, 1.0), context); }) == ErrorCode::invalid_input);
  CHECK(thrown_code([&] { cholesky.factorize(test::grid_laplacian(2, 8, 1.0), context); }) == ErrorCode::invalid_input);
}

TEST_CASE("SparseCholesky.AcceptsAnUncompressedMatrix") {
  const SparseMatrix A = test::grid_laplacian(9, 7, 1.0);
  SparseMatrix loose = A;
  loose.reserve(Eigen::VectorXi::Constant(63, 10));
  REQUIRE_FALSE(loose.isCompressed());
  const Eigen::MatrixXd b = test::random_matrix(63, 1, 10);
  Eigen::MatrixXd x = b, y = b;
  factored(A).solve(x);
  factored(loose).solve(y);
  CHECK((x - y).norm() == 0);
}

TEST_CASE("SparseCholesky.TheSameInputGivesTheSameBits") {
  const SparseMatrix A = test::torus_bilaplacian(120, 90, 0.1);
  const Positions positions = test::torus_positions(120, 90);
  const Eigen::MatrixXd b = test::random_matrix(10800, 1, 11);
  Eigen::MatrixXd first = b;
  factored(A, positions).solve(first);
  for (int repeat = 0; repeat < 3; ++repeat) {
    Eigen::MatrixXd x = b;
    factored(A, positions).solve(x);
    CHECK((x - first).norm() == 0);
  }
}

// Cancelled at the k-th question, wherever that falls.
TEST_CASE("SparseCholesky.StopsWhereverItIsCancelled") {
  const SparseMatrix A = test::torus_bilaplacian(100, 80, 1.0);
  for (const int last : {1, 2, 5, 20, 60, 100}) {
    std::atomic<int> questions{0};
    Host host;
    host.cancel_requested = [&] { return ++questions >= last; };
    Context context(host), patient;
    SparseCholesky cholesky;
    CHECK(thrown_code([&] {
            cholesky.analyze(A, {}, context);
            for (;;) cholesky.factorize(A, context);
          }) == ErrorCode::cancelled);
    cholesky.analyze(A, {}, patient);
    cholesky.factorize(A, patient);
    Eigen::MatrixXd x = Eigen::MatrixXd::Ones(8000, 1);
    cholesky.solve(x);
    CHECK_THAT(x(17, 0), WithinAbs(1.0, 1e-10));
  }
}

#ifndef __EMSCRIPTEN__  // which has no threads
TEST_CASE("SparseCholesky.AnotherThreadCanCancel") {
  const SparseMatrix A = test::torus_bilaplacian(150, 150, 1.0);
  std::atomic<bool> stop{false};
  Host host;
  host.cancel_requested = [&] { return stop.load(); };
  Context context(host);
  std::thread canceller([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    stop = true;
  });
  CHECK(thrown_code([&] {
          for (;;) factored_with(A, {}, context);
        }) == ErrorCode::cancelled);
  canceller.join();
}
#endif

TEST_CASE("SparseCholesky.ProgressRisesAndEndsAtOne") {
  const SparseMatrix A = test::torus_bilaplacian(100, 100, 1.0);
  std::vector<Progress> messages;
  Host host;
  host.on_progress = [&](const Progress& progress) { messages.push_back(progress); };
  Context context(host);
  SparseCholesky cholesky;
  {
    const auto span = context.span(0, 0.5, "Ordering");
    cholesky.analyze(A, {}, context);
  }
  const auto span = context.span(0.5, 1, "Factorising");
  cholesky.factorize(A, context);
  REQUIRE_FALSE(messages.empty());
  for (std::size_t k = 1; k < messages.size(); ++k) CHECK(messages[k - 1].fraction <= messages[k].fraction);
  CHECK(messages.back().fraction <= 1.0);
  CHECK(messages.back().stage == "Factorising");
}

TEST_CASE("SparseCholesky.MemoryIsThatOfTheFactor") {
  const SparseMatrix A = test::torus_bilaplacian(100, 100, 1.0);
  const SparseCholesky cholesky = factored(A);
  CHECK(cholesky.memory_mb() > 8e-6 * cholesky.factor_entries());
  CHECK(cholesky.memory_mb() < 8e-6 * cholesky.factor_entries() * 1.6);
}

}  // namespace
}  // namespace formwright
