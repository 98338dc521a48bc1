// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Symmetric positive definite matrices (lower triangles) of known form for the tests of the factorisation.
#include <Eigen/SparseCore>
#include <cstdint>
#include <vector>

#include "numerics/sparse/sparse_cholesky.h"

namespace formwright::test {

/// A small generator of our own, so that every platform sees the same matrices.
class MatrixRandom {
 public:
  explicit MatrixRandom(std::uint64_t seed) : state_(seed * 2862933555777941757ull + 3037000493ull) {}
  double uniform() {  // in [-1, 1)
    state_ = state_ * 6364136223846793005ull + 1442695040888963407ull;
    return static_cast<double>(state_ >> 11) * (2.0 / 9007199254740992.0) - 1.0;
  }
  int below(int n) { return static_cast<int>((0.5 * uniform() + 0.5) * n); }

 private:
  std::uint64_t state_;
};

/// Entries in [-1, 1).
inline Eigen::MatrixXd random_matrix(int rows, int columns, std::uint64_t seed) {
  MatrixRandom random(seed);
  Eigen::MatrixXd result(rows, columns);
  for (int c = 0; c < columns; ++c) {
    for (int r = 0; r < rows; ++r) result(r, c) = random.uniform();
  }
  return result;
}

inline SparseMatrix lower_of(int n, const std::vector<Eigen::Triplet<double>>& entries) {
  SparseMatrix matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  matrix.makeCompressed();
  return matrix;
}

/// Diagonally dominant, about `per_row` random entries a row.
inline SparseMatrix random_spd(int n, double per_row, std::uint64_t seed) {
  MatrixRandom random(seed);
  std::vector<Eigen::Triplet<double>> entries;
  std::vector<double> sum(static_cast<std::size_t>(n), 0.0);
  for (int k = 0; k < static_cast<int>(n * per_row / 2); ++k) {
    const int a = random.below(n), b = random.below(n);
    if (a == b) continue;
    const double value = random.uniform();
    entries.emplace_back(std::max(a, b), std::min(a, b), value);
    sum[static_cast<std::size_t>(a)] += std::abs(value);
    sum[static_cast<std::size_t>(b)] += std::abs(value);
  }
  for (int i = 0; i < n; ++i) entries.emplace_back(i, i, 1 + sum[static_cast<std::size_t>(i)]);
  return lower_of(n, entries);
}

/// The five-point Laplacian of a width x height grid plus `shift`.
inline SparseMatrix grid_laplacian(int width, int height, double shift) {
  std::vector<Eigen::Triplet<double>> entries;
  std::vector<double> degree(static_cast<std::size_t>(width * height), shift);
  const auto couple = [&](int a, int b) {
    entries.emplace_back(std::max(a, b), std::min(a, b), -1.0);
    degree[static_cast<std::size_t>(a)] += 1;
    degree[static_cast<std::size_t>(b)] += 1;
  };
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (x + 1 < width) couple(y * width + x, y * width + x + 1);
      if (y + 1 < height) couple(y * width + x, (y + 1) * width + x);
    }
  }
  for (int i = 0; i < width * height; ++i) entries.emplace_back(i, i, degree[static_cast<std::size_t>(i)]);
  return lower_of(width * height, entries);
}

/// L^T L + shift on a triangulated torus of width x height vertices: 19 entries a row, as in the relief's energy.
inline SparseMatrix torus_bilaplacian(int width, int height, double shift) {
  const int n = width * height;
  std::vector<Eigen::Triplet<double>> entries;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const int i = y * width + x, right = y * width + (x + 1) % width, up = ((y + 1) % height) * width + x,
                diagonal = ((y + 1) % height) * width + (x + 1) % width;
      for (const int j : {right, up, diagonal}) {
        entries.emplace_back(i, j, -1.0);
        entries.emplace_back(j, i, -1.0);
        entries.emplace_back(i, i, 1.0);
        entries.emplace_back(j, j, 1.0);
      }
    }
  }
  const SparseMatrix laplacian = lower_of(n, entries);
  SparseMatrix square = laplacian.transpose() * laplacian;
  for (int i = 0; i < n; ++i) square.coeffRef(i, i) += shift;
  SparseMatrix lower = square.triangularView<Eigen::Lower>();
  lower.makeCompressed();
  return lower;
}

/// Where the torus' vertices lie in space.
inline Positions torus_positions(int width, int height) {
  Positions positions(width * height, 3);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double u = 6.283185307179586 * x / width, v = 6.283185307179586 * y / height;
      positions.row(y * width + x) << (3 + std::cos(v)) * std::cos(u), (3 + std::cos(v)) * std::sin(u), std::sin(v);
    }
  }
  return positions;
}

inline Eigen::MatrixXd dense_of(const SparseMatrix& lower) {
  const SparseMatrix full = lower.selfadjointView<Eigen::Lower>();
  return full;
}

}  // namespace formwright::test
