// SPDX-License-Identifier: GPL-3.0-or-later
#include "numerics/qp/problem/bounded_qp_energy.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/error.h"
#include "base/index.h"
#include "base/parallel.h"

namespace formwright::bounded_qp_detail {

namespace {
constexpr std::size_t rows_per_chunk = 4096;
constexpr double row_sum_tolerance = 1e-6;  // of the row's absolute sum: round-off of a sane assembly is 1e-13

}  // namespace

void Energy::set(const SparseMatrix& lower_Q, std::vector<int> component, const Positions& positions,
                 std::span<const int> pins, Context& context) {
  if (lower_Q.rows() != lower_Q.cols())
    throw Error(ErrorCode::invalid_input, "lower_Q", "The energy must be a square matrix.");
  n_ = static_cast<int>(lower_Q.rows());
  if (component.size() != index(n_)) {
    throw Error(ErrorCode::invalid_input, "component",
                "Give the component of each of the " + std::to_string(n_) + " unknowns.");
  }
  pinned_ = false;
  component_ = std::move(component);
  lower_ = lower_Q;
  lower_.makeCompressed();
  lower_values_.assign(lower_.valuePtr(), lower_.valuePtr() + lower_.nonZeros());

  std::vector<double> row_absolute(index(n_), 0.0);
  Eigen::VectorXd stored_diagonal = Eigen::VectorXd::Zero(n_);
  start_.assign(index(n_) + 1, 0);
  for (int j = 0; j < n_; ++j) {
    bool has_diagonal = false;
    for (SparseMatrix::InnerIterator it(lower_, j); it; ++it) {
      const int i = static_cast<int>(it.row());
      if (i < j)
        throw Error(ErrorCode::invalid_input, "lower_Q", "Only the lower triangle of the energy may be stored.");
      if (!std::isfinite(it.value()))
        throw Error(ErrorCode::invalid_input, "lower_Q", "The matrix of the energy holds a value that is not finite.");
      if (i == j) {
        has_diagonal = true;
        stored_diagonal[i] = it.value();
        continue;
      }
      if (component_[index(i)] != component_[index(j)]) {
        throw Error(ErrorCode::invalid_input, "component", "The energy couples two components: give them one number.");
      }
      ++start_[index(i) + 1];
      ++start_[index(j) + 1];
    }
    if (!has_diagonal)
      throw Error(ErrorCode::invalid_input, "lower_Q", "Store every diagonal entry of the energy, zero or not.");
  }
  for (std::size_t i = 0; i < index(n_); ++i) start_[i + 1] += start_[i];
  index_.resize(index(start_.back()));
  value_.resize(index_.size());
  std::vector<int> fill(start_.begin(), start_.end() - 1);
  // Two sweeps keep every row sorted: first the entries left of the diagonal, column by column, then those right of it.
  for (int j = 0; j < n_; ++j) {
    for (SparseMatrix::InnerIterator it(lower_, j); it; ++it) {
      const int i = static_cast<int>(it.row());
      if (i == j) continue;
      const std::size_t p = index(fill[index(i)]++);
      index_[p] = j;
      value_[p] = it.value();
    }
  }
  for (int j = 0; j < n_; ++j) {
    for (SparseMatrix::InnerIterator it(lower_, j); it; ++it) {
      const int i = static_cast<int>(it.row());
      if (i == j) continue;
      const std::size_t p = index(fill[index(j)]++);
      index_[p] = i;
      value_[p] = it.value();
    }
  }
  diagonal_.resize(n_);
  absolute_sum_ = 0;
  for (int i = 0; i < n_; ++i) {
    double sum = 0, absolute = 0;
    for (int p = start_[index(i)]; p < start_[index(i) + 1]; ++p) {
      sum += value_[index(p)];
      absolute += std::abs(value_[index(p)]);
    }
    if (std::abs(stored_diagonal[i] + sum) > row_sum_tolerance * std::max(absolute, std::abs(stored_diagonal[i]))) {
      throw Error(ErrorCode::invalid_input, "lower_Q",
                  "Row " + std::to_string(i) + " of the energy does not add up to zero: constants must cost nothing.");
    }
    diagonal_[i] = -sum;
    absolute_sum_ += absolute;
  }
  choose_pins(pins);
  factor_.analyze(lower_, positions, context);
}

void Energy::choose_pins(std::span<const int> pins) {
  int count = 0;
  for (const int k : component_) {
    if (k < 0 || k >= n_)
      throw Error(ErrorCode::invalid_input, "component",
                  "The components of a quadratic program must be numbered from 0.");
    count = std::max(count, k + 1);
  }
  component_size_.assign(index(count), 0);
  for (const int k : component_) ++component_size_[index(k)];
  for (const int size : component_size_) {
    if (size == 0)
      throw Error(ErrorCode::invalid_input, "component",
                  "The components of a quadratic program must be numbered without gaps.");
  }
  pin_.assign(index(count), -1);
  if (!pins.empty()) {
    for (const int i : pins) pin_[index(component_[index(i)])] = i;
    return;
  }
  // The unknown of median stiffness: neither a sliver nor a stray point. Any other gives the same result.
  std::vector<std::vector<int>> members(index(count));
  for (int i = 0; i < n_; ++i) members[index(component_[index(i)])].push_back(i);
  for (std::size_t k = 0; k < members.size(); ++k) {
    auto middle = members[k].begin() + static_cast<std::ptrdiff_t>(members[k].size() / 2);
    std::nth_element(members[k].begin(), middle, members[k].end(),
                     [&](int a, int b) { return diagonal_[a] != diagonal_[b] ? diagonal_[a] < diagonal_[b] : a < b; });
    pin_[k] = *middle;
  }
}

Eigen::VectorXd Energy::apply(const Eigen::VectorXd& u) const {
  Eigen::VectorXd result(n_);
  parallel_for(index(n_), rows_per_chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const double ui = u[static_cast<Eigen::Index>(i)];
      double sum = 0;
      for (std::size_t p = index(start_[i]); p < index(start_[i + 1]); ++p) sum += value_[p] * (u[index_[p]] - ui);
      result[static_cast<Eigen::Index>(i)] = sum;
    }
  });
  return result;
}

double Energy::energy(const Eigen::VectorXd& u) const {
  // Deviations from each component's mean keep the sum free of cancellation against a large constant.
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(component_count());
  for (int i = 0; i < n_; ++i) mean[component(i)] += u[i] / component_size_[index(component(i))];
  const Eigen::VectorXd force = apply(u);
  double sum = 0;
  for (int i = 0; i < n_; ++i) sum += force[i] * (u[i] - mean[component(i)]);
  return 0.5 * sum;
}

std::span<const int> Energy::neighbours(int i) const {
  return {index_.data() + start_[index(i)], index_.data() + start_[index(i) + 1]};
}
std::span<const double> Energy::values(int i) const {
  return {value_.data() + start_[index(i)], value_.data() + start_[index(i) + 1]};
}

void Energy::factorize_pinned(const std::vector<char>& base, Context& context) {
  if (pinned_ && base == base_) return;
  base_ = base;
  fixed_.assign(index(n_), 0);
  free_constant_.assign(pin_.size(), 1);
  for (std::size_t i = 0; i < base.size(); ++i) {
    if (!base[i]) continue;
    fixed_[i] = 1;
    free_constant_[index(component_[i])] = 0;
  }
  for (std::size_t k = 0; k < pin_.size(); ++k) {
    if (free_constant_[k]) fixed_[index(pin_[k])] = 1;
  }
  load(nullptr);
  factor_.factorize(lower_, context);
  pinned_ = true;
}

void Energy::factorize_shifted(const Eigen::VectorXd& shift, const std::vector<char>& fixed, Context& context) {
  fixed_ = fixed;
  load(&shift);
  factor_.factorize(lower_, context);
}

// Writes the matrix to factor: Q (+ shift) with the rows and columns of fixed unknowns replaced by those of the
// identity.
void Energy::load(const Eigen::VectorXd* shift) {
  pinned_ = false;
  double* value = lower_.valuePtr();
  for (int j = 0; j < n_; ++j) {
    for (int p = lower_.outerIndexPtr()[j]; p < lower_.outerIndexPtr()[j + 1]; ++p) {
      const int i = lower_.innerIndexPtr()[p];
      if (i == j) value[p] = fixed(i) ? 1.0 : diagonal_[i] + (shift ? (*shift)[i] : 0.0);
      else value[p] = fixed(i) || fixed(j) ? 0.0 : lower_values_[index(p)];
    }
  }
}

double Energy::memory_mb() const {
  const double entries = static_cast<double>(index_.capacity()), lower = static_cast<double>(lower_.nonZeros());
  return factor_.memory_mb() + 1e-6 * (entries * 12 + lower * 20 + static_cast<double>(n_) * 24);
}

}  // namespace formwright::bounded_qp_detail
