// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Convex quadratic programs with bounds: eqs. (3.11)-(3.14) of the thesis after a change of variables.
//
//   minimise   1/2 u^T Q u                                   u in R^n, m in R^groups
//   subject to lower_i + lower_slope_i m_g(i) <= u_i <= upper_i + upper_slope_i m_g(i)
//              sum_k coefficient_k u_index_k + slope m_g >= bound           for every order row
//              sum_i gauge_i u_i = 0                                       (fixes the free scale)
//
// Q is symmetric positive semidefinite; its null space is spanned by the constants on each component.
#include <memory>
#include <vector>

#include "base/context.h"
#include "numerics/qp/problem/bounded_qp_problem.h"
#include "numerics/sparse/sparse_cholesky.h"

namespace formwright {

/// Keeps the factorisation of Q: solves for other bounds do not factor again.
class BoundedQp {
 public:
  BoundedQp();
  ~BoundedQp();
  BoundedQp(BoundedQp&&) noexcept;
  BoundedQp& operator=(BoundedQp&&) noexcept;

  /// `lower_Q`: lower triangle of Q. `component`: n, the connected part of each unknown, 0-based.
  /// `positions`: n x 3 hint for the ordering. Factors once.
  void set_energy(const SparseMatrix& lower_Q, std::vector<int> component, const Positions& positions,
                  Context& context);

  /// Warm-started from the previous active set when there is one of the same size. The work is limited, and the limit
  /// counts operations, not seconds, so that results are the same everywhere: where the optimum is not found within it,
  /// the best point is returned with its `relative_gap`.
  /// Throws Error: could_not_solve (infeasible), cancelled, out_of_memory.
  BoundedQpSolution solve(const BoundedQpConstraints& constraints, const BoundedQpOptions& options, Context& context);

  double memory_mb() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace formwright
