// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Cuts a handle open along a short loop: Erickson & Whittlesey 2005 (tree and cotree), from several roots.
#include <vector>

#include "base/context.h"
#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

struct OpenedSurface {
  TriangleMesh mesh;                     // the given vertices first, then second copies of those on cuts
  std::vector<int> source_of;            // per vertex: which one of the given mesh it is (a copy of)
  std::vector<std::vector<int>> cuts;    // per cut, the given vertices along the loop, the first not repeated
  std::vector<std::vector<Vec3>> slits;  // cuts between openings, from end to end
};

/// Cuts one loop a handle, so that the surface has genus 0; every cut adds two openings. A surface without handles
/// comes back as it is. Needs a connected, manifold, oriented mesh. Throws Error: invalid_input ("mesh": too coarse to
/// be cut), cancelled.
OpenedSurface cut_handles(const TriangleMesh& mesh, Context& context);

/// Makes one opening of the two that are nearest to each other along the surface, by a slit between them. False, with
/// nothing changed, when there are fewer than two or no path between them keeps off the others.
bool join_nearest_openings(OpenedSurface& surface, Context& context);

}  // namespace formwright
