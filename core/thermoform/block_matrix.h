// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A symmetric sparse matrix of 3 x 3 blocks, one row of blocks a vertex, in single precision: it only makes Newton's
// directions, whose errors the next iteration mends; what must be exact, the forces, is in double precision elsewhere.
#include <array>
#include <span>
#include <vector>

#include "geometry/lanes.h"
#include "geometry/triangle_mesh.h"

namespace formwright {

/// Vectors of the solver: one vertex an entry, x, y, z and an unused lane that stays 0.
using BlockVector = std::vector<Float4>;

class BlockMatrix {
 public:
  /// Pattern: vertices that share an element (a triangle's three corners, a hinge's four vertices).
  BlockMatrix(int vertex_count, std::span<const int> element_vertices, int vertices_per_element);
  BlockMatrix() = default;

  int row_count() const { return static_cast<int>(first_.size()) - 1; }
  void set_zero();

  /// Where block (row, column) is kept; -1 outside of the pattern.
  int slot(int row, int column) const;
  int diagonal_slot(int row) const { return diagonal_[static_cast<std::size_t>(row)]; }

  /// The columns of a block as three vectors.
  std::array<Float4, 3>& block(int slot) { return blocks_[static_cast<std::size_t>(slot)]; }
  const std::array<Float4, 3>& block(int slot) const { return blocks_[static_cast<std::size_t>(slot)]; }

  std::span<const int> columns(int row) const {
    const auto r = static_cast<std::size_t>(row);
    return {column_.data() + first_[r], static_cast<std::size_t>(first_[r + 1] - first_[r])};
  }
  int first_slot(int row) const { return first_[static_cast<std::size_t>(row)]; }

  /// y = A x in the given rows; x must be 0 wherever a vertex is held.
  void multiply(const BlockVector& x, std::span<const int> rows, BlockVector& y) const;

 private:
  std::vector<int> first_, column_, diagonal_;
  std::vector<std::array<Float4, 3>> blocks_;
};

}  // namespace formwright
