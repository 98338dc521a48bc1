// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The energy of eq. (3.13), E = sum_i w_i^2 A_i |(L D_s x)_i - (L x)_i s_i|^2 with s = lambda / lambda0, in
// the depth parameter u of ViewFrame. Because L annihilates constants and s_j - s_i = kappa (u_j - u_i),
//
//   (L D_s x)_i - (L x)_i s_i = sum_j L_ij (u_j - u_i) (e_z + kappa p_j)
//
// holds without cancellation for every kappa, and kappa = 0 is the orthographic limit. E is the same number
// as in the thesis, free of units: it does not change with the scale of the model.
#include "numerics/sparse/sparse_cholesky.h"
#include "relief/view/view_frame.h"

namespace formwright {

class AppearanceEnergy {
 public:
  /// `weights` (n): w_i of eq. (3.13). Keeps a copy of what it needs.
  /// The Laplacian is the cotangent one, clamped (METHODS 1), with mixed Voronoi areas.
  AppearanceEnergy(const ViewFrame& frame, const Triangles& F, const Eigen::VectorXd& weights);

  /// E(u); exact to round-off relative to its own size, unlike u^T Q u near u = const.
  double operator()(const Eigen::VectorXd& u) const;

  /// Lower triangle of Q with E(u) = u^T Q u. The diagonal is always stored.
  SparseMatrix lower_hessian(Context& context) const;

 private:
  Positions rays_;                      // e_z + kappa p_j, n x 3
  Eigen::VectorXd row_weight_;          // w_i^2 / A_i
  std::vector<int> ring_start_, ring_;  // one-ring of each vertex, compressed
  std::vector<double> ring_weight_;     // cotangent weight of each ring entry
  Positions star_sum_;                  // sum_j weight_ij ray_j
};

}  // namespace formwright
