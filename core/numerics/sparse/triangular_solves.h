// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Solves with L and L^T, dense and along paths of the elimination tree. All functions may be called from
// several threads at once.
#include <Eigen/Core>
#include <span>
#include <vector>

#include "numerics/sparse/multifrontal.h"
#include "numerics/sparse/sparse_cholesky.h"

namespace formwright {

/// y <- L^-1 y in elimination order; Sides right-hand sides, interleaved.
template <int Sides>
void forward_solve(const SupernodalForm& form, const double* factor, double* y);

/// y <- L^-T y.
template <int Sides>
void backward_solve(const SupernodalForm& form, const double* factor, double* y);

/// y = L^-1 P b for up to `dense::many_sides` sparse right-hand sides (in the matrix's order) at once.
void sparse_forward(const SupernodalForm& form, const double* factor, std::span<const SparseVector* const> b,
                    std::span<SparseVector* const> y);

}  // namespace formwright
