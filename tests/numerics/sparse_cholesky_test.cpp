// SPDX-License-Identifier: GPL-3.0-or-later
#include "numerics/sparse_cholesky.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "base/error.h"

namespace formwright {
namespace {

/// The five-point Laplacian of a grid plus `shift`: positive definite for shift > 0.
SparseMatrix grid_laplacian(int side, double shift) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const int i = y * side + x;
      entries.emplace_back(i, i, 4 + shift);
      if (x + 1 < side) entries.emplace_back(i + 1, i, -1);
      if (y + 1 < side) entries.emplace_back(i + side, i, -1);
    }
  SparseMatrix A(side * side, side * side);
  A.setFromTriplets(entries.begin(), entries.end());
  return A;
}

Eigen::MatrixXd dense(const SparseMatrix& lower) { return Eigen::MatrixXd(lower).selfadjointView<Eigen::Lower>(); }

TEST(SparseCholesky, SolvesWhatADenseFactorisationSolves) {
  Context context;
  for (const int side : {1, 2, 7, 20}) {
    const SparseMatrix A = grid_laplacian(side, 0.1);
    SparseCholesky cholesky;
    cholesky.analyze(A, {}, context);
    cholesky.factorize(A, context);
    Eigen::MatrixXd b(A.rows(), 2);
    for (Eigen::Index i = 0; i < A.rows(); ++i) b.row(i) << std::sin(3.0 * static_cast<double>(i)), 1.0;
    Eigen::MatrixXd x = b;
    cholesky.solve(x);
    EXPECT_LT((x - dense(A).llt().solve(b)).cwiseAbs().maxCoeff(), 1e-11) << side;
    EXPECT_LT((dense(A) * x - b).cwiseAbs().maxCoeff(), 1e-12 * x.cwiseAbs().maxCoeff() * 10) << side;
  }
}

TEST(SparseCholesky, ForwardAlongThePathIsTheDenseForward) {
  Context context;
  const SparseMatrix A = grid_laplacian(15, 0.5);
  SparseCholesky cholesky;
  cholesky.analyze(A, {}, context);
  cholesky.factorize(A, context);
  for (const int i : {0, 7, 100, 224}) {
    Eigen::VectorXd y = Eigen::VectorXd::Zero(A.rows());
    y[i] = 2;
    cholesky.forward(y);
    const SparseVector sparse = cholesky.forward(SparseVector{{i}, {2.0}});
    Eigen::VectorXd scattered = Eigen::VectorXd::Zero(A.rows());
    for (std::size_t k = 0; k < sparse.index.size(); ++k) {
      if (k > 0) {
        EXPECT_LT(sparse.index[k - 1], sparse.index[k]);
      }
      scattered[sparse.index[k]] = sparse.value[k];
    }
    EXPECT_LT((scattered - y).cwiseAbs().maxCoeff(), 1e-14);
    // y^T y = b^T A^-1 b, whatever the ordering.
    Eigen::MatrixXd b = Eigen::MatrixXd::Zero(A.rows(), 1);
    b(i, 0) = 2;
    const Eigen::MatrixXd right = b;
    cholesky.solve(b);
    EXPECT_NEAR(y.squaredNorm(), (right.transpose() * b)(0, 0), 1e-12);
    cholesky.backward(y);
    EXPECT_LT((y - b.col(0)).cwiseAbs().maxCoeff(), 1e-13);
  }
}

TEST(SparseCholesky, RefusesWhatIsNotPositiveDefinite) {
  Context context;
  const SparseMatrix A = grid_laplacian(6, -1.0);
  SparseCholesky cholesky;
  cholesky.analyze(A, {}, context);
  try {
    cholesky.factorize(A, context);
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::could_not_solve);
  }
}

TEST(SparseCholesky, FactorsOtherValuesOnTheSamePattern) {
  Context context;
  SparseCholesky cholesky;
  cholesky.analyze(grid_laplacian(9, 1), {}, context);
  for (const double shift : {1.0, 0.01, 30.0}) {
    const SparseMatrix A = grid_laplacian(9, shift);
    cholesky.factorize(A, context);
    Eigen::MatrixXd x = Eigen::MatrixXd::Ones(81, 1);
    cholesky.solve(x);
    EXPECT_LT((dense(A) * x - Eigen::MatrixXd::Ones(81, 1)).cwiseAbs().maxCoeff(), 1e-12);
  }
}

}  // namespace
}  // namespace formwright
