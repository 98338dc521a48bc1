// SPDX-License-Identifier: GPL-3.0-or-later
#include "numerics/qp/interior_point/newton_matrix.h"

#include <algorithm>

#include "base/index.h"

namespace formwright::bounded_qp_detail {

void NewtonMatrix::analyze(const Rows& rows, Context& context) {
  const std::vector<InequalityRow>& order = rows.constraints().rows;
  std::vector<int> unknowns;
  std::vector<std::size_t> first{0};
  for (const InequalityRow& row : order) {
    unknowns.insert(unknowns.end(), row.index.begin(), row.index.end());
    first.push_back(unknowns.size());
  }
  if (analyzed_ && unknowns == row_unknowns_ && matrix_.rows() == energy_.size()) return;
  analyzed_ = false;
  row_unknowns_ = std::move(unknowns);

  const int n = energy_.size();
  // Column by column: the entries of Q, then those of the rows that the column's unknown is in.
  std::vector<std::vector<int>> below(index(n));
  for (std::size_t r = 0; r + 1 < first.size(); ++r) {
    for (std::size_t a = first[r]; a < first[r + 1]; ++a) {
      for (std::size_t b = first[r]; b < a; ++b) {
        const int i = std::max(row_unknowns_[a], row_unknowns_[b]), j = std::min(row_unknowns_[a], row_unknowns_[b]);
        if (i != j) below[index(j)].push_back(i);
      }
    }
  }
  context.check_cancelled();
  std::vector<int> start{0}, entries;
  for (int j = 0; j < n; ++j) {
    std::vector<int>& column = below[index(j)];
    for (const int i : energy_.neighbours(j)) {
      if (i > j) column.push_back(i);
    }
    std::sort(column.begin(), column.end());
    column.erase(std::unique(column.begin(), column.end()), column.end());
    entries.push_back(j);
    entries.insert(entries.end(), column.begin(), column.end());
    start.push_back(static_cast<int>(entries.size()));
    column = {};
  }
  matrix_.resize(n, n);
  matrix_.resizeNonZeros(static_cast<Eigen::Index>(entries.size()));
  std::copy(start.begin(), start.end(), matrix_.outerIndexPtr());
  std::copy(entries.begin(), entries.end(), matrix_.innerIndexPtr());
  std::fill_n(matrix_.valuePtr(), entries.size(), 1.0);

  const auto place = [&](int i, int j) {
    const auto begin = entries.begin() + start[index(j)], end = entries.begin() + start[index(j) + 1];
    return static_cast<int>(std::lower_bound(begin, end, i) - entries.begin());
  };
  energy_place_.clear();
  for (int j = 0; j < n; ++j) {
    for (const int i : energy_.neighbours(j)) energy_place_.push_back(i > j ? place(i, j) : -1);
  }
  row_first_.assign(1, 0);
  row_place_.clear();
  for (std::size_t r = 0; r + 1 < first.size(); ++r) {
    for (std::size_t a = first[r]; a < first[r + 1]; ++a) {
      for (std::size_t b = first[r]; b <= a; ++b) {
        const int i = std::max(row_unknowns_[a], row_unknowns_[b]), j = std::min(row_unknowns_[a], row_unknowns_[b]);
        row_place_.push_back(place(i, j));
      }
    }
    row_first_.push_back(row_place_.size());
  }
  factor_.analyze(matrix_, {}, context);
  analyzed_ = true;
}

void NewtonMatrix::factorize(const Rows& rows, const Eigen::VectorXd& diagonal, const Eigen::VectorXd& spring,
                             const std::vector<char>& fixed, Context& context) {
  const int n = energy_.size();
  double* value = matrix_.valuePtr();
  std::fill_n(value, matrix_.nonZeros(), 0.0);
  std::size_t entry = 0;
  for (int j = 0; j < n; ++j) {
    const auto neighbours = energy_.neighbours(j);
    const auto values = energy_.values(j);
    for (std::size_t k = 0; k < neighbours.size(); ++k, ++entry) {
      const int p = energy_place_[entry];
      if (p >= 0 && !fixed[index(j)] && !fixed[index(neighbours[k])]) value[p] = values[k];
    }
    value[matrix_.outerIndexPtr()[j]] = fixed[index(j)] ? 1.0 : energy_.diagonal(j) + diagonal[j];
  }
  const std::vector<InequalityRow>& order = rows.constraints().rows;
  for (std::size_t r = 0; r < order.size(); ++r) {
    const double w = spring[static_cast<Eigen::Index>(r)];
    if (!(w > 0)) continue;
    const InequalityRow& row = order[r];
    const int* p = row_place_.data() + row_first_[r];
    for (std::size_t a = 0; a < row.index.size(); ++a) {
      for (std::size_t b = 0; b <= a; ++b, ++p) {
        if (fixed[index(row.index[a])] || fixed[index(row.index[b])]) continue;
        // An unknown named twice in a row meets itself twice on the diagonal.
        const double twice = a != b && row.index[a] == row.index[b] ? 2 : 1;
        value[*p] += twice * w * row.coefficient[a] * row.coefficient[b];
      }
    }
  }
  factor_.factorize(matrix_, context);
}

void NewtonMatrix::solve(Eigen::Ref<Eigen::MatrixXd> b) const { factor_.solve(b); }

}  // namespace formwright::bounded_qp_detail
