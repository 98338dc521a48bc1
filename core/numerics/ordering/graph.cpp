// SPDX-License-Identifier: GPL-3.0-or-later
#include "numerics/ordering/graph.h"

namespace formwright {

Graph graph_of(const SparseMatrix& lower) {
  const int n = static_cast<int>(lower.cols());
  Graph graph;
  graph.start.assign(static_cast<std::size_t>(n) + 1, 0);
  for (int j = 0; j < n; ++j) {
    for (SparseMatrix::InnerIterator it(lower, j); it; ++it) {
      const int i = static_cast<int>(it.row());
      if (i == j) continue;
      ++graph.start[j + 1];
      ++graph.start[i + 1];
    }
  }
  for (int v = 0; v < n; ++v) graph.start[v + 1] += graph.start[v];
  graph.neighbour.resize(graph.start[n]);
  std::vector<std::size_t> next(graph.start.begin(), graph.start.end() - 1);
  for (int j = 0; j < n; ++j) {  // columns ascend, so every list comes out sorted
    for (SparseMatrix::InnerIterator it(lower, j); it; ++it) {
      const int i = static_cast<int>(it.row());
      if (i == j) continue;
      graph.neighbour[next[j]++] = i;
      graph.neighbour[next[i]++] = j;
    }
  }
  return graph;
}

}  // namespace formwright
