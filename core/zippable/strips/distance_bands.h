// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A surface divided into parts along its feature lines, and each part into bands of equal width by the distance from
// its border: the first two steps of Mitani & Suzuki 2004.
#include <vector>

#include "base/context.h"
#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

struct Bands {
  TriangleMesh mesh;      // cut along the bands' borders
  std::vector<int> band;  // per face, from 0; connected
  std::vector<int> part;  // per face
  int band_count = 0, part_count = 0;
};

/// `limb`: per face, where smooth models are divided; edges between two limbs and edges that bend by more than
/// `feature_degrees` are borders of parts. Parts smaller than the squared width are joined to the neighbour along their
/// longest border. Bands are about `width_mm` wide, as wide as each other in every part. A closed model without any
/// border is banded from its outermost vertex. Needs a connected manifold. Throws Error: cancelled.
Bands distance_bands(const TriangleMesh& mesh, const std::vector<int>& limb, double feature_degrees, double width_mm,
                     Context& context);

}  // namespace formwright
