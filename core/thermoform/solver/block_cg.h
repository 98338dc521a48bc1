// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Conjugate gradients for Newton's directions, preconditioned by the blocks on the diagonal.
#include <span>
#include <vector>

#include "thermoform/solver/block_matrix.h"

namespace formwright {

class BlockCg {
 public:
  explicit BlockCg(int vertex_count);

  /// Solves A x = right_side over the vertices `rows` (ascending), all others being 0; stops at
  /// |r| <= tolerance |right_side| in the preconditioner's norm or after `max_iterations`. Returns the iterations
  /// used. `A` is positive definite there; where rounding makes a direction's curvature negative, the last iterate is
  /// kept. The same bits for any number of threads.
  int solve(const BlockMatrix& A, const BlockVector& right_side, std::span<const int> rows, double tolerance,
            int max_iterations, BlockVector& x);

 private:
  BlockVector r_, z_, p_, q_;
  std::vector<std::array<Float4, 3>> inverse_;
  std::vector<double> partial_;  // sums per chunk of rows
};

}  // namespace formwright
