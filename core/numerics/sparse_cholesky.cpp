// SPDX-License-Identifier: GPL-3.0-or-later
#include "numerics/sparse_cholesky.h"

#include <Eigen/OrderingMethods>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "base/error.h"

namespace formwright {

// A simplicial, up-looking factorisation (Davis 2006, ch. 4).
struct SparseCholesky::Implementation {
  int n = 0;
  std::vector<int> position;        // old row -> place in the elimination
  std::vector<int> parent;          // elimination tree
  std::vector<std::int64_t> start;  // of L's columns, n + 1
  std::vector<int> row;
  std::vector<double> value;        // the diagonal comes first in each column
  double flops = 0;
  bool factored = false;

  // The permuted matrix, upper triangle by columns: column k holds the rows i <= k of P A P^T.
  SparseMatrix permuted_upper(const SparseMatrix& lower) const {
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(static_cast<std::size_t>(lower.nonZeros()));
    for (int j = 0; j < n; ++j) {
      for (SparseMatrix::InnerIterator it(lower, j); it; ++it) {
        const int a = position[static_cast<std::size_t>(it.row())];
        const int b = position[static_cast<std::size_t>(j)];
        entries.emplace_back(std::min(a, b), std::max(a, b), it.value());
      }
    }
    SparseMatrix upper(n, n);
    upper.setFromTriplets(entries.begin(), entries.end());
    return upper;
  }

  void path(int from, std::vector<char>& seen, std::vector<int>& out) const {
    for (int j = from; j != -1 && !seen[static_cast<std::size_t>(j)]; j = parent[static_cast<std::size_t>(j)]) {
      seen[static_cast<std::size_t>(j)] = 1;
      out.push_back(j);
    }
  }
};

SparseCholesky::SparseCholesky() : implementation_(std::make_unique<Implementation>()) {}
SparseCholesky::~SparseCholesky() = default;
SparseCholesky::SparseCholesky(SparseCholesky&&) noexcept = default;
SparseCholesky& SparseCholesky::operator=(SparseCholesky&&) noexcept = default;

void SparseCholesky::analyze(const SparseMatrix& lower, const Positions&, Context& context) {
  if (lower.rows() != lower.cols()) throw Error(ErrorCode::invalid_input, "matrix", "The matrix must be square.");
  auto& I = *implementation_;
  I = Implementation{};
  I.n = static_cast<int>(lower.rows());
  const std::size_t n = static_cast<std::size_t>(I.n);
  for (int j = 0; j < I.n; ++j) {
    for (SparseMatrix::InnerIterator it(lower, j); it; ++it) {
      if (it.row() < j) throw Error(ErrorCode::invalid_input, "matrix", "Only the lower triangle may be stored.");
    }
  }
  context.progress(0, "Ordering");
  if (I.n == 0) {
    I.start.assign(1, 0);
    return;
  }
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int>()(lower.selfadjointView<Eigen::Lower>(), order);
  I.position.resize(n);
  for (std::size_t k = 0; k < n; ++k) I.position[static_cast<std::size_t>(order.indices()[static_cast<Eigen::Index>(k)])] = static_cast<int>(k);
  context.progress(0.7, "Ordering");

  const SparseMatrix upper = I.permuted_upper(lower);
  I.parent.assign(n, -1);
  std::vector<int> ancestor(n, -1), mark(n, -1);
  for (int k = 0; k < I.n; ++k) {
    for (SparseMatrix::InnerIterator it(upper, k); it; ++it) {
      for (int i = static_cast<int>(it.row()); i != -1 && i < k;) {
        const std::size_t at = static_cast<std::size_t>(i);
        const int next = ancestor[at];
        ancestor[at] = k;
        if (next == -1) I.parent[at] = k;
        i = next;
      }
    }
  }
  std::vector<std::int64_t> count(n, 1);
  for (int k = 0; k < I.n; ++k) {
    mark[static_cast<std::size_t>(k)] = k;
    for (SparseMatrix::InnerIterator it(upper, k); it; ++it) {
      for (int i = static_cast<int>(it.row()); mark[static_cast<std::size_t>(i)] != k; i = I.parent[static_cast<std::size_t>(i)]) {
        mark[static_cast<std::size_t>(i)] = k;
        ++count[static_cast<std::size_t>(i)];
      }
    }
  }
  I.start.assign(n + 1, 0);
  for (std::size_t k = 0; k < n; ++k) {
    I.start[k + 1] = I.start[k] + count[k];
    I.flops += static_cast<double>(count[k]) * static_cast<double>(count[k]);
  }
}

void SparseCholesky::factorize(const SparseMatrix& lower, Context& context) {
  auto& I = *implementation_;
  if (lower.rows() != I.n || lower.cols() != I.n) {
    throw Error(ErrorCode::invalid_input, "matrix", "The matrix must have the analysed size.");
  }
  const std::size_t n = static_cast<std::size_t>(I.n);
  I.factored = false;
  const SparseMatrix upper = I.permuted_upper(lower);
  I.row.resize(static_cast<std::size_t>(I.start[n]));
  I.value.resize(I.row.size());
  std::vector<std::int64_t> fill(I.start.begin(), I.start.end() - 1);
  std::vector<double> x(n, 0.0);
  std::vector<int> mark(n, -1), stack(n), branch(n);
  for (int k = 0; k < I.n; ++k) {
    if (k % 1024 == 0) context.progress(static_cast<double>(k) / I.n, "Factorising");
    const std::size_t at = static_cast<std::size_t>(k);
    std::size_t top = n;
    mark[at] = k;
    double diagonal = 0;
    for (SparseMatrix::InnerIterator it(upper, k); it; ++it) {
      int i = static_cast<int>(it.row());
      if (i == k) {
        diagonal = it.value();
        continue;
      }
      x[static_cast<std::size_t>(i)] += it.value();
      std::size_t length = 0;
      for (; mark[static_cast<std::size_t>(i)] != k; i = I.parent[static_cast<std::size_t>(i)]) {
        mark[static_cast<std::size_t>(i)] = k;
        branch[length++] = i;
      }
      while (length > 0) stack[--top] = branch[--length];
    }
    for (; top < n; ++top) {
      const std::size_t j = static_cast<std::size_t>(stack[top]);
      const double l = x[j] / I.value[static_cast<std::size_t>(I.start[j])];
      x[j] = 0;
      for (std::int64_t p = I.start[j] + 1; p < fill[j]; ++p) {
        x[static_cast<std::size_t>(I.row[static_cast<std::size_t>(p)])] -= I.value[static_cast<std::size_t>(p)] * l;
      }
      diagonal -= l * l;
      const std::size_t p = static_cast<std::size_t>(fill[j]++);
      I.row[p] = k;
      I.value[p] = l;
    }
    if (!(diagonal > 0) || !std::isfinite(diagonal)) {
      const auto row = std::find(I.position.begin(), I.position.end(), k) - I.position.begin();
      throw Error(ErrorCode::could_not_solve, "matrix",
                  "The matrix is not positive definite at row " + std::to_string(row) + ".");
    }
    const std::size_t p = static_cast<std::size_t>(fill[at]++);
    I.row[p] = k;
    I.value[p] = std::sqrt(diagonal);
  }
  I.factored = true;
}

void SparseCholesky::solve(Eigen::Ref<Eigen::MatrixXd> b) const {
  for (Eigen::Index c = 0; c < b.cols(); ++c) {
    forward(b.col(c));
    backward(b.col(c));
  }
}

void SparseCholesky::forward(Eigen::Ref<Eigen::VectorXd> b) const {
  const auto& I = *implementation_;
  Eigen::VectorXd y(I.n);
  for (int i = 0; i < I.n; ++i) y[I.position[static_cast<std::size_t>(i)]] = b[i];
  for (int j = 0; j < I.n; ++j) {
    std::size_t p = static_cast<std::size_t>(I.start[static_cast<std::size_t>(j)]);
    const std::size_t end = static_cast<std::size_t>(I.start[static_cast<std::size_t>(j) + 1]);
    const double yj = y[j] /= I.value[p];
    for (++p; p < end; ++p) y[I.row[p]] -= I.value[p] * yj;
  }
  b = y;
}

void SparseCholesky::backward(Eigen::Ref<Eigen::VectorXd> y) const {
  const auto& I = *implementation_;
  for (int j = I.n - 1; j >= 0; --j) {
    const std::size_t first = static_cast<std::size_t>(I.start[static_cast<std::size_t>(j)]);
    const std::size_t end = static_cast<std::size_t>(I.start[static_cast<std::size_t>(j) + 1]);
    double yj = y[j];
    for (std::size_t p = first + 1; p < end; ++p) yj -= I.value[p] * y[I.row[p]];
    y[j] = yj / I.value[first];
  }
  Eigen::VectorXd x(I.n);
  for (int i = 0; i < I.n; ++i) x[i] = y[I.position[static_cast<std::size_t>(i)]];
  y = x;
}

SparseVector SparseCholesky::forward(const SparseVector& b) const {
  const auto& I = *implementation_;
  std::vector<char> seen(static_cast<std::size_t>(I.n), 0);
  std::vector<double> y(static_cast<std::size_t>(I.n), 0.0);
  SparseVector result;
  for (std::size_t k = 0; k < b.index.size(); ++k) {
    const int j = I.position[static_cast<std::size_t>(b.index[k])];
    y[static_cast<std::size_t>(j)] += b.value[k];
    I.path(j, seen, result.index);
  }
  std::sort(result.index.begin(), result.index.end());
  for (const int j : result.index) {
    std::size_t p = static_cast<std::size_t>(I.start[static_cast<std::size_t>(j)]);
    const std::size_t end = static_cast<std::size_t>(I.start[static_cast<std::size_t>(j) + 1]);
    const double yj = y[static_cast<std::size_t>(j)] /= I.value[p];
    for (++p; p < end; ++p) y[static_cast<std::size_t>(I.row[p])] -= I.value[p] * yj;
    result.value.push_back(yj);
  }
  return result;
}

std::vector<SparseVector> SparseCholesky::forward(const std::vector<SparseVector>& b) const {
  std::vector<SparseVector> y;
  y.reserve(b.size());
  for (const auto& column : b) y.push_back(forward(column));
  return y;
}

int SparseCholesky::size() const { return implementation_->n; }
double SparseCholesky::factor_entries() const {
  return implementation_->start.empty() ? 0.0 : static_cast<double>(implementation_->start.back());
}
double SparseCholesky::factor_flops() const { return implementation_->flops; }
double SparseCholesky::memory_mb() const {
  return 1e-6 * static_cast<double>(implementation_->row.capacity() * sizeof(int) +
                                    implementation_->value.capacity() * sizeof(double));
}

}  // namespace formwright
