// SPDX-License-Identifier: GPL-3.0-or-later
#include "thermoform/solver/block_matrix.h"

#include <algorithm>

namespace formwright {

BlockMatrix::BlockMatrix(int vertex_count, std::span<const int> element_vertices, int vertices_per_element) {
  const auto n = static_cast<std::size_t>(vertex_count);
  const auto width = static_cast<std::size_t>(vertices_per_element);
  std::vector<std::vector<int>> neighbours(n);
  for (std::size_t i = 0; i < n; ++i) neighbours[i].push_back(static_cast<int>(i));
  for (std::size_t e = 0; e + width <= element_vertices.size(); e += width)
    for (std::size_t a = 0; a < width; ++a)
      for (std::size_t b = 0; b < width; ++b)
        if (a != b) neighbours[static_cast<std::size_t>(element_vertices[e + a])].push_back(element_vertices[e + b]);
  first_.assign(1, 0);
  for (std::size_t i = 0; i < n; ++i) {
    auto& row = neighbours[i];
    std::sort(row.begin(), row.end());
    row.erase(std::unique(row.begin(), row.end()), row.end());
    diagonal_.push_back(first_.back() +
                        static_cast<int>(std::lower_bound(row.begin(), row.end(), static_cast<int>(i)) - row.begin()));
    column_.insert(column_.end(), row.begin(), row.end());
    first_.push_back(static_cast<int>(column_.size()));
  }
  blocks_.resize(column_.size());
  set_zero();
}

void BlockMatrix::set_zero() { std::fill(blocks_.begin(), blocks_.end(), std::array<Float4, 3>{}); }

void BlockMatrix::set_zero(std::span<const int> rows) {
  for (const int row : rows) {
    const auto r = static_cast<std::size_t>(row);
    std::fill(blocks_.begin() + first_[r], blocks_.begin() + first_[r + 1], std::array<Float4, 3>{});
  }
}

int BlockMatrix::slot(int row, int column) const {
  const auto list = columns(row);
  const auto at = std::lower_bound(list.begin(), list.end(), column);
  return at != list.end() && *at == column ? first_slot(row) + static_cast<int>(at - list.begin()) : -1;
}

}  // namespace formwright
