// SPDX-License-Identifier: GPL-3.0-or-later
// In which order the steps follow.
#include "geometry/samples/remeshing/remesher.h"

#include <cmath>

namespace formwright::samples {

Remesher::Remesher(const Surface& surface, const std::vector<int>& patch, const TargetShape& shape, int target,
                   int ghost, Context& context)
    : s_(surface, patch), shape_(shape), target_(target + (ghost >= 0 ? 1 : 0)), ghost_(ghost), context_(context) {
  // n vertices carry 2 n triangles of area sqrt(3)/4 edge^2.
  double area = 0;
  for (int h = 0; h < s_.halfedge_slots(); h += 3)
    if (!touches_ghost(h))
      area += 0.5 * length(normal_of(s_.point(s_.start(h)), s_.point(s_.start(h + 1)), s_.point(s_.start(h + 2))));
  edge_ = std::sqrt(area * 2 / (std::sqrt(3.0) * target));
}

Surface Remesher::run(std::vector<int>& patch) {
  // From a handful of triangles: halve edges, longest first, until none is too long.
  for (double longest = longest_edge(); longest > 2.8 * edge_; longest = longest_edge()) {
    scale_ = longest;
    split_longer_than(0.7 * longest);
    flip_to_delaunay();
    relax(0.1, false);
    relax(0.1, false);
  }
  scale_ = edge_;
  // A first mesh much finer than wanted needs more rounds to come down.
  const double excess = static_cast<double>(s_.vertex_count()) / target_;
  const int coarsening = excess > 2 ? 3 + static_cast<int>(std::log2(excess)) : 0;
  for (int k = 0; k < coarsening; ++k) {
    collapse_short(0.8);
    flip_by_valence();
    relax(0.2, false);
  }
  for (int k = 0; k < 3; ++k) {
    split_long(4.0 / 3);
    collapse_short(0.8);
    flip_by_valence();
    relax(0.15, k == 1);
    context_.check_cancelled();
  }
  for (int k = 0; k < 3; ++k) {
    dissolve_slivers();
    match_count();
    if (k == 0) flip_by_valence();
    flip_to_delaunay();
    relax(k == 1 ? 0.02 : 0.05, k != 1);
    context_.check_cancelled();
  }
  flip_to_delaunay();
  polish();
  context_.check_cancelled();
  return s_.compact(&patch);
}

}  // namespace formwright::samples
