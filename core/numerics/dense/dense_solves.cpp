// SPDX-License-Identifier: GPL-3.0-or-later
#include "numerics/dense/dense_solves.h"

#include <algorithm>

#include "numerics/dense/dense_vector.h"

namespace formwright::dense {
namespace {

inline double at(const double* l, std::size_t stride, int row, int column) {
  return l[static_cast<std::size_t>(column) * stride + static_cast<std::size_t>(row)];
}

// z[row_begin..row_end) -= L(:, first..first+width) y, for a strip of up to four columns; y are rows of z.
template <int Sides, int Width>
void subtract_strip(const double* l, std::size_t stride, const double* y, int row_begin, int row_end, double* z) {
  if constexpr (Sides == 1) {
    Vector factor[Width];
    for (int j = 0; j < Width; ++j) factor[j] = splat(-y[j]);
    for (int i = row_begin; i < row_end; i += 4) {
      Vector sum = load(z + i);
      for (int j = 0; j < Width; ++j)
        sum = multiply_add(load(l + static_cast<std::size_t>(j) * stride + i), factor[j], sum);
      store(z + i, sum);
    }
  } else {
    constexpr int vectors = Sides / 4;
    Vector factor[Width][vectors];
    for (int j = 0; j < Width; ++j) {
      for (int v = 0; v < vectors; ++v) factor[j][v] = -load(y + j * Sides + 4 * v);
    }
    for (int i = row_begin; i < row_end; ++i) {
      double* target = z + static_cast<std::ptrdiff_t>(i) * Sides;
      Vector sum[vectors];
      for (int v = 0; v < vectors; ++v) sum[v] = load(target + 4 * v);
      for (int j = 0; j < Width; ++j) {
        const Vector entry = splat(l[static_cast<std::size_t>(j) * stride + i]);
        for (int v = 0; v < vectors; ++v) sum[v] = multiply_add(entry, factor[j][v], sum[v]);
      }
      for (int v = 0; v < vectors; ++v) store(target + 4 * v, sum[v]);
    }
  }
}

// y -= L(rows, strip)^T z(rows), for a strip of up to four columns.
template <int Sides, int Width>
void subtract_products(const double* l, std::size_t stride, const double* z, int row_begin, int row_end, double* y) {
  if constexpr (Sides == 1) {
    Vector sum[Width] = {};
    for (int i = row_begin; i < row_end; i += 4) {
      const Vector right = load(z + i);
      for (int j = 0; j < Width; ++j)
        sum[j] = multiply_add(load(l + static_cast<std::size_t>(j) * stride + i), right, sum[j]);
    }
    for (int j = 0; j < Width; ++j) y[j] -= (sum[j][0] + sum[j][1]) + (sum[j][2] + sum[j][3]);
  } else {
    constexpr int vectors = Sides / 4;
    Vector sum[Width][vectors] = {};
    for (int i = row_begin; i < row_end; ++i) {
      Vector right[vectors];
      for (int v = 0; v < vectors; ++v) right[v] = load(z + static_cast<std::ptrdiff_t>(i) * Sides + 4 * v);
      for (int j = 0; j < Width; ++j) {
        const Vector entry = splat(l[static_cast<std::size_t>(j) * stride + i]);
        for (int v = 0; v < vectors; ++v) sum[j][v] = multiply_add(entry, right[v], sum[j][v]);
      }
    }
    for (int j = 0; j < Width; ++j) {
      for (int v = 0; v < vectors; ++v) store(y + j * Sides + 4 * v, load(y + j * Sides + 4 * v) - sum[j][v]);
    }
  }
}

template <typename Body>
void with_width(int width, const Body& body) {
  switch (width) {
    case 1: body.template operator()<1>(); break;
    case 2: body.template operator()<2>(); break;
    case 3: body.template operator()<3>(); break;
    default: body.template operator()<4>(); break;
  }
}

}  // namespace

template <int Sides>
void forward_block(const double* l, std::size_t stride, int width, int height, double* z) {
  for (int j = 0; j < width; j += 4) {
    const int columns = std::min(4, width - j);
    double* y = z + j * Sides;
    if (std::all_of(y, y + columns * Sides, [](double v) { return v == 0; })) continue;
    for (int p = 0; p < columns; ++p) {
      for (int k = 0; k < p; ++k) {
        const double entry = at(l, stride, j + p, j + k);
        for (int c = 0; c < Sides; ++c) y[p * Sides + c] -= entry * y[k * Sides + c];
      }
      const double inverse = 1 / at(l, stride, j + p, j + p);
      for (int c = 0; c < Sides; ++c) y[p * Sides + c] *= inverse;
    }
    const double* strip = l + static_cast<std::size_t>(j) * stride;
    with_width(columns, [&]<int Width>() { subtract_strip<Sides, Width>(strip, stride, y, j + 4, height, z); });
  }
}

template <int Sides>
void backward_block(const double* l, std::size_t stride, int width, int height, double* z) {
  for (int j = (width - 1) & ~3; j >= 0; j -= 4) {
    const int columns = std::min(4, width - j);
    double* y = z + j * Sides;
    const double* strip = l + static_cast<std::size_t>(j) * stride;
    with_width(columns, [&]<int Width>() { subtract_products<Sides, Width>(strip, stride, z, j + 4, height, y); });
    for (int p = columns - 1; p >= 0; --p) {
      for (int k = p + 1; k < columns; ++k) {
        const double entry = at(l, stride, j + k, j + p);
        for (int c = 0; c < Sides; ++c) y[p * Sides + c] -= entry * y[k * Sides + c];
      }
      const double inverse = 1 / at(l, stride, j + p, j + p);
      for (int c = 0; c < Sides; ++c) y[p * Sides + c] *= inverse;
    }
  }
}

template void forward_block<1>(const double*, std::size_t, int, int, double*);
template void forward_block<few_sides>(const double*, std::size_t, int, int, double*);
template void forward_block<many_sides>(const double*, std::size_t, int, int, double*);
template void backward_block<1>(const double*, std::size_t, int, int, double*);
template void backward_block<few_sides>(const double*, std::size_t, int, int, double*);
template void backward_block<many_sides>(const double*, std::size_t, int, int, double*);

}  // namespace formwright::dense
