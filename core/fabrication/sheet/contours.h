// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Paths of a drawing made ready to run: ends joined, doubles dropped, what contains what, kerf.
#include <string>
#include <vector>

#include "base/context.h"
#include "fabrication/sheet/cut_sheet.h"
#include "fabrication/planar/polygon.h"

namespace formwright {

struct TidiedPaths {
  std::vector<CutPath> paths;
  int doubles_dropped = 0;  // drawn twice on the same layer, in either direction
  int ends_joined = 0;
};

/// Drops paths that lie exactly (to 1 um) on another one of their layer, and joins open paths of a layer whose ends are
/// at most `join_mm` apart, the nearest ends first. A joined path has the name of its first one.
TidiedPaths tidy_paths(const std::vector<CutPath>& paths, double join_mm, const Context& context);

/// For every path, the smallest closed path among `containers` (indices into `paths`) that it lies in; -1: none. Paths
/// that cross each other count by where most of their points are.
std::vector<int> containing_contours(const std::vector<CutPath>& paths, const std::vector<int>& containers,
                                     const Context& context);

/// The polygon with its edge moved outwards by `outward_mm` (inwards when negative), corners rounded where they open:
/// exact to `tolerance_mm`. Shrinking can leave several polygons, or none; growing can close a bay's mouth, and what is
/// left of the bay is a polygon of its own, clockwise where the others are counter-clockwise. The polygon may cross
/// itself: what it winds around counts as its inside. Each starts at the corner nearest to the first point of the
/// polygon.
std::vector<Polygon> offset_polygon(const Polygon& polygon, double outward_mm, double tolerance_mm = 0.002);

/// Is p inside, by the even-odd rule?
bool contains(const Polygon& polygon, const Vec2& p);

double path_length_mm(const std::vector<Vec2>& points, bool closed);

}  // namespace formwright
