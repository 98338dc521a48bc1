// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A symmetric sparse matrix of 3 x 3 blocks, one row of blocks a vertex, in single precision: it only makes Newton's
// directions, whose errors the next iteration fixes; what must be exact, the forces, is in double precision elsewhere.
#include <array>
#include <span>
#include <vector>

#include "base/lanes.h"
#include "geometry/mesh/triangle_mesh.h"

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
  /// Only the given rows.
  void set_zero(std::span<const int> rows);

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

  /// The matrix as the innermost loops see it, while its pattern stays.
  struct Rows {
    const int *first, *column;
    const std::array<Float4, 3>* blocks;
    /// Row `row` of A x; x must be 0 wherever a vertex is held.
    Float4 times(std::size_t row, const Float4* x) const {
      Float4 sum{}, other{};
      for (int k = first[row]; k < first[row + 1]; ++k) {
        const Float4 v = x[column[k]];
        const auto& block = blocks[k];
        sum += block[0] * v[0];
        other += block[1] * v[1];
        sum += block[2] * v[2];
      }
      return sum + other;
    }
  };
  Rows rows() const { return {first_.data(), column_.data(), blocks_.data()}; }

 private:
  std::vector<int> first_, column_, diagonal_;
  std::vector<std::array<Float4, 3>> blocks_;
};

}  // namespace formwright
