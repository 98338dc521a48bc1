// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Pins and sockets on the faces where a mould is cut.
#include <array>
#include <vector>

#include "base/context.h"
#include "geometry/booleans/booleans.h"
#include "geometry/mesh/measures.h"

namespace formwright {

/// A pin across the cut between cell `lower` and the next one along `axis`, which fits into a socket on the other side.
struct RegistrationKey {
  int axis = 0;
  std::array<int, 3> lower{};
  Vec3 centre_mm = Vec3::Zero();  // on the cut
  double diameter_mm = 4;
  bool points_down = false;  // from the next cell into `lower`, rather than up
};

/// How far a pin of this diameter stands out: as far as it is wide.
constexpr double pin_length_mm(double diameter_mm) { return diameter_mm; }

/// Up to two keys for each pair of neighbouring cells of `box`, as far apart as they go, where they and a margin of
/// 0.8 mm lie within `solid`; three quarters or half as large where the full size does not fit. None for diameter 0.
/// Parts stand on a flat side when pins along z point up as printed: `upside_down` parts have them point down.
std::vector<RegistrationKey> find_keys(const TriangleMesh& solid, const BoundingBox& box,
                                       const std::array<int, 3>& cells, double diameter_mm, double clearance_mm,
                                       bool upside_down, Context& context);

/// The part of one cell with its pins added and its sockets, wider and deeper by `clearance_mm`, taken out.
ExactSolid with_keys(const ExactSolid& part, const std::array<int, 3>& cell, const std::vector<RegistrationKey>& keys,
                     double clearance_mm, int& pins, int& sockets, Context& context);

}  // namespace formwright
