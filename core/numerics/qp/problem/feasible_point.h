// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// From a point that violates order rows to one that does not.
#include <Eigen/Core>

#include "numerics/qp/problem/bounded_qp_rows.h"

namespace formwright::bounded_qp_detail {

/// Moves u, m in a straight line towards the starting point of the constraints, as little as its order rows ask, and
/// into the bounds. Nothing moves when no row is violated or that point violates rows itself.
void move_inside(const Rows& rows, Eigen::VectorXd& u, Eigen::VectorXd& m);

}  // namespace formwright::bounded_qp_detail
