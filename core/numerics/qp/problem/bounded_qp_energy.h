// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The quadratic form of a bounded QP: Q, its graph, its null space and one factorisation at a time.
#include <Eigen/Core>
#include <span>
#include <vector>

#include "base/context.h"
#include "numerics/sparse/sparse_cholesky.h"

namespace formwright::bounded_qp_detail {

/// Q with a nonsingular stand-in.
///
/// Q is singular: constants on a component cost nothing. Take one unknown p (the pin) of each component
/// out of the factorisation and write u = v + sum_k c_k 1_k with v_p = 0; the constants c_k become unknowns
/// of the small dense problem, which asks for their stationarity, 1_k^T f = 0, f all forces on u.
/// This changes nothing: rows i != p of Q v = f hold by construction, and because the columns of Q add up
/// to zero, (Q v)_p = -sum_{i != p} (Q v)_i = -sum_{i != p} f_i = f_p. The pin carries no force of its own,
/// so no point load enters, whichever unknown is chosen.
///
/// A base (see `factorize`) takes further unknowns out, those held at their bounds.
class Energy {
 public:
  /// `pins`: one unknown per component, or empty to let the class choose.
  /// Throws Error: invalid_input (sizes, NaN, rows that do not sum to zero), out_of_memory, cancelled.
  void set(const SparseMatrix& lower_Q, std::vector<int> component, const Positions& positions,
           std::span<const int> pins, Context& context);

  int size() const { return n_; }
  int component_count() const { return static_cast<int>(pin_.size()); }
  int component(int i) const { return component_[static_cast<std::size_t>(i)]; }
  const std::vector<int>& component_sizes() const { return component_size_; }
  int pin(int k) const { return pin_[static_cast<std::size_t>(k)]; }

  /// Q u, written with differences, sum_j q_ij (u_j - u_i): constants give exactly zero.
  Eigen::VectorXd apply(const Eigen::VectorXd& u) const;
  double energy(const Eigen::VectorXd& u) const;  // 1/2 u^T Q u in the same way
  double largest_stiffness() const { return diagonal_.size() > 0 ? diagonal_.maxCoeff() : 0; }
  double absolute_sum() const { return absolute_sum_; }  // sum |q_ij|, i != j

  /// Column i of Q: indices and values of the whole symmetric matrix, diagonal included.
  std::span<const int> neighbours(int i) const;
  std::span<const double> values(int i) const;
  double diagonal(int i) const { return diagonal_[i]; }

  /// Factors Q with the pins and the unknowns of `base` (n flags, or empty) replaced by unit rows.
  /// A component with a base unknown needs no pin. Does nothing when that is what is factored already.
  void factorize_pinned(const std::vector<char>& base, Context& context);
  /// Factors Q + diag(d), d >= 0, with the flagged unknowns replaced by unit rows (interior point).
  void factorize_shifted(const Eigen::VectorXd& diagonal, const std::vector<char>& fixed, Context& context);
  /// Whether unknown i is taken out of the current pinned factorisation.
  bool fixed(int i) const { return fixed_[static_cast<std::size_t>(i)] != 0; }
  /// True when component k is held by its pin alone, so that its constant is free.
  bool free_constant(int k) const { return free_constant_[static_cast<std::size_t>(k)] != 0; }

  const SparseCholesky& factor() const { return factor_; }
  double memory_mb() const;

 private:
  void load(const Eigen::VectorXd* shift);
  void choose_pins(std::span<const int> pins);

  int n_ = 0;
  SparseMatrix lower_;                // as given; its values are overwritten by the matrix to factor
  std::vector<double> lower_values_;  // the values as given
  std::vector<int> start_, index_;    // the whole symmetric pattern without the diagonal, by rows
  std::vector<double> value_;
  Eigen::VectorXd diagonal_;  // minus the sum of the row's other entries
  double absolute_sum_ = 0;
  std::vector<int> component_, component_size_, pin_;
  std::vector<char> base_, fixed_, free_constant_;
  bool pinned_ = false;  // what is factored is Q with base_ and the pins taken out
  SparseCholesky factor_;
};

}  // namespace formwright::bounded_qp_detail
