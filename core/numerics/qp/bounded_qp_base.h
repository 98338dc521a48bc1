// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Exchanges for dense contact: bounds that surely hold leave the factorisation (the base), the pool decides about the
// rest.
#include <optional>

#include "numerics/qp/exchange_solver.h"

namespace formwright::bounded_qp_detail {

/// Adds the reactions of the base to a result of an exchange on it: multipliers, active rows, forces. Returns the base
/// rows that would have to pull instead of push; while there are any, the result is not optimal.
std::vector<RowKey> add_base_reactions(const Energy& energy, const Rows& rows, std::span<const RowKey> base,
                                       ExchangeResult& result);

/// Starts from a guess: `base` (at most one bound for each unknown) and `settings.first`. Every stage factors with the
/// base taken out and exchanges until nothing is violated or more than `settings.max_active` rows of the pool hold.
/// Then bounds of the pool that hold join the base, and those of the base that pull leave it. Once exchanges run to
/// their end the objective falls from stage to stage, so that no base comes back. Nothing if `max_stages` stages were
/// not enough. Throws Error: could_not_solve, cancelled.
std::optional<ExchangeResult> exchange_on_base(Energy& energy, const Rows& rows, std::vector<RowKey> base,
                                               ExchangeSettings settings, int max_stages, Context& context);

}  // namespace formwright::bounded_qp_detail
