// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Punctures that are cuts: the surface opened along a straight or curved path (thesis Fig. 5.7, last row).
#include <vector>

#include "base/context.h"
#include "zippable/parts/handles.h"

namespace formwright {

/// Opens the surface along every path, the straightest line through its points: faces are cut where it crosses them,
/// vertices get a second copy, and both ends stay closed. A cut begins and ends within an edge of the path's ends and
/// keeps a tenth of an edge off old vertices. Returns the cuts as polylines, mm. Needs a connected, manifold, oriented
/// mesh. Throws Error: invalid_input ("segments": too short for the mesh, meeting itself, an opening or another cut),
/// cancelled.
std::vector<std::vector<Vec3>> cut_slits(OpenedSurface& surface, const std::vector<std::vector<Vec3>>& paths,
                                         Context& context);

}  // namespace formwright
