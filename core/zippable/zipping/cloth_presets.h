// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/data/presets.h"

namespace formwright {

/// Cloths as values of ZippingOptions, to begin with: orders of magnitude, taken from no single table. Cloths of one
/// name differ by a factor of two and more.
PresetList cloth_presets();

}  // namespace formwright
