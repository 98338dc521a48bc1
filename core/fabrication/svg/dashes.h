// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Lines broken into dashes, as stroke-dasharray breaks them (SVG 2, 13.5.6).
#include <Eigen/Geometry>
#include <vector>

#include "fabrication/svg/grammar/curve_flattening.h"

namespace formwright {

struct DashPattern {
  std::vector<double> lengths;  // dash, gap, dash, gap, ...: an even number of them, not negative, of a sum above 0
  double offset = 0;            // where in the pattern a line begins
};

/// Pieces of `subpath` on its dashes; lengths are measured through `measure`, the linear map from mm to the pattern's
/// unit. Dashes of no length are left out. Throws Error{invalid_input, "drawing"}: too many dashes.
std::vector<CurveFlattener::Subpath> break_into_dashes(const CurveFlattener::Subpath& subpath,
                                                       const DashPattern& pattern, const Eigen::Matrix2d& measure,
                                                       DrawingLimits& limits);

}  // namespace formwright
