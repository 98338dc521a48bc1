// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// From an interior point to the exact optimum on its active set, by a primal-dual active set method (Hintermueller,
// Ito, Kunisch 2002) on the sparse factorisation of NewtonMatrix.
#include "base/context.h"
#include "numerics/qp/exchange/exchange_solver.h"
#include "numerics/qp/interior_point/interior_point_solver.h"
#include "numerics/qp/interior_point/newton_matrix.h"

namespace formwright::bounded_qp_detail {

/// Bounds that hold leave the matrix, order rows that hold are springs with multipliers. Violated constraints join and
/// those that pull leave, for a few rounds; `stopped` says that the active set did not settle, and the result is then
/// the interior point itself. Throws Error: cancelled, out_of_memory.
ExchangeResult polish_active_set(const Energy& energy, NewtonMatrix& matrix, const Rows& rows,
                                 const InteriorPointResult& point, double violation_tolerance, Context& context);

}  // namespace formwright::bounded_qp_detail
