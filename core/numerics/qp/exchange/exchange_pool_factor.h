// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The linear systems of a pool's QP, one active set after the other:
//
//   (S'_AA + D) y + B_A w = f,   B_A^T y - (P + E) w = balance,    y = 0 off A,
//
// with S'_AA + D = L L^T grown row by row. Rows that leave the active set stay in L and are held at y = 0 by a
// border, so that a step that changes few rows costs few solves with L; once the border has grown, L is made anew.
#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <functional>
#include <span>
#include <vector>

namespace formwright::bounded_qp_detail {

class PoolFactor {
 public:
  /// Writes the entries (a, b) of S' for all a in `rows` to `out`.
  using Gram = std::function<void(int b, std::span<const int> rows, double* out)>;

  /// `row_diagonal`: of S'; D = proximal * row_diagonal. `B`: rows x drivers. `P`: drivers x drivers, with E.
  /// All must outlive the object.
  PoolFactor(Gram gram, const Eigen::VectorXd& row_diagonal, const Eigen::MatrixXd& B, const Eigen::MatrixXd& P);

  /// Forgets everything; `proximal` is raised when a factorisation needs it.
  void restart(int rows, double proximal);

  /// More rows have come behind the others, which have not changed.
  void add_rows(int count) { place_.resize(place_.size() + static_cast<std::size_t>(count), -1); }

  /// Makes `active` (flags of all rows) the active set.
  /// Throws Error: could_not_solve (rows in contact that are numerically equal).
  void set_active(const std::vector<char>& active);

  /// f: rows (only those active are read); y: rows, zero where inactive; w: drivers.
  void solve(const Eigen::VectorXd& f, const Eigen::VectorXd& balance, Eigen::VectorXd& y, Eigen::VectorXd& w) const;

  double proximal() const { return proximal_; }

  /// Multiplications so far, about: the same number on every machine. Those of products of a matrix and a vector count
  /// five times, because they wait for memory.
  double work() const { return work_; }

  /// By how much round-off in y may have grown because of rows that are held at y = 0 by the border; at least 1.
  double cancellation() const { return cancellation_; }

 private:
  void compact(const std::vector<char>& active, int valid);
  bool grow(int from);
  bool update_border(const std::vector<char>& active, int old_size);
  void factor_border();
  int size() const { return static_cast<int>(order_.size()); }

  Gram gram_;
  const Eigen::VectorXd& row_diagonal_;
  const Eigen::MatrixXd& B_;
  const Eigen::MatrixXd& P_;
  double proximal_ = 0, cancellation_ = 1;
  mutable double work_ = 0;
  std::vector<int> order_;     // rows in L
  std::vector<int> place_;     // of every row in order_, or -1
  std::vector<int> dropped_;   // places in L of rows held at y = 0, one column of U_ each
  Eigen::MatrixXd L_, V_, U_;  // V = L^-1 B_A, U = L^-1 E_dropped
  Eigen::LLT<Eigen::MatrixXd> border_;
};

}  // namespace formwright::bounded_qp_detail
