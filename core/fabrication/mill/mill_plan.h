// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// From a height field to a mill's job, and what it leaves.
#include <optional>

#include "fabrication/mill/mill_tool.h"
#include "fabrication/toolpath/toolpath.h"

namespace formwright {

/// Of the carved surface over the one wanted, at the nodes of the grid; never negative.
struct Deviation {
  double mean_mm = 0, p95_mm = 0, max_mm = 0;
};

struct MillPlan {
  Toolpath path;  // in stages where there is a tool for roughing and another one for finishing
  HeightField carved;
  Deviation deviation;
  std::optional<Deviation>
      of_tool;  // what the tool's shape alone leaves, with lines at every node; absent where it would take too long
  double finish_stepover_mm = 0;
  int layers = 0;  // of roughing
  double rough_seconds = 0, finish_seconds = 0;
  std::vector<std::string> misfits, notes;
};

/// `surface` has z <= 0 everywhere. Roughing in layers, each cut where the layer above left something, following the
/// surface with the allowance kept; finishing line by line with the tip as low as the surface lets it. The tip runs
/// from node to node, kept off steep walls by a node's distance (swept_footprint), and is raised where it would cut in
/// halfway between two. What is left of cutting in is at most (p/2)^2 / 8 of a ball's second derivative, 0.6 um for 3
/// mm on a grid of p = 0.1 mm, and p/16 of a V's slope. Entries go down along the path on a ramp where there is room
/// for one. Throws Error: invalid_input ("diameter_mm": over 4,000 nodes across), cancelled.
MillPlan plan_mill_job(const HeightField& surface, const MillOptions& options, Context& context);

/// Of `carved` over `wanted`, with the same nodes.
Deviation deviation_of(const HeightField& carved, const HeightField& wanted);

}  // namespace formwright
