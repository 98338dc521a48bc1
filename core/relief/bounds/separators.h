// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Depth order as bounds. A row of eq. (3.12) couples two sheets that no entry of the energy couples; in the interior
// point method it would either fill the factor or, bounded by a diagonal, hold up every step. Bounds on either side of
// a depth between the two sheets imply it and cost nothing.
#include <Eigen/Core>
#include <vector>

#include "numerics/qp/bounded_qp.h"

namespace formwright {

enum class Separator : char { none, between, behind };

/// Tightens `lower` and `upper` (n). At `feasible` (n), which satisfies the rows, a row has the slack s >= 0. With
/// Separator::between, what is in front may use up one half of it and what is behind the other, so that all u between
/// the bounds keep the row. With Separator::behind, what is behind keeps to all of s and what is in front is free: for
/// hidden parts that only have to give way. Every bound leaves `room` >= 0 beyond `feasible`, so that a vertex pressed
/// from two sides can move at all; rows may be broken by as much.
void add_separators(const std::vector<InequalityRow>& rows, const std::vector<Separator>& kind,
                    const Eigen::VectorXd& feasible, double room, Eigen::VectorXd& lower, Eigen::VectorXd& upper);

}  // namespace formwright
