// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What later measurements need to know of a plan: how each triangle of the design was turned on its sheet, and how far
// apart the numbered marks are.
#include <string>
#include <vector>

#include "base/bytes.h"

namespace formwright {

struct PlanRecord {
  double marker_spacing_mm = 30;
  std::vector<double> turn_of_triangle_rad;  // counter-clockwise, from the flat ribbon to the sheet
};

std::string write_plan_record(const PlanRecord& record);

/// Throws Error{invalid_input, where}: not such a file, or not of a design with this many triangles.
PlanRecord read_plan_record(ByteView json, std::size_t triangles, const std::string& where);

}  // namespace formwright
