// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Lines of a raster over a height field as moves of a mill.
#include "fabrication/mill/mill_tool.h"
#include "fabrication/toolpath/toolpath.h"

namespace formwright {

inline constexpr float no_tip = 3.0e38f;  // of a node that the tool's tip does not run over

/// A stretch of one row that is run at one go.
struct MillRun {
  int row, from, to;  // columns, both included, from <= to
};

struct MillMotion {
  const MillOptions& options;
  bool transposed;    // rows of the field run along y
  std::string layer;  // "rough", "finish"
  double speed_mm_per_s;
};

/// Runs everything at the tips' heights or up to `path_tolerance_mm` above: to and fro, from one stretch to the next
/// along the surface where they are neighbours and over the safe height where they are not. `tips` has a height for
/// every node, also between stretches. `material_mm`: how high the material stands at most; entries ramp down from
/// there. `been` is lowered to where the tip has run over nodes.
void run_lines(ToolpathBuilder& builder, const HeightField& tips, const std::vector<MillRun>& runs, int stepover_rows,
               double material_mm, int pass, const MillMotion& motion, HeightField& been);

/// The same path with fewer points: nowhere below the line through `points`, at most `tolerance_mm` above each of them.
/// Every point stands over one of `points`, rounded up to whole micrometres; both ends are just those. A hill of radius
/// R is left by pieces of sqrt(8 R tolerance), tangents to it, which needs points that may rise. Needs at least one
/// point.
std::vector<Vec3> thinned(const std::vector<Vec3>& points, double tolerance_mm);

}  // namespace formwright
