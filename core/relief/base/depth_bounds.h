// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How far each vertex of a relief may stand before its base and be carved into it: eq. (3.10) along its ray.
#include <vector>

#include "base/context.h"
#include "relief/base/base_surface.h"
#include "relief/painting/painting.h"
#include "relief/view/relief_options.h"
#include "relief/view/visibility.h"

namespace formwright {

struct DepthBounds {
  Eigen::VectorXd nearest, farthest;  // n, depth z in view coordinates, nearest <= farthest
  std::vector<char> bounded;          // n, 1 where they hold
  int missed = 0;                     // vertices whose rays miss the base; they are free
  std::vector<int> group;             // n, which bounds move together, eq. (3.11): the band or part of the base
  int groups = 1;
  bool even = false;            // all bounded vertices have the same two depths
  double above = 0, below = 0;  // how far the bounds are from the base, normalised
  // Where limits are painted, else empty:
  Eigen::VectorXd reach;               // n, nearest depth where painting lets go of `nearest`, elsewhere `nearest`
  Eigen::VectorXd above_of, below_of;  // n, how far the bounds of each vertex are from the base

  bool painted() const { return reach.size() > 0; }
  /// The depth that the vertex may not come nearer than.
  double nearest_allowed(Eigen::Index vertex) const { return painted() ? reach[vertex] : nearest[vertex]; }
};

/// From `thickness_mm` before the base to `carve_depth_mm` behind it, both along z, for the vertices that
/// `bounded_vertices` says. On a base in steps or strips both are counted from the step or strip, along its normal.
/// On a base in parts they are counted from where the ray meets the foremost part, and carving ends half-way through
/// it. With `outline_mm` the outline keeps within that of the base, too; with `only_outline` it keeps to the base, and
/// the rest is free as if it were painted so. A vertex that is free has the bounds of the plane z = 0. Throws
/// Error{invalid_input}: rays miss the base and `base_misses` refuses that; none meets it; the base or the relief
/// reaches more than half-way to the viewpoint. `painting`: of the same vertices. What it says of a vertex goes before
/// the options, also where it is hidden. A vertex painted free may miss the base.
DepthBounds depth_bounds(const ViewFrame& frame, const Visibility& visibility, const BaseSurface& base,
                         const ReliefOptions& options, Context& context, const Painting& painting = {});

}  // namespace formwright
