// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The job as a picture: the bed, its no-go zones, what is worked and the travel between.
#include "fabrication/toolpath/toolpath.h"

namespace formwright {

/// SVG of the bed's size, 1 user unit = 1 mm; groups bed, no-go, travel and one for each layer.
Bytes write_toolpath_svg(const Toolpath& path, const MachineOptions& machine);

}  // namespace formwright
