// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A Laplacian that stays positive semidefinite on poor triangles.
#include "geometry/operators/laplacian.h"

namespace formwright {

/// The cotangent Laplacian with negative weights, which obtuse and clamped cotangents leave, taken as 0. Rows sum to 0.
inline SparseMatrix nonnegative_laplacian(const TriangleMesh& mesh, const Adjacency& adjacency) {
  SparseMatrix laplacian = cotangent_laplacian(mesh, adjacency);
  for (int column = 0; column < laplacian.outerSize(); ++column) {
    double sum = 0, *diagonal = nullptr;
    for (SparseMatrix::InnerIterator entry(laplacian, column); entry; ++entry) {
      if (entry.row() == column) {
        diagonal = &entry.valueRef();
        continue;
      }
      if (!(entry.value() < 0)) entry.valueRef() = 0;
      sum -= entry.value();
    }
    if (diagonal) *diagonal = sum;
  }
  return laplacian;
}

}  // namespace formwright
