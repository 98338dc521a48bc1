// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Closer to the eye than eq. (3.13): true normals, with that energy as the price of new creases.
//
//   minimise   N(u) + beta E(u) / E0     over u within bounds
//
// N is NormalTerm, E the energy of eq. (3.13), E0 its value at the relief that is to be improved.
// beta falls step by step. Every step is one of a primal-dual interior point method (Nocedal and Wright 2006,
// Alg. 19.1) with Gauss and Newton's Hessian of N: it keeps the pattern of Q, so that each costs one numerical
// factorisation.
#include <array>
#include <vector>

#include "base/context.h"
#include "numerics/sparse/sparse_cholesky.h"
#include "relief/normal_term.h"

namespace formwright {

struct BalancedSettings {
  double first_beta = 0.3, last_beta = 0.003;  // 0 at the end: normals alone, without a price on creases
  double first_gap = 0.1, gap = 1e-3;          // of N at the start: what the barrier may cost first and at the end
  double decrease = 1e-3;                      // of N at the start: the iteration ends when a step promises less
  int max_steps = 60;
};

struct BalancedResult {
  Eigen::VectorXd u;                          // n, within the bounds exactly
  double objective = 0, start_objective = 0;  // at the last beta
  int steps = 0;
  bool converged = false;
};

class BalancedSolver {
 public:
  /// `lower_Q`: lower triangle of Q with E(u) = u^T Q u, every diagonal entry stored. Orders the rows for factoring.
  /// `painted_weight`: as NormalTerm has it. Throws Error: cancelled, out_of_memory.
  BalancedSolver(const ViewFrame& frame, const Triangles& F, const Visibility& visibility, SparseMatrix lower_Q,
                 Context& context, const Eigen::VectorXd& painted_weight = {});

  /// `start` (n): strictly within `lower` and `upper` (n), which are -inf / +inf where free. `energy_unit`: E0 > 0.
  /// Throws Error: could_not_solve, cancelled, out_of_memory.
  BalancedResult solve(const Eigen::VectorXd& start, double energy_unit, const Eigen::VectorXd& lower,
                       const Eigen::VectorXd& upper, const BalancedSettings& settings, Context& context);

  /// E = u^T Q u, of differences.
  double energy(const Eigen::VectorXd& u) const { return 0.5 * u.dot(energy_gradient(u)); }
  /// N + beta E / E0.
  double objective(const Eigen::VectorXd& u, double beta, double energy_unit) const;
  const NormalTerm& normals() const { return normals_; }
  double memory_mb() const;

 private:
  Eigen::VectorXd energy_gradient(const Eigen::VectorXd& u) const;  // 2 Q u, of differences: constants give zero

  /// matrix_ = scale Q + the faces' Hessians + diagonal.
  void load(double scale, const std::vector<NormalTerm::FaceModel>& faces, const Eigen::VectorXd& diagonal);

  NormalTerm normals_;
  SparseMatrix Q_, matrix_;               // lower triangles on one pattern; the second is what is factored
  std::vector<std::array<int, 6>> slot_;  // of each counted face: where its Hessian lies in the pattern
  SparseCholesky factor_;
};

}  // namespace formwright
