// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The matrix of a Newton step on a bounded QP: the energy, with constraints as springs, in one sparse factorisation.
#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "base/context.h"
#include "numerics/qp/problem/bounded_qp_energy.h"
#include "numerics/qp/problem/bounded_qp_rows.h"
#include "numerics/sparse/sparse_cholesky.h"

namespace formwright::bounded_qp_detail {

/// H = Q + diag(d) + sum_r w_r a_r a_r^T over all order rows, on the unknowns that are not fixed.
///
/// A row couples the few unknowns of two sheets that lie behind each other, so that H stays sparse. It is ordered once
/// for the pattern with every row; bounds and rows come and go as values.
class NewtonMatrix {
 public:
  explicit NewtonMatrix(const Energy& energy) : energy_(energy) {}

  /// Finds the pattern and its order. Does nothing while the unknowns of all rows stay the same.
  void analyze(const Rows& rows, Context& context);
  void forget() { analyzed_ = false; }

  /// `diagonal`: n, >= 0. `spring`: one w >= 0 for each order row. Rows and columns of `fixed` unknowns (n flags)
  /// become those of the identity. Needs analyze for the same rows. Throws Error: could_not_solve (not positive
  /// definite), cancelled, out_of_memory.
  void factorize(const Rows& rows, const Eigen::VectorXd& diagonal, const Eigen::VectorXd& spring,
                 const std::vector<char>& fixed, Context& context);

  /// x = H^-1 b for every column, in place.
  void solve(Eigen::Ref<Eigen::MatrixXd> b) const;

  double factor_flops() const { return factor_.factor_flops(); }
  double factor_entries() const { return factor_.factor_entries(); }
  double memory_mb() const { return factor_.memory_mb() + 20e-6 * static_cast<double>(matrix_.nonZeros()); }

 private:
  const Energy& energy_;
  bool analyzed_ = false;
  std::vector<int> row_unknowns_;  // of all rows, one behind the other: what the pattern was made for
  SparseMatrix matrix_;            // lower triangle
  std::vector<int> energy_place_;  // where each entry of Q's rows lies in matrix_ (right of the diagonal: -1)
  std::vector<std::size_t> row_first_;
  std::vector<int> row_place_;  // where each product of a row's unknowns lies, lower triangle of the row's block
  SparseCholesky factor_;
};

}  // namespace formwright::bounded_qp_detail
