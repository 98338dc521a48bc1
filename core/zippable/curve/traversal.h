// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The order in which the curve visits the parts, and where it crosses from one into the next: thesis Sec. 5.2.3.
#include <vector>

#include "base/context.h"
#include "zippable/chart/parameterisation.h"
#include "zippable/parts/segmentation.h"

namespace formwright {

struct Traversal {
  std::vector<int> parts;       // every part once
  std::vector<int> interfaces;  // between consecutive parts; one less
};

/// All Hamiltonian paths over the parts, each in both directions, leaving every part by another interface than the one
/// it was entered by; at most `limit`, in lexicographic order, of those that three million steps find. One part alone
/// gives one path. Throws cancelled.
std::vector<Traversal> traversals(const Segmentation& segmentation, const Context& context, int limit = 2000);

struct Crossings {
  /// Per interface passed: the distance in mm from the interface's first end.
  std::vector<double> along_mm;
  /// Per part passed: x of the entry and of the exit on its lower line, exit in (entry, entry + period]; the first part
  /// has no entry and the last no exit (0).
  std::vector<double> entry_mm, exit_mm;
  /// Mean of ((exit - entry) / period - 1/2)^2 over the parts between the first and the last: eq. (5.7), 0 is even.
  double unevenness = 0;
};

/// Minimises (5.7) exactly: a convex problem with bounds that keep `margin` (a share) off either end of each interface;
/// where it leaves a freedom, the middle.
Crossings best_crossings(const Segmentation& segmentation, const Parameterisation& parameterisation,
                         const Traversal& traversal, double margin = 0.1);

struct LinePoint {
  int part = 0;
  double x_mm = 0;  // in [0, period)
};

/// The same surface point on the lower line of the part beyond the interface that lies there. Needs at least two parts.
LinePoint across_interface(const Segmentation& segmentation, const Parameterisation& parameterisation, LinePoint point);

struct RankedTraversal {
  Traversal traversal;
  Crossings crossings;
  double cost = 0;
};

/// The even ones first; the cost is unevenness plus a penalty where an interface is short against the ribbon's width.
std::vector<RankedTraversal> ranked_traversals(const Segmentation& segmentation,
                                               const Parameterisation& parameterisation, double width_mm,
                                               const Context& context, int limit = 2000);

}  // namespace formwright
