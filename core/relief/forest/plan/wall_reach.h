// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How far a relief may stand before the surface of its pillar and be carved into it, along a ray: eq. (3.10).
#include "relief/forest/plan/pillar.h"
#include "relief/forest/plan/plan_view.h"

namespace formwright {

/// Distances ahead on one ray, near <= surface <= far < exit.
struct WallReach {
  double near = 0, surface = 0, far = 0, exit = 0;
};

/// Of the ray with tangent t, which meets `edge` first. `near` and `far` are where the ray, followed from the surface,
/// gets farther from the outline than `above_mm` outside and `below_mm` inside; so both hold exactly at corners and on
/// round pillars, too. `far` is at most two fifths of the way to `exit`, where the ray leaves the pillar: carving never
/// cuts through.
WallReach wall_reach(const PlanView& view, const Pillar& pillar, int edge, double t, double above_mm, double below_mm);

}  // namespace formwright
