// SPDX-License-Identifier: GPL-3.0-or-later
#include "numerics/dense/grown_cholesky.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/generators/catch_generators.hpp>

#include <Eigen/Cholesky>
#include <vector>

#include "numerics/bounded_qp_reference.h"

namespace formwright {
namespace {

/// Positive definite, with smallest eigenvalue at least 1.
Eigen::MatrixXd definite(Eigen::Index n, std::uint64_t seed) {
  test::Random random(seed);
  Eigen::MatrixXd A(n, n);
  for (Eigen::Index j = 0; j < n; ++j)
    for (Eigen::Index i = 0; i < n; ++i) A(i, j) = random.between(-1, 1);
  return A * A.transpose() / static_cast<double>(n) + Eigen::MatrixXd::Identity(n, n);
}

TEST_CASE("GrownCholesky.IsTheFactorHoweverItGrew") {
  // Sizes about the width of a panel, grown in one step, in two, and row by row about its border.
  const Eigen::Index n = GENERATE(1, 2, 127, 128, 129, 300, 520);
  const Eigen::MatrixXd A = definite(n, static_cast<std::uint64_t>(n));
  const Eigen::MatrixXd expected = A.llt().matrixL();
  std::vector<std::vector<Eigen::Index>> ways{{n}, {n / 2, n}, {n / 3, n / 3 + 1, n}};
  if (n > 130) ways.push_back({126, 127, 128, 129, 130, n});
  for (const std::vector<Eigen::Index>& ends : ways) {
    Eigen::MatrixXd L = A.triangularView<Eigen::Lower>();
    Eigen::Index from = 0;
    for (const Eigen::Index end : ends) {
      REQUIRE(dense::grow_cholesky(L, from, end));
      from = end;
    }
    const Eigen::MatrixXd factor = L.triangularView<Eigen::Lower>();
    CHECK((factor - expected).cwiseAbs().maxCoeff() < 1e-13);
    CHECK((factor * factor.transpose() - A).cwiseAbs().maxCoeff() < 1e-13);
  }
}

TEST_CASE("GrownCholesky.KeepsTheRowsBeforeBitForBit") {
  const Eigen::MatrixXd A = definite(400, 7);
  Eigen::MatrixXd L = A.triangularView<Eigen::Lower>();
  REQUIRE(dense::grow_cholesky(L, 0, 250));
  const Eigen::MatrixXd before = L.topLeftCorner(250, 250).triangularView<Eigen::Lower>();
  REQUIRE(dense::grow_cholesky(L, 250, 400));
  CHECK((L.topLeftCorner(250, 250).triangularView<Eigen::Lower>().toDenseMatrix().array() == before.array()).all());
}

TEST_CASE("GrownCholesky.SaysWhatIsNotPositiveDefinite") {
  Eigen::MatrixXd A = definite(200, 3);
  A.row(150) = A.row(20);
  A.col(150) = A.col(20);
  A(150, 150) = A(20, 20) * (1 - 1e-6);
  Eigen::MatrixXd L = A.triangularView<Eigen::Lower>();
  CHECK(dense::grow_cholesky(L, 0, 150));
  CHECK_FALSE(dense::grow_cholesky(L, 150, 200));
  CHECK(dense::grow_cholesky(L, 0, 0));
}

}  // namespace
}  // namespace formwright
