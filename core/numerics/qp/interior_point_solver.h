// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Interior point for many contacts: Mehrotra's predictor and corrector (Mehrotra 1992; Nocedal and Wright 2006,
// Alg. 16.4) on Q + diagonal, which keeps the pattern of Q and so its symbolic factorisation.
#include <Eigen/Core>
#include <span>
#include <vector>

#include "base/context.h"
#include "numerics/qp/bounded_qp_energy.h"
#include "numerics/qp/bounded_qp_rows.h"

namespace formwright::bounded_qp_detail {

struct InteriorPointSettings {
  double relative_gap = 1e-8;  // sum of slack times multiplier, of the energy: when to stop
  int max_iterations = 100;
};

/// A point, inside or outside, with what is known of its multipliers.
struct InteriorPointStart {
  Eigen::VectorXd u, m;
  std::vector<RowKey> active;  // rows with multipliers
  Eigen::VectorXd multiplier;
};

struct InteriorPointResult {
  Eigen::VectorXd u, m;
  Eigen::VectorXd slack_lower, slack_upper, force_lower, force_upper;  // n; 1 and 0 where there is no bound
  std::vector<int> order;                                              // the order rows taken into account
  Eigen::VectorXd order_slack, order_force;
  double gauge_force = 0;
  double relative_gap = 0;
  int iterations = 0;
  bool converged = false;
};

/// Bounds, the gauge and the listed order rows; other order rows are left out. Leaves the energy factored with the last
/// diagonal. Throws Error: could_not_solve, cancelled.
InteriorPointResult solve_interior_point(Energy& energy, const Rows& rows, std::span<const int> order,
                                         const InteriorPointStart& start, const InteriorPointSettings& settings,
                                         Context& context);

}  // namespace formwright::bounded_qp_detail
