// SPDX-License-Identifier: GPL-3.0-or-later
#include "numerics/dense/dense_kernels.h"

#include <algorithm>
#include <cmath>

#include "numerics/dense/dense_vector.h"

namespace formwright::dense {
namespace {

// As many accumulators as the registers hold: 12 x 4 in 16 registers of four, 4 x 4 in 16 registers of two.
#if defined(__AVX__)
constexpr int tile_vectors = 3;
#else
constexpr int tile_vectors = 1;
#endif

// C (4 V x 4) -= A B^T, `depth` products long; only `columns` columns of C are written.
template <int V>
inline void tile(const double* a, std::size_t a_sliver, std::size_t a_column, const double* b, std::size_t b_column,
                 int depth, double* c, std::size_t stride, int columns, Update update) {
  Vector sum[V][4];
  for (int v = 0; v < V; ++v) {
    for (int j = 0; j < 4; ++j) sum[v][j] = Vector{};
  }
  for (int j = 0; j < columns; ++j) {
    __builtin_prefetch(c + static_cast<std::size_t>(j) * stride);
    if (V > 2) __builtin_prefetch(c + static_cast<std::size_t>(j) * stride + 8);
  }
  for (int k = 0; k < depth; ++k) {
    Vector left[V];
    for (int v = 0; v < V; ++v) left[v] = load(a + static_cast<std::size_t>(v) * a_sliver);
    for (int j = 0; j < 4; ++j) {
      const Vector right = splat(b[j]);
      for (int v = 0; v < V; ++v) sum[v][j] = multiply_add(left[v], right, sum[v][j]);
    }
    a += a_column;
    b += b_column;
  }
  for (int j = 0; j < columns; ++j) {
    double* target = c + static_cast<std::size_t>(j) * stride;
    for (int v = 0; v < V; ++v) {
      if (update == Update::subtract) {
        store(target + 4 * v, load(target + 4 * v) - sum[v][j]);
      } else {
        store(target + 4 * v, -sum[v][j]);
      }
    }
  }
}

// One strip of up to four columns of C, rows [row_begin, row_end).
inline void strip(double* c, std::size_t stride, const Rows& a, const double* b, std::size_t b_column, int depth,
                  int row_begin, int row_end, int columns, Update update) {
  int row = row_begin;
  const auto first = [&] { return a.data + static_cast<std::size_t>(row / 4) * a.sliver_stride; };
  for (; row + 4 * tile_vectors <= row_end; row += 4 * tile_vectors) {
    tile<tile_vectors>(first(), a.sliver_stride, a.column_stride, b, b_column, depth, c + row, stride, columns, update);
  }
  if constexpr (tile_vectors > 2) {
    if (row + 8 <= row_end) {
      tile<2>(first(), a.sliver_stride, a.column_stride, b, b_column, depth, c + row, stride, columns, update);
      row += 8;
    }
  }
  for (; row < row_end; row += 4) {
    tile<1>(first(), a.sliver_stride, a.column_stride, b, b_column, depth, c + row, stride, columns, update);
  }
}

// The 4 x 4 (or smaller) triangle of one strip: reciprocals of its diagonal and its entries below.
struct SmallTriangle {
  double inverse[4];
  double below[4][4];
};

SmallTriangle small_triangle(const double* l, std::size_t stride, int columns) {
  SmallTriangle t{};
  for (int j = 0; j < columns; ++j) {
    t.inverse[j] = 1 / l[static_cast<std::size_t>(j) * stride + static_cast<std::size_t>(j)];
    for (int i = j + 1; i < columns; ++i)
      t.below[i][j] = l[static_cast<std::size_t>(j) * stride + static_cast<std::size_t>(i)];
  }
  return t;
}

// X <- X T^-T for a strip of up to four columns.
inline void solve_strip(const SmallTriangle& t, int columns, double* x, std::size_t stride, int rows) {
  for (int r = 0; r < rows; r += 4) {
    Vector solved[4];
    for (int j = 0; j < columns; ++j) {
      double* at = x + static_cast<std::size_t>(j) * stride + r;
      Vector v = load(at);
      for (int k = 0; k < j; ++k) v = multiply_add(solved[k], splat(-t.below[j][k]), v);
      solved[j] = v * splat(t.inverse[j]);
      store(at, solved[j]);
    }
  }
}

}  // namespace

int factor_diagonal(double* a, std::size_t stride, int columns, const double* minimum) {
  const int rows = (columns + 3) & ~3;
  for (int j = 0; j < columns; j += 4) {
    const int width = std::min(4, columns - j);
    double* corner = a + static_cast<std::size_t>(j) * stride;
    if (j > 0) strip(corner, stride, panel_rows(a, stride), a + j, stride, j, j, rows, width, Update::subtract);
    for (int p = 0; p < width; ++p) {
      double* column = corner + static_cast<std::size_t>(p) * stride + j;
      for (int k = 0; k < p; ++k) {
        const double* left = corner + static_cast<std::size_t>(k) * stride + j;
        for (int i = p; i < width; ++i) column[i] -= left[i] * left[p];
      }
      const double pivot = column[p];
      if (!(pivot > minimum[j + p]) || !std::isfinite(pivot)) return j + p;
      const double root = std::sqrt(pivot), inverse = 1 / root;
      column[p] = root;
      for (int i = p + 1; i < width; ++i) column[i] *= inverse;
    }
    if (j + 4 < rows)
      solve_strip(small_triangle(corner + j, stride, width), width, corner + j + 4, stride, rows - j - 4);
  }
  return -1;
}

void solve_rows(const double* l, std::size_t l_stride, int columns, double* x, std::size_t x_stride, int rows) {
  for (int j = 0; j < columns; j += 4) {
    const int width = std::min(4, columns - j);
    double* target = x + static_cast<std::size_t>(j) * x_stride;
    if (j > 0) strip(target, x_stride, panel_rows(x, x_stride), l + j, l_stride, j, 0, rows, width, Update::subtract);
    solve_strip(small_triangle(l + static_cast<std::size_t>(j) * l_stride + j, l_stride, width), width, target,
                x_stride, rows);
  }
}

void pack(const double* a, std::size_t stride, int columns, int rows, double* packed) {
  constexpr int together = 32;  // rows; whole cache lines of every column
  const std::size_t sliver = 4 * static_cast<std::size_t>(columns);
  for (int first = 0; first < rows; first += together) {
    const int last = std::min(rows, first + together);
    for (int k = 0; k < columns; ++k) {
      const double* from = a + static_cast<std::size_t>(k) * stride;
      for (int r = first; r < last; r += 4) {
        store(packed + static_cast<std::size_t>(r / 4) * sliver + 4 * static_cast<std::size_t>(k), load(from + r));
      }
    }
  }
}

void update_lower(double* c, std::size_t stride, const Rows& a, int depth, int row_begin, int row_end, int column_begin,
                  int column_end, Update update) {
  constexpr int together = 256;  // columns; their slivers stay in the second-level cache
  constexpr int tile_rows = 4 * tile_vectors;
  for (int first = column_begin; first < column_end; first += together) {
    const int last = std::min(column_end, first + together);
    // Tiles of rows outside, strips of columns inside: the tile's rows of A stay in the first-level cache.
    for (int row = std::max(row_begin, first); row < row_end;) {
      const int rows = std::min(tile_rows, row_end - row);
      for (int j = first; j < last && j < row + rows; j += 4) {
        const double* b = a.data + static_cast<std::size_t>(j / 4) * a.sliver_stride;
        strip(c + static_cast<std::size_t>(j) * stride, stride, a, b, a.column_stride, depth, std::max(row, j),
              row + rows, std::min(4, last - j), update);
      }
      row += rows;
    }
  }
}

}  // namespace formwright::dense
