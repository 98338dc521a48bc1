// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a viewpoint sees of pillars in the floor plan: which edge of which outline each of its rays meets first. Pillars
// are prisms, so that this is the same at every height below their tops. Thesis, Fig. 3.13.
#include <span>
#include <vector>

#include "base/context.h"
#include "relief/forest/plan/pillar.h"
#include "relief/forest/plan/plan_view.h"

namespace formwright {

/// Part of one edge of an outline, as a viewpoint sees it: rays of tangents `from` to `to`.
struct WallStrip {
  int pillar = 0, edge = 0;
  double from = 0, to = 0;
};

/// In order of tangents; between strips rays meet nothing. Exact up to round-off: borders are tangents of corners.
/// Outlines must not touch each other. What is nearer than a thousandth of a millimetre ahead, or behind, is not seen.
/// Throws Error: cancelled.
std::vector<WallStrip> seen_walls(const PlanView& view, std::span<const Pillar> pillars, const Context& context);

/// Place on its edge, from 0 to 1, of the ray with tangent t.
double place_on_edge(const PlanView& view, const Pillar& pillar, int edge, double t);

}  // namespace formwright
