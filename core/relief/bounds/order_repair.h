// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Depth order after a step that knew only a part of the rows.
#include <Eigen/Core>
#include <vector>

#include "numerics/qp/bounded_qp.h"

namespace formwright {

/// Whether what lies behind in a row of eq. (3.12) has a vertex that is `visible` (n): only then the picture has a say
/// in it.
bool visible_behind(const InequalityRow& row, const std::vector<char>& visible);

/// Moves `u` until every row holds and every bound: hidden vertices behind others are pushed back first, which nobody
/// sees; what is left moves on both sides of a row; at last the vertices of rows that still do not hold go to
/// `feasible`, which satisfies rows and bounds. `room`, in units of u: what a row that was closed has to spare, and
/// what one may lack at last. `lower`, `upper` (n): -inf / +inf where free.
void repair_order(const std::vector<InequalityRow>& rows, const std::vector<char>& visible,
                  const Eigen::VectorXd& lower, const Eigen::VectorXd& upper, const Eigen::VectorXd& feasible,
                  double room, Eigen::VectorXd& u);

}  // namespace formwright
