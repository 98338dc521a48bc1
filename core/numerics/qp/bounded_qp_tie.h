// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What the energy leaves open.
#include <Eigen/Core>
#include <span>

#include "base/context.h"
#include "numerics/qp/problem/bounded_qp_energy.h"
#include "numerics/qp/problem/bounded_qp_rows.h"

namespace formwright::bounded_qp_detail {

/// The energy fixes u up to a constant on each component, and says nothing of m. Constraints that push (`pushing`:
/// those with a force that matters) tie some of these together; where any freedom is left, moves (u, m) to the
/// feasible optimum that minimises |u|^2 + |m|^2: parts that touch nothing return to where they came from, as far
/// as their bounds allow. Returns the number of free directions. Throws Error: could_not_solve, cancelled.
int break_ties(const Energy& energy, const Rows& rows, std::span<const RowKey> pushing, double tolerance,
               Eigen::VectorXd& u, Eigen::VectorXd& m, Context& context);

}  // namespace formwright::bounded_qp_detail
