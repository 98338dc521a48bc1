// SPDX-License-Identifier: GPL-3.0-or-later
#include "numerics/sparse/sparse_cholesky.h"

#include <algorithm>
#include <cstdint>
#include <new>
#include <string>

#include "base/error.h"
#include "base/parallel.h"
#include "numerics/dense/dense_solves.h"
#include "numerics/sparse/multifrontal.h"
#include "numerics/ordering/nested_dissection.h"
#include "numerics/sparse/triangular_solves.h"

namespace formwright {

struct SparseCholesky::Implementation {
  SupernodalForm form;
  AssemblyMap map;
  SupernodalFactor factor;
  std::uint64_t pattern = 0;  // hash of the analysed pattern
  bool factored = false;

  const double* values() const {
    if (!factored) throw Error(ErrorCode::internal, "matrix", "The matrix must be factorised before solving.");
    return factor.value.get();
  }
};

namespace {

std::uint64_t hash_of_pattern(const SparseMatrix& lower) {
  std::uint64_t hash = 1469598103934665603ull;
  const auto add = [&](const int* data, Eigen::Index count) {
    for (Eigen::Index k = 0; k < count; ++k) hash = (hash ^ static_cast<std::uint64_t>(data[k])) * 1099511628211ull;
  };
  add(lower.outerIndexPtr(), lower.outerSize() + 1);
  add(lower.innerIndexPtr(), lower.nonZeros());
  return hash;
}

void check_lower(const SparseMatrix& lower) {
  if (lower.rows() != lower.cols()) throw Error(ErrorCode::invalid_input, "matrix", "The matrix must be square.");
  for (int j = 0; j < static_cast<int>(lower.cols()); ++j) {
    const SparseMatrix::InnerIterator it(lower, j);
    if (it && it.row() < j) {
      throw Error(ErrorCode::invalid_input, "matrix",
                  "Only the lower triangle may be stored, but column " + std::to_string(j) +
                      " has an entry above the diagonal.");
    }
    if (!it || it.row() != j) {
      throw Error(ErrorCode::invalid_input, "matrix",
                  "The diagonal must be stored, but row " + std::to_string(j) + " has none.");
    }
  }
}

}  // namespace

SparseCholesky::SparseCholesky() : implementation_(std::make_unique<Implementation>()) {
  implementation_->form.first_column.assign(1, 0);
  implementation_->form.first_value.assign(1, 0);
}
SparseCholesky::~SparseCholesky() = default;
SparseCholesky::SparseCholesky(SparseCholesky&&) noexcept = default;
SparseCholesky& SparseCholesky::operator=(SparseCholesky&&) noexcept = default;

void SparseCholesky::analyze(const SparseMatrix& lower, const Positions&, Context& context) {
  if (!lower.isCompressed()) {
    SparseMatrix compressed = lower;
    compressed.makeCompressed();
    return analyze(compressed, Positions(), context);
  }
  check_lower(lower);
  *this = SparseCholesky();
  auto& I = *implementation_;
  context.progress(0, "Ordering");
  const Graph graph = graph_of(lower);
  std::vector<int> order = nested_dissection(graph, {}, context);
  context.progress(0.7, "Ordering");
  I.form = find_supernodes(graph, std::move(order), context);
  context.progress(0.9, "Ordering");
  I.map = map_assembly(lower, graph, I.form);
  I.pattern = hash_of_pattern(lower);
  context.progress(1, "Ordering");
}

void SparseCholesky::factorize(const SparseMatrix& lower, Context& context) {
  if (!lower.isCompressed()) {
    SparseMatrix compressed = lower;
    compressed.makeCompressed();
    return factorize(compressed, context);
  }
  auto& I = *implementation_;
  if (lower.rows() != I.form.n || lower.cols() != I.form.n || hash_of_pattern(lower) != I.pattern) {
    throw Error(ErrorCode::invalid_input, "matrix", "The matrix must have the pattern that was analysed.");
  }
  I.factored = false;
  context.progress(0, "Factorising");
  std::vector<double> diagonal(I.form.n);
  for (int j = 0; j < I.form.n; ++j) diagonal[j] = lower.valuePtr()[lower.outerIndexPtr()[j]];
  factorize_multifrontal(I.form, I.map, lower.valuePtr(), diagonal, I.factor, {}, context);
  I.factored = true;
}

void SparseCholesky::forward(Eigen::Ref<Eigen::VectorXd> b) const {
  const auto& I = *implementation_;
  const double* values = I.values();
  Eigen::VectorXd y(I.form.n);
  for (int k = 0; k < I.form.n; ++k) y[k] = b[I.form.permutation.order[k]];
  forward_solve<1>(I.form, values, y.data());
  b = y;
}

void SparseCholesky::backward(Eigen::Ref<Eigen::VectorXd> y) const {
  const auto& I = *implementation_;
  Eigen::VectorXd x = y;
  backward_solve<1>(I.form, I.values(), x.data());
  for (int k = 0; k < I.form.n; ++k) y[I.form.permutation.order[k]] = x[k];
}

void SparseCholesky::solve(Eigen::Ref<Eigen::MatrixXd> b) const {
  const auto& I = *implementation_;
  const double* values = I.values();
  const auto& order = I.form.permutation.order;
  std::vector<double> y;
  const auto forward_and_backward = [&]<int Sides>() {
    forward_solve<Sides>(I.form, values, y.data());
    backward_solve<Sides>(I.form, values, y.data());
  };
  for (Eigen::Index first = 0; first < b.cols();) {
    const Eigen::Index left = b.cols() - first;
    const Eigen::Index width = left == 1 ? 1 : left <= dense::few_sides ? dense::few_sides : dense::many_sides;
    const Eigen::Index together = std::min(width, left);
    y.assign(static_cast<std::size_t>(I.form.n * width), 0.0);
    for (int k = 0; k < I.form.n; ++k) {
      for (Eigen::Index c = 0; c < together; ++c) y[static_cast<std::size_t>(k * width + c)] = b(order[k], first + c);
    }
    if (width == 1) forward_and_backward.template operator()<1>();
    else if (width == dense::few_sides) forward_and_backward.template operator()<dense::few_sides>();
    else forward_and_backward.template operator()<dense::many_sides>();
    for (int k = 0; k < I.form.n; ++k) {
      for (Eigen::Index c = 0; c < together; ++c) b(order[k], first + c) = y[static_cast<std::size_t>(k * width + c)];
    }
    first += together;
  }
}

SparseVector SparseCholesky::forward(const SparseVector& b) const {
  SparseVector y;
  const SparseVector* source = &b;
  SparseVector* target = &y;
  sparse_forward(implementation_->form, implementation_->values(), {&source, 1}, {&target, 1});
  return y;
}

std::vector<SparseVector> SparseCholesky::forward(const std::vector<SparseVector>& b) const {
  const auto& I = *implementation_;
  const double* values = I.values();
  // Sides that enter the tree close to each other share most of their paths.
  std::vector<std::pair<int, std::size_t>> entry(b.size());
  for (std::size_t k = 0; k < b.size(); ++k) {
    int first = I.form.n;
    for (const int i : b[k].index) first = std::min(first, I.form.permutation.position[i]);
    entry[k] = {first, k};
  }
  std::sort(entry.begin(), entry.end());
  std::vector<SparseVector> y(b.size());
  parallel_for(b.size(), dense::many_sides, [&](std::size_t begin, std::size_t end) {
    std::vector<const SparseVector*> sources;
    std::vector<SparseVector*> targets;
    for (std::size_t k = begin; k < end; ++k) {
      sources.push_back(&b[entry[k].second]);
      targets.push_back(&y[entry[k].second]);
    }
    sparse_forward(I.form, values, sources, targets);
  });
  return y;
}

int SparseCholesky::size() const { return implementation_->form.n; }
double SparseCholesky::factor_entries() const { return implementation_->form.entries; }
double SparseCholesky::factor_flops() const { return implementation_->form.flops; }
double SparseCholesky::memory_mb() const {
  const auto& I = *implementation_;
  const std::size_t values = I.factor.value ? I.form.first_value.back() * sizeof(double) : 0;
  return 1e-6 * static_cast<double>(values + I.form.bytes() + I.map.bytes());
}

}  // namespace formwright
