// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Interior point for many contacts: Mehrotra's predictor and corrector (Mehrotra 1992; Nocedal and Wright 2006,
// Alg. 16.4) on all bounds and all order rows at once, which lie inside the sparse factorisation of NewtonMatrix.
#include <Eigen/Core>
#include <vector>

#include "base/context.h"
#include "numerics/qp/problem/bounded_qp_energy.h"
#include "numerics/qp/problem/bounded_qp_rows.h"
#include "numerics/qp/interior_point/newton_matrix.h"

namespace formwright::bounded_qp_detail {

struct InteriorPointSettings {
  double relative_gap = 1e-10;  // sum of slack times multiplier, of the energy: when to stop
  double violation = 1e-10;     // by how much slacks may miss their rows then
  int max_iterations = 100;
};

/// A point, inside or outside, with what is known of its multipliers.
struct InteriorPointStart {
  Eigen::VectorXd u, m;
  std::vector<RowKey> active;  // rows with multipliers
  Eigen::VectorXd multiplier;
  /// Whether u is the optimum of most of the rows that will hold: it is then mixed into the constraints' own start.
  bool is_near = false;
};

struct InteriorPointResult {
  Eigen::VectorXd u, m;
  Eigen::VectorXd slack_lower, slack_upper, force_lower, force_upper;  // n; 1 and 0 where there is no bound
  Eigen::VectorXd order_slack, order_force;                            // of every order row
  double gauge_force = 0;
  double relative_gap = 0;  // an upper limit of (energy - smallest energy) / energy, once nothing is violated
  double violation = 0;     // by how much slacks miss their rows
  int iterations = 0;
  bool converged = false;
};

/// Throws Error: cancelled, out_of_memory.
InteriorPointResult solve_interior_point(const Energy& energy, NewtonMatrix& matrix, const Rows& rows,
                                         const InteriorPointStart& start, const InteriorPointSettings& settings,
                                         Context& context);

}  // namespace formwright::bounded_qp_detail
