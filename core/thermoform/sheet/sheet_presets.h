// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/data/presets.h"

namespace formwright {

/// Vacuum formers and plastics as values of ThermoformOptions, to begin with. The first of each list holds the
/// defaults.
std::vector<PresetList> sheet_presets();

}  // namespace formwright
