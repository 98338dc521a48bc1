// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Approximate minimum degree ordering with a halo.
// Amestoy, Davis, Duff 1996 "An approximate minimum degree ordering algorithm"; Pellegrini, Roman,
// Amestoy 2000 "Hybridizing nested dissection and halo approximate minimum degree".
#include <vector>

#include "numerics/ordering/graph.h"

namespace formwright {

/// Orders the first `inner` vertices of `graph`; the rest (the halo) are eliminated later by someone else
/// and only count in the degrees. Edges between halo vertices may be left out.
/// Returns the inner vertices, first eliminated first.
std::vector<int> minimum_degree(const Graph& graph, int inner);

}  // namespace formwright
