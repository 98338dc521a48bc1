// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "evidence/diagnosis/separation.h"
#include "evidence/models/thermoform/thermoform_model.h"

namespace formwright {

/// Measurements a maker could add to those of `model`: the same mould with the sheet turned, the mould turned, a higher
/// mould.
std::vector<ProposedMeasurement> proposed_measurements(const ThermoformModel& model,
                                                       const ThermoformModelOptions& options);

}  // namespace formwright
