// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Triangular solves with one block of columns of L, for one or eight right-hand sides.
#include <cstddef>

namespace formwright::dense {

/// Right-hand sides solved together: entry (row, c) lies at row * side_count + c.
constexpr int few_sides = 4, many_sides = 8;

/// z holds one entry (Sides of them) per row of the block, padding rows included: `height` rows, a multiple of
/// four. The first `width` become L11^-1 z1, the rest lose L21 times that.
template <int Sides>
void forward_block(const double* l, std::size_t stride, int width, int height, double* z);

/// The first `width` become L11^-T (z1 - L21^T z2).
template <int Sides>
void backward_block(const double* l, std::size_t stride, int width, int height, double* z);

extern template void forward_block<1>(const double*, std::size_t, int, int, double*);
extern template void forward_block<few_sides>(const double*, std::size_t, int, int, double*);
extern template void forward_block<many_sides>(const double*, std::size_t, int, int, double*);
extern template void backward_block<1>(const double*, std::size_t, int, int, double*);
extern template void backward_block<few_sides>(const double*, std::size_t, int, int, double*);
extern template void backward_block<many_sides>(const double*, std::size_t, int, int, double*);

}  // namespace formwright::dense
