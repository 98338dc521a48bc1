// SPDX-License-Identifier: GPL-3.0-or-later
// The numbers: dense kernels against Eigen, the factor against its definition.
#include "numerics/sparse/multifrontal.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cstring>

#include "numerics/dense/dense_kernels.h"
#include "numerics/dense/dense_solves.h"
#include "numerics/ordering/nested_dissection.h"
#include "numerics/sparse_matrices.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

TEST_CASE("DenseKernels.UpdateSubtractsTheProductOnTheLowerTriangle") {
  for (const int size : {4, 8, 12, 16, 20, 48, 100, 260, 400}) {
    for (const int depth : {1, 3, 4, 17, 128}) {
      const Eigen::MatrixXd A = test::random_matrix(size, depth, 1), start = test::random_matrix(size, size, 2);
      const Eigen::MatrixXd expected = start - A * A.transpose();
      std::vector<double> packed(static_cast<std::size_t>(size * depth));
      dense::pack(A.data(), static_cast<std::size_t>(size), depth, size, packed.data());
      const auto stride = static_cast<std::size_t>(size);
      Eigen::MatrixXd plain = start, from_packed = start, in_pieces = start, overwritten = start;
      const auto panel = dense::panel_rows(A.data(), stride), slivers = dense::packed_rows(packed.data(), depth);
      dense::update_lower(plain.data(), stride, panel, depth, 0, size, 0, size, dense::Update::subtract);
      dense::update_lower(from_packed.data(), stride, slivers, depth, 0, size, 0, size, dense::Update::subtract);
      dense::update_lower(overwritten.data(), stride, slivers, depth, 0, size, 0, size, dense::Update::overwrite);
      for (int column = 0; column < size; column += 36) {
        for (int row = 0; row < size; row += 20) {
          dense::update_lower(in_pieces.data(), stride, panel, depth, std::max(row, column), std::min(size, row + 20),
                              column, std::min(size, column + 36), dense::Update::subtract);
        }
      }
      for (int j = 0; j < size; ++j) {
        for (int i = j; i < size; ++i) {
          CHECK_THAT(plain(i, j), WithinAbs(expected(i, j), 1e-14 * (depth + 1)));
          CHECK_THAT(overwritten(i, j), WithinAbs(expected(i, j) - start(i, j), 1e-14 * (depth + 1)));
          // However it is cut up, the same bits.
          CHECK(from_packed(i, j) == plain(i, j));
          CHECK(in_pieces(i, j) == plain(i, j));
        }
        for (int i = 0; i < (j & ~3); ++i) CHECK(plain(i, j) == start(i, j));  // nothing else is touched
      }
    }
  }
}

TEST_CASE("DenseKernels.FactorsAndSolvesAPanel") {
  for (const int width : {1, 2, 3, 4, 5, 7, 8, 30, 64, 127, 128}) {
    const int below = 40, top = padded(width), height = top + below;
    Eigen::MatrixXd half = test::random_matrix(width, width, 3);
    const Eigen::MatrixXd A = half * half.transpose() + Eigen::MatrixXd::Identity(width, width) * width;
    const Eigen::MatrixXd B = test::random_matrix(below, width, 4);
    Eigen::MatrixXd panel = Eigen::MatrixXd::Zero(height, width);
    panel.topRows(width) = A.triangularView<Eigen::Lower>();
    panel.bottomRows(below) = B;
    const std::vector<double> minimum(static_cast<std::size_t>(width), 0.0);
    const auto stride = static_cast<std::size_t>(height);
    REQUIRE(dense::factor_diagonal(panel.data(), stride, width, minimum.data()) == -1);
    dense::solve_rows(panel.data(), stride, width, panel.data() + top, stride, below);
    const Eigen::MatrixXd L = panel.topRows(width).triangularView<Eigen::Lower>();
    {
      INFO(width);
      CHECK((L * L.transpose() - A).norm() <= 1e-14 * A.norm());
    }
    CHECK((panel.bottomRows(below) * L.transpose() - B).norm() <= 1e-14 * B.norm() * width);
    CHECK(panel.block(width, 0, top - width, width).norm() == 0);  // padding stays zero
    // And the triangular solves with this panel.
    for (const int sides : {1, dense::many_sides}) {
      Eigen::MatrixXd z = test::random_matrix(sides, height, 5), forward = z, backward = z;
      z.middleCols(width, top - width).setZero();
      forward = backward = z;
      if (sides == 1) {
        dense::forward_block<1>(panel.data(), stride, width, height, forward.data());
        dense::backward_block<1>(panel.data(), stride, width, height, backward.data());
      } else {
        dense::forward_block<dense::many_sides>(panel.data(), stride, width, height, forward.data());
        dense::backward_block<dense::many_sides>(panel.data(), stride, width, height, backward.data());
      }
      const Eigen::MatrixXd z1 = z.leftCols(width).transpose(), z2 = z.rightCols(below).transpose(),
                            L2 = panel.bottomRows(below);
      const Eigen::MatrixXd y1 = L.triangularView<Eigen::Lower>().solve(z1);
      const Eigen::MatrixXd x1 = L.transpose().triangularView<Eigen::Upper>().solve(z1 - L2.transpose() * z2);
      CHECK((forward.leftCols(width).transpose() - y1).norm() <= 1e-13 * z1.norm());
      CHECK((forward.rightCols(below).transpose() - (z2 - L2 * y1)).norm() <= 1e-13 * z2.norm());
      CHECK((backward.leftCols(width).transpose() - x1).norm() <= 1e-13 * z1.norm());
    }
  }
}

TEST_CASE("DenseKernels.TellsTheColumnThatIsNotPositive") {
  for (const int bad : {0, 3, 4, 50, 127}) {
    Eigen::MatrixXd A = Eigen::MatrixXd::Identity(128, 128);
    A(bad, bad) = 1e-20;
    const std::vector<double> minimum(128, 1e-15);
    CHECK(dense::factor_diagonal(A.data(), 128, 128, minimum.data()) == bad);
  }
}

struct Factorization {
  SupernodalForm form;
  SupernodalFactor factor;
};

Factorization multifrontal(const SparseMatrix& A, bool parallel, int leaf_size) {
  Context context;
  Factorization result;
  const Graph graph = graph_of(A);
  result.form = find_supernodes(graph, nested_dissection(graph, {.leaf_size = leaf_size}, context), context);
  const AssemblyMap map = map_assembly(A, graph, result.form);
  const Eigen::VectorXd diagonal = A.diagonal();
  factorize_multifrontal(result.form, map, A.valuePtr(), {diagonal.data(), diagonal.data() + diagonal.size()},
                         result.factor, {.parallel = parallel}, context);
  return result;
}

Eigen::MatrixXd dense_factor(const Factorization& f) {
  Eigen::MatrixXd L = Eigen::MatrixXd::Zero(f.form.n, f.form.n);
  for (int s = 0; s < f.form.count(); ++s) {
    const int columns = f.form.columns(s), height = f.form.height(s), first = f.form.first_column[s];
    const double* storage = f.factor.value.get() + f.form.first_value[s];
    for (int j = 0; j < columns; ++j) {
      const int block = j / SupernodalForm::block_width, start = block * SupernodalForm::block_width;
      const double* column = storage + block_offset(block, height) +
                             static_cast<std::size_t>(j - start) * static_cast<std::size_t>(height - start) - start;
      for (int i = j; i < columns; ++i) L(first + i, first + j) = column[i];
      const auto rows = f.form.rows_below(s);
      for (std::size_t i = 0; i < rows.size(); ++i)
        L(rows[i], first + j) = column[static_cast<std::size_t>(padded(columns)) + i];
    }
  }
  return L;
}

TEST_CASE("Multifrontal.TheFactorReproducesTheMatrix") {
  std::uint64_t seed = 20;
  std::vector<SparseMatrix> matrices{test::torus_bilaplacian(40, 25, 0.5), test::grid_laplacian(30, 33, 0.1)};
  for (const double per_row : {1.0, 4.0, 15.0, 400.0}) matrices.push_back(test::random_spd(500, per_row, ++seed));
  for (const SparseMatrix& A : matrices) {
    const Factorization f = multifrontal(A, true, 50);
    const Eigen::MatrixXd L = dense_factor(f), dense = test::dense_of(A);
    Eigen::MatrixXd permuted(f.form.n, f.form.n);
    for (int i = 0; i < f.form.n; ++i) {
      for (int j = 0; j < f.form.n; ++j)
        permuted(i, j) = dense(f.form.permutation.order[i], f.form.permutation.order[j]);
    }
    CHECK((L * L.transpose() - permuted).norm() <= 1e-14 * permuted.norm());
  }
}

TEST_CASE("Multifrontal.ThreadsDoNotChangeABit") {
  const SparseMatrix A = test::torus_bilaplacian(160, 130, 0.1);  // large enough for parallel fronts at the top
  const Factorization one = multifrontal(A, false, 300), all = multifrontal(A, true, 300);
  REQUIRE(one.form.first_value.back() == all.form.first_value.back());
  // Compare what L is made of: entries above the diagonal inside blocks are scratch.
  double differences = 0;
  for (int s = 0; s < one.form.count(); ++s) {
    const int columns = one.form.columns(s), height = one.form.height(s);
    for (int j = 0; j < columns; ++j) {
      const int block = j / SupernodalForm::block_width, start = block * SupernodalForm::block_width;
      const std::size_t begin = one.form.first_value[s] + block_offset(block, height) +
                                static_cast<std::size_t>(j - start) * static_cast<std::size_t>(height - start) +
                                static_cast<std::size_t>(j - start);
      differences += std::memcmp(one.factor.value.get() + begin, all.factor.value.get() + begin,
                                 static_cast<std::size_t>(height - j) * sizeof(double)) != 0;
    }
  }
  CHECK(differences == 0);
}

}  // namespace
}  // namespace formwright
