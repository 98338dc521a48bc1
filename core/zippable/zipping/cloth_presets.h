// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/data/presets.h"

namespace formwright {

/// Cloths as values of ZippingOptions, to begin with: orders of magnitude from tables of measured fabrics (Kawabata,
/// The Standardization and Analysis of Hand Evaluation, 1980), where cloths of one name differ by a factor of two.
PresetList cloth_presets();

}  // namespace formwright
