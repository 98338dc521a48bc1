// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Undirected graphs as the ordering of sparse matrices sees them: no loops, both directions stored.
#include <cstddef>
#include <span>
#include <vector>

#include "numerics/sparse_matrix.h"

namespace formwright {

struct Graph {
  std::vector<std::size_t> start;  // n + 1 offsets into neighbour
  std::vector<int> neighbour;
  std::vector<int> edge_weight;  // as neighbour; empty: all 1
  std::vector<int> weight;       // n; empty: all 1

  int size() const { return static_cast<int>(start.size()) - 1; }
  std::span<const int> neighbours(int v) const { return {neighbour.data() + start[v], start[v + 1] - start[v]}; }
  int weight_of(int v) const { return weight.empty() ? 1 : weight[v]; }
  int edge_weight_of(std::size_t edge) const { return edge_weight.empty() ? 1 : edge_weight[edge]; }
};

/// The graph of a symmetric matrix given by its lower triangle; neighbours ascend.
Graph graph_of(const SparseMatrix& lower);

}  // namespace formwright
