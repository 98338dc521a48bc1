// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "evidence/diagnosis/separation.h"
#include "evidence/models/zippable/zippable_model.h"

namespace formwright {

/// What could be measured beside what was: lengths on the flat pieces, and more lengths of the zipped object. Throws
/// Error{could_not_solve, cancelled}.
std::vector<ProposedMeasurement> proposed_measurements(const ZippableModel& model, Context& context);

}  // namespace formwright
