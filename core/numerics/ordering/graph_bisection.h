// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Splits a graph in two by a vertex separator, on many levels: matched vertices are merged until few are left,
// these are split in several ways, and the best split is improved while the merging is undone.
// Hendrickson, Leland 1995; Karypis, Kumar 1998.
#include <vector>

#include "numerics/ordering/graph.h"
#include "numerics/ordering/vertex_separator.h"

namespace formwright {

struct BisectionOptions {
  SeparatorOptions separator;
  int attempts = 2;         // whole multilevel runs; the best one counts
  int starts = 6;           // splits tried on the coarsest graph, per attempt
  int coarsest_size = 120;  // vertices at which merging ends
  bool parallel = false;    // attempts side by side; changes no result
};

/// Left, right or separator for every vertex, with no edge between left and right. All left if the graph has no
/// separator that leaves two sides (a complete one, say).
std::vector<Side> bisect(const Graph& graph, const BisectionOptions& options, unsigned seed);

}  // namespace formwright
