// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a ray finds, and the order in which hits are reported.
#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

struct RayHit {
  int face = -1;
  double distance = 0;  // along the unit direction
  Vec3 barycentric;     // of the face's three corners, sums to 1
};

/// Nearer first; at the same distance by face, whatever the order of a tree.
inline bool comes_before(const RayHit& a, const RayHit& b) {
  return a.distance != b.distance ? a.distance < b.distance : a.face < b.face;
}

}  // namespace formwright
