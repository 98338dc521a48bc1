// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The lightest separator near a given one, by a maximum flow through the vertices of a band around it.
// Dinic 1970; Sanders, Schulz 2016 "Advanced multilevel node separator algorithms".
#include <vector>

#include "numerics/ordering/vertex_separator.h"

namespace formwright {

struct SeparatorFlowOptions {
  int layers = 6;         // of the band on either side
  double side_max = 0.7;  // no side can grow beyond this part of the whole
};

/// Replaces `side` by a separator of the least weight among all that run inside the band, if that is lighter.
/// Returns whether it changed. Of the two extreme minimum cuts it takes the better balanced one.
bool improve_by_flow(const Graph& graph, std::vector<Side>& side, const SeparatorFlowOptions& options);

}  // namespace formwright
