// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The stiffness of four membrane triangles at a time, in the single precision in which Newton's matrix is kept.
#include <array>

#include "base/lanes.h"

namespace formwright {

/// What stiffness is made of, a triangle a lane.
struct StiffnessParts {
  Float4 gradient[2][2];  // of the shape functions of corners 1 and 2, in the rest frame (1/mm)
  Float4 f0[3], f1[3];    // images of the rest frame's axes
  Float4 tangent[6];      // D over (e00, e11, 2 e01) times the triangle's volume: 00, 01, 02, 11, 12, 22
  Float4 stress[3];       // without compression, times the volume: 00, 01, 11
};

/// [corner][corner][row][column], a triangle a lane.
using CornerBlocks = Float4[3][3][3][3];

/// K_ab = B_a^T D B_b + g_a^T S g_b, with B_a's rows g_a0 f0, g_a1 f1, g_a0 f1 + g_a1 f0; those of corner 0 from sums
/// of 0.
inline void corner_blocks(const StiffnessParts& p, CornerBlocks& K) {
  const auto& g = p.gradient;
  const auto& D = p.tangent;
  Float4 rows[2][3][3];
  for (int a = 0; a < 2; ++a)
    for (int k = 0; k < 3; ++k) {
      rows[a][0][k] = g[a][0] * p.f0[k];
      rows[a][1][k] = g[a][1] * p.f1[k];
      rows[a][2][k] = g[a][0] * p.f1[k] + g[a][1] * p.f0[k];
    }
  for (int b = 0; b < 2; ++b) {
    Float4 image[3][3];
    for (int k = 0; k < 3; ++k) {
      image[0][k] = D[0] * rows[b][0][k] + D[1] * rows[b][1][k] + D[2] * rows[b][2][k];
      image[1][k] = D[1] * rows[b][0][k] + D[3] * rows[b][1][k] + D[4] * rows[b][2][k];
      image[2][k] = D[2] * rows[b][0][k] + D[4] * rows[b][1][k] + D[5] * rows[b][2][k];
    }
    for (int a = 0; a <= b; ++a) {
      const Float4 geometric = g[a][0] * (p.stress[0] * g[b][0] + p.stress[1] * g[b][1]) +
                               g[a][1] * (p.stress[1] * g[b][0] + p.stress[2] * g[b][1]);
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
          Float4 sum = rows[a][0][i] * image[0][j] + rows[a][1][i] * image[1][j] + rows[a][2][i] * image[2][j];
          if (i == j) sum += geometric;
          K[a + 1][b + 1][i][j] = sum;
          if (a != b) K[b + 1][a + 1][j][i] = sum;
        }
    }
  }
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      K[0][1][i][j] = -(K[1][1][i][j] + K[2][1][i][j]);
      K[0][2][i][j] = -(K[1][2][i][j] + K[2][2][i][j]);
      K[1][0][i][j] = -(K[1][1][i][j] + K[1][2][i][j]);
      K[2][0][i][j] = -(K[2][1][i][j] + K[2][2][i][j]);
      K[0][0][i][j] = -(K[0][1][i][j] + K[0][2][i][j]);
    }
}

/// Four triangles' blocks, column by column (x, y, z, 0), out of vectors of a triangle a lane: 4 x 4 transposes.
inline void one_by_one(const CornerBlocks& K, std::size_t a, std::size_t b,
                       std::array<std::array<Float4, 3>, 4>& block) {
  const Float4 none{};
  for (std::size_t j = 0; j < 3; ++j) {
    const Float4 &kx = K[a][b][0][j], &ky = K[a][b][1][j], &kz = K[a][b][2][j];
    const Float4 xy_low = __builtin_shufflevector(kx, ky, 0, 4, 1, 5),
                 xy_high = __builtin_shufflevector(kx, ky, 2, 6, 3, 7);
    const Float4 z_low = __builtin_shufflevector(kz, none, 0, 4, 1, 5),
                 z_high = __builtin_shufflevector(kz, none, 2, 6, 3, 7);
    block[0][j] = __builtin_shufflevector(xy_low, z_low, 0, 1, 4, 5);
    block[1][j] = __builtin_shufflevector(xy_low, z_low, 2, 3, 6, 7);
    block[2][j] = __builtin_shufflevector(xy_high, z_high, 0, 1, 4, 5);
    block[3][j] = __builtin_shufflevector(xy_high, z_high, 2, 3, 6, 7);
  }
}

}  // namespace formwright
