// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What stands before one part of a base: depths of the relief and of the part over the area in which the part is seen.
#include <vector>

#include "geometry/planar/delaunay.h"
#include "relief/base/base_parts.h"

namespace formwright {

/// Depths z on a ray, in view coordinates.
struct FrontSample {
  double base = 0;       // where it meets the part
  double leaves = 0;     // where it leaves it, infinite for an open one
  double relief = 0;     // of the relief, the base where there is none
  bool covered = false;  // whether there is one
};

struct PartFront {
  PlaneTriangles net;                // over the plate's front
  std::vector<FrontSample> samples;  // of its points
};

struct PartFrontOptions {
  double above = 0, below = 0;  // of the relief, from the part, along z
  double pitch = 0;             // of the points at most, on the plate's front
  double tolerance = 0;         // in depth, of larger triangles
};

/// `relief`: the surface before this part alone, in view coordinates; may be empty. `seen`: within parts.seen(part).
/// Throws Error: invalid_input "pixel_mm" (over 16 million points), cancelled.
PartFront part_front(const BaseParts& parts, int part, const Region& seen, const TriangleMesh& relief,
                     const PartFrontOptions& options, Context& context);

}  // namespace formwright
