// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The columns y_j = L^-1 P g_j of an exchange, and their Gram matrix S = Y^T Y.
#include <Eigen/Core>
#include <span>
#include <vector>

#include "base/context.h"
#include "numerics/sparse/sparse_cholesky.h"

namespace formwright::bounded_qp_detail {

/// A column is nonzero along elimination-tree paths only, which all end in the same top of the tree. The
/// elimination order is cut into panels of equal height; a panel keeps a dense block of those columns that
/// reach it, so that all products run over contiguous memory: near the root as one matrix product, near the
/// leaves over the few columns that share the subtree.
class ExchangeColumns {
 public:
  void reset(int n);

  /// Appends columns (indices in elimination order) and extends the Gram matrix.
  void append(std::span<const SparseVector> columns, Context& context);
  /// Keeps the listed columns (ascending), renumbered in that order.
  void keep(std::span<const int> columns);

  int count() const { return count_; }
  /// S, leading `count` rows and columns.
  Eigen::Block<const Eigen::MatrixXd> gram() const { return gram_.topLeftCorner(count_, count_); }

  /// sum_j x_j y_j, dense, in elimination order.
  Eigen::VectorXd combine(const Eigen::VectorXd& x) const;
  /// Y^T z.
  Eigen::VectorXd project(const Eigen::VectorXd& z) const;

  /// Multiplications so far, about: the same number on every machine.
  double work() const { return work_; }
  double memory_mb() const;

 private:
  struct Panel {
    std::vector<int> column;    // ascending
    std::vector<double> value;  // panel height x columns, by columns
  };
  int n_ = 0, count_ = 0;
  std::vector<Panel> panels_;
  Eigen::MatrixXd gram_;
  double work_ = 0;
};

}  // namespace formwright::bounded_qp_detail
