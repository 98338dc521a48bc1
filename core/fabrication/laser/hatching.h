// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Closed shapes filled with parallel lines.
#include <vector>

#include "base/context.h"
#include "fabrication/planar/polygon.h"

namespace formwright {

/// Lines along x through what an odd number of the shapes covers, `spacing_mm` apart, the first one half of it above
/// the lowest point; run to and fro. Throws Error{invalid_input, "engrave_line_mm"} for over 200,000 lines.
std::vector<std::vector<Vec2>> hatch(const std::vector<Polygon>& shapes, double spacing_mm, const Context& context);

}  // namespace formwright
