// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The base of an exchange: unknowns whose bounds are equal, taken out of the factorisation.
#include <vector>

#include "numerics/qp/exchange/exchange_solver.h"

namespace formwright::bounded_qp_detail {

/// Many equalities leave the factorisation instead of filling the pool: all of them, or none when they are few.
std::vector<RowKey> base_of(const Rows& rows);

/// Adds the reactions of the base to a result of an exchange on it: multipliers, active rows, forces.
void add_base_reactions(const Energy& energy, const Rows& rows, const std::vector<RowKey>& base,
                        ExchangeResult& result);

}  // namespace formwright::bounded_qp_detail
