// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Thermoforming, thesis chapter 4.
#include "job/contract/operation.h"

namespace formwright {
Operation thermoform_simulate_operation();  // the sheet, formed
Operation thermoform_texture_operation();   // the print that lands on it
Operation thermoform_mould_operation();     // what it is formed over
Operation thermoform_compare_operation();   // against measured points
}  // namespace formwright
