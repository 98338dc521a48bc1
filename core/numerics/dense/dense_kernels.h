// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The dense arithmetic of the factorisation. Matrices are column-major; heights, leading dimensions and
// first rows are multiples of four, rows beyond the data hold zeros. Every entry of a result is
// accumulated in one fixed order, so that results do not depend on how the work is cut up.
#include <cstddef>

namespace formwright::dense {

/// Factors the `columns` x `columns` lower triangle at the top of `a` in place (Cholesky), down to row
/// padded(columns). `least` holds for each column the smallest pivot that counts as positive.
/// Returns the first column that is not positive definite, or -1. The strict upper triangle is overwritten.
int factor_diagonal(double* a, std::size_t stride, int columns, const double* minimum);

/// X <- X L^-T for `rows` rows of X (`columns` wide), L as factor_diagonal left it.
void solve_rows(const double* l, std::size_t l_stride, int columns, double* x, std::size_t x_stride, int rows);

/// Copies `rows` rows of a panel into slivers of four rows, each contiguous: sliver r holds, column after
/// column, the rows 4 r to 4 r + 3.
void pack(const double* a, std::size_t stride, int columns, int rows, double* packed);

/// Rows of A for an update, either as they lie in a column-major panel or packed.
struct Rows {
  const double* data;
  std::size_t sliver_stride;  // from one group of four rows to the next
  std::size_t column_stride;
};
inline Rows panel_rows(const double* a, std::size_t stride) { return {a, 4, stride}; }
inline Rows packed_rows(const double* packed, int columns) {
  return {packed, 4 * static_cast<std::size_t>(columns), 4};
}

enum class Update { subtract, overwrite };

/// C -= A A^T (or C = -A A^T) on the part of the lower triangle with rows [row_begin, row_end) and columns
/// [column_begin, column_end) of C; A has `depth` columns. All four bounds are multiples of four, except
/// that column_end may be the odd width of C. A few entries above the diagonal are overwritten.
void update_lower(double* c, std::size_t stride, const Rows& a, int depth, int row_begin, int row_end, int column_begin,
                  int column_end, Update update);

}  // namespace formwright::dense
