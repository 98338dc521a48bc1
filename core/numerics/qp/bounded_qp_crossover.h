// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// From an interior point to the exact optimum on its active set.
#include <optional>

#include "numerics/qp/exchange_solver.h"
#include "numerics/qp/interior_point_solver.h"

namespace formwright::bounded_qp_detail {

/// Begins an exchange with the bounds that surely hold at the interior point as its base and the doubtful ones as its
/// pool. Nothing when it does not settle. Throws Error: could_not_solve, cancelled.
std::optional<ExchangeResult> crossover(Energy& energy, const Rows& rows, const InteriorPointResult& point,
                                        const ExchangeSettings& settings, Context& context);

}  // namespace formwright::bounded_qp_detail
