// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Parts as a maker draws them: curves on the surface through a few points each, closed or from one curve to another.
#include <optional>
#include <vector>

#include "base/context.h"
#include "zippable/parts/feature_lines.h"
#include "zippable/parts/surface_split.h"

namespace formwright {

struct DrawnCurve {
  std::vector<Vec3> points;  // on or near the surface
  bool closed = false;
  std::optional<bool> snap = {};  // to features; none: as the maker wants it for all
};

/// What curves may snap to.
struct SnapTargets {
  FeatureLines features;   // of the mesh that is divided
  double reach_mm = 5;     // how far a point may be moved onto a feature line
  bool by_default = true;  // for curves that do not say it
};

/// Straightest paths on the surface between the points bound the parts, along the nearest edges; then the borders are
/// smoothed over about two edge lengths (a step of diffusion of every part's indicator) and cut through the faces.
/// Curves join where they share a point. Labels are numbered in the order of the parts' first faces. Curves that snap
/// (`targets`, null: none can) move their points onto feature lines in reach and take the path that is shortest when
/// edges along features count for less; what runs along sharp edges keeps exactly to them. Needs a connected manifold.
/// Throws Error: invalid_input ("segments": a curve with too few points, or that divides nothing), cancelled.
LabelledSurface divide_along_curves(const TriangleMesh& mesh, const std::vector<DrawnCurve>& curves,
                                    const SnapTargets* targets, Context& context);

/// The vertex of the part that lies farthest from its border, -1 when the part has an opening of the mesh already.
int puncture_place(const LabelledSurface& surface, int label);

}  // namespace formwright
