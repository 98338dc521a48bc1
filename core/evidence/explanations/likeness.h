// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How nearly each cause alone points along what the calibrated simulation leaves: what a diagnosis without explanations
// would go by. docs/confusion_table.md compares with it.
#include <vector>

#include "evidence/fit/forward_model.h"
#include "evidence/fit/structured_misfit.h"

namespace formwright {

/// Of every cause, the cosine between the residual and the nearest direction of what the cause does, both without what
/// the base parameters can do, in the metric of the noise. `gram`: of the residual of a calibrated model, with its
/// sensitivities to all parameters in their order; more columns may follow.
std::vector<double> likenesses(const ForwardModel& model, const GramByStructure& gram);

}  // namespace formwright
