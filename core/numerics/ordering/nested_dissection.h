// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Fill-reducing orders by nested dissection (George 1973), built for graphs like the two-ring of a mesh.
#include <vector>

#include "base/context.h"
#include "numerics/ordering/graph.h"

namespace formwright {

struct NestedDissectionOptions {
  int leaf_size = 300;  // parts of at most this many vertices are ordered by minimum degree
  bool parallel = true;
};

/// Returns the vertices, first eliminated first. With `parallel` it uses all threads; the result does not depend on
/// their number.
std::vector<int> nested_dissection(const Graph& graph, const NestedDissectionOptions& options, Context& context);

}  // namespace formwright
