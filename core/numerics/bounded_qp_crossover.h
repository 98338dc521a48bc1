// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// From an interior point to the exact optimum on its active set.
#include <optional>

#include "numerics/exchange_solver.h"
#include "numerics/interior_point_solver.h"

namespace formwright::bounded_qp_detail {

/// Adds the reactions of the base to a result of an exchange on it: multipliers, active rows, forces. Returns the base
/// rows that would have to pull instead of push; while there are any, the result is not optimal.
std::vector<RowKey> add_base_reactions(const Energy& energy, const Rows& rows, std::span<const RowKey> base, ExchangeResult& result);

/// Takes the bounds that surely hold at the interior point out of the factorisation, lets an exchange decide about
/// the doubtful ones and all others, and gives back those whose multiplier turns out negative; the set taken out only
/// shrinks, so that this ends. Nothing when more rows stay doubtful than an exchange can carry (`most_active`).
/// `refactorisations` counts. Throws Error: could_not_solve, cancelled.
std::optional<ExchangeResult> crossover(Energy& energy, const Rows& rows, const InteriorPointResult& point, const ExchangeSettings& settings,
                                        int& refactorisations, Context& context);

}  // namespace formwright::bounded_qp_detail
