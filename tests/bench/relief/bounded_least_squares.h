// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// minimise |rows u + constant|^2 over lower <= u <= upper and order u >= order_bound, by Mehrotra's predictor and
// corrector (Nocedal and Wright 2006, Alg. 16.4). BoundedQp has no linear term and moves its bounds with a common
// scale, which a form that depends on the scale forbids.
#include <utility>

#include "base/context.h"
#include "bench/relief/energy_forms.h"
#include "numerics/sparse/sparse_cholesky.h"

namespace formwright::test {

struct AllowedDepths {
  Eigen::VectorXd lower, upper;  // n
  SparseMatrix order;            // a row for each condition of eq. (3.12), maybe none
  Eigen::VectorXd order_bound;
};

struct BoundedMinimum {
  Eigen::VectorXd u;  // n, within the bounds exactly
  int steps = 0;
  bool converged = false;
};

class BoundedLeastSquares {
 public:
  /// `positions` (n x 3): a hint for the order of elimination.
  explicit BoundedLeastSquares(Positions positions) : positions_(std::move(positions)) {}

  /// Energies of one pattern share the order of elimination.
  /// Throws Error: could_not_solve, cancelled, out_of_memory.
  BoundedMinimum minimise(const LeastSquares& energy, const AllowedDepths& allowed, Context& context);

 private:
  Positions positions_;
  SparseCholesky factor_;
  Eigen::Index entries_ = 0;  // of the pattern that was analysed
};

}  // namespace formwright::test
