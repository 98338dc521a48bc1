// SPDX-License-Identifier: GPL-3.0-or-later
#include "numerics/qp/exchange/exchange_columns.h"

#include <algorithm>

#include "base/index.h"
#include "base/parallel.h"

namespace formwright::bounded_qp_detail {

namespace {
constexpr int panel_height = 64;
constexpr std::size_t strands = 8;  // partial Gram sums; fixed, so that the sum does not depend on the threads

using Block = Eigen::Map<const Eigen::MatrixXd>;
}  // namespace

void ExchangeColumns::reset(int n) {
  n_ = n;
  count_ = 0;
  panels_.assign(index((n + panel_height - 1) / panel_height), {});
  gram_.resize(0, 0);
}

void ExchangeColumns::append(std::span<const SparseVector> columns, Context& context) {
  const int before = count_, added = static_cast<int>(columns.size());
  if (added == 0) return;
  for (int c = 0; c < added; ++c) {
    const SparseVector& y = columns[index(c)];
    // The columns of L on its path are about as long on average as half of the path is.
    const auto path = static_cast<double>(y.index.size());
    work_ += 0.25 * path * path;
    for (std::size_t p = 0; p < y.index.size();) {
      const int number = y.index[p] / panel_height;
      Panel& panel = panels_[index(number)];
      panel.column.push_back(before + c);
      panel.value.resize(panel.value.size() + index(panel_height), 0.0);
      double* value = panel.value.data() + panel.value.size() - panel_height;
      for (; p < y.index.size() && y.index[p] / panel_height == number; ++p)
        value[y.index[p] - number * panel_height] = y.value[p];
    }
  }
  count_ = before + added;
  if (gram_.rows() < count_) {
    const Eigen::Index capacity = std::max<Eigen::Index>(count_, 2 * gram_.rows());
    Eigen::MatrixXd larger(capacity, capacity);
    larger.topLeftCorner(before, before) = gram_.topLeftCorner(before, before);
    gram_ = std::move(larger);
  }
  context.check_cancelled();

  std::vector<Eigen::MatrixXd> partial(strands);
  parallel_for(strands, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      Eigen::MatrixXd& sum = partial[s];
      sum.setZero(count_, added);
      Eigen::MatrixXd product;
      for (std::size_t k = s; k < panels_.size(); k += strands) {
        const Panel& panel = panels_[k];
        const auto first_new = static_cast<Eigen::Index>(
            std::lower_bound(panel.column.begin(), panel.column.end(), before) - panel.column.begin());
        const auto all = static_cast<Eigen::Index>(panel.column.size()), fresh = all - first_new;
        if (fresh == 0) continue;
        const Block Y(panel.value.data(), panel_height, all);
        product.noalias() = Y.transpose() * Y.rightCols(fresh);
        for (Eigen::Index b = 0; b < fresh; ++b) {
          const int column = panel.column[static_cast<std::size_t>(first_new + b)] - before;
          for (Eigen::Index a = 0; a < all; ++a)
            sum(panel.column[static_cast<std::size_t>(a)], column) += product(a, b);
        }
      }
    }
  });
  for (std::size_t s = 1; s < strands; ++s) partial[0] += partial[s];
  for (const Panel& panel : panels_) {
    const auto all = static_cast<double>(panel.column.size());
    const auto fresh =
        static_cast<double>(panel.column.end() - std::lower_bound(panel.column.begin(), panel.column.end(), before));
    work_ += panel_height * all * fresh;
  }
  gram_.block(0, before, count_, added) = partial[0];
  gram_.block(before, 0, added, before) = partial[0].topRows(before).transpose();
}

void ExchangeColumns::keep(std::span<const int> columns) {
  std::vector<int> place(index(count_), -1);
  for (std::size_t k = 0; k < columns.size(); ++k) place[index(columns[k])] = static_cast<int>(k);
  for (Panel& panel : panels_) {
    std::size_t kept = 0;
    for (std::size_t c = 0; c < panel.column.size(); ++c) {
      if (place[index(panel.column[c])] < 0) continue;
      panel.column[kept] = place[index(panel.column[c])];
      if (kept != c)
        std::copy_n(panel.value.data() + c * panel_height, panel_height, panel.value.data() + kept * panel_height);
      ++kept;
    }
    panel.column.resize(kept);
    panel.value.resize(kept * panel_height);
    panel.value.shrink_to_fit();
  }
  const auto kept = static_cast<Eigen::Index>(columns.size());
  Eigen::MatrixXd smaller(kept, kept);
  for (Eigen::Index b = 0; b < kept; ++b) {
    for (Eigen::Index a = 0; a < kept; ++a) {
      smaller(a, b) = gram_(columns[static_cast<std::size_t>(a)], columns[static_cast<std::size_t>(b)]);
    }
  }
  gram_ = std::move(smaller);
  count_ = static_cast<int>(kept);
}

Eigen::VectorXd ExchangeColumns::combine(const Eigen::VectorXd& x) const {
  Eigen::VectorXd z = Eigen::VectorXd::Zero(n_);
  parallel_for(panels_.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const Panel& panel = panels_[k];
      Eigen::Matrix<double, panel_height, 1> sum = Eigen::Matrix<double, panel_height, 1>::Zero();
      for (std::size_t c = 0; c < panel.column.size(); ++c) {
        const double weight = x[panel.column[c]];
        if (weight == 0) continue;
        sum += weight * Eigen::Map<const Eigen::Matrix<double, panel_height, 1>>(panel.value.data() + c * panel_height);
      }
      const auto first = static_cast<Eigen::Index>(k) * panel_height;
      const Eigen::Index rows = std::min<Eigen::Index>(panel_height, n_ - first);
      z.segment(first, rows) = sum.head(rows);
    }
  });
  return z;
}

Eigen::VectorXd ExchangeColumns::project(const Eigen::VectorXd& z) const {
  std::vector<Eigen::VectorXd> partial(strands, Eigen::VectorXd::Zero(count_));
  parallel_for(strands, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      for (std::size_t k = s; k < panels_.size(); k += strands) {
        const Panel& panel = panels_[k];
        const auto first = static_cast<Eigen::Index>(k) * panel_height;
        const Eigen::Index rows = std::min<Eigen::Index>(panel_height, n_ - first);
        for (std::size_t c = 0; c < panel.column.size(); ++c) {
          const Eigen::Map<const Eigen::VectorXd> y(panel.value.data() + c * panel_height, rows);
          partial[s][panel.column[c]] += y.dot(z.segment(first, rows));
        }
      }
    }
  });
  for (std::size_t s = 1; s < strands; ++s) partial[0] += partial[s];
  return partial[0];
}

double ExchangeColumns::memory_mb() const {
  double bytes = static_cast<double>(gram_.size()) * 8;
  for (const Panel& panel : panels_) {
    bytes += static_cast<double>(panel.column.capacity() * sizeof(int) + panel.value.capacity() * sizeof(double) +
                                 sizeof(Panel));
  }
  return 1e-6 * bytes;
}

}  // namespace formwright::bounded_qp_detail
