// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a viewer at infinity, who looks along z, sees of several surfaces that hide each other.
#include <vector>

#include "base/context.h"
#include "geometry/mesh/triangle_mesh.h"
#include "geometry/planar/region.h"

namespace formwright {

/// Of each surface the area of the plane in which it is foremost. Areas of different surfaces share borders and do not
/// overlap. `part`: of each surface, from 0. Throws Error{invalid_input, "base_mesh"}: surfaces of two parts cross.
/// Error{cancelled}.
std::vector<Region> seen_regions(const std::vector<TriangleMesh>& surfaces, const std::vector<int>& part,
                                 const Context& context);

/// What one surface covers of the plane, whatever lies before it.
Region outline_of(const TriangleMesh& surface);

}  // namespace formwright
