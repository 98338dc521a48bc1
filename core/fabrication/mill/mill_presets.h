// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/data/presets.h"

namespace formwright {

/// What is carved, as values of MillOptions, to begin with: for carbide tools 3 mm wide with two edges on light mills,
/// at 0.03 to 0.09 mm of chip for each edge and turn. The first holds the defaults.
PresetList mill_material_presets();

}  // namespace formwright
