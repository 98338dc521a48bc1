// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What can be explained at all. A wall of the mould is a narrow ring of the flat sheet, and where the mould is turned,
// its points lie millimetres off beside neighbours that lie right: about the calibrated model they pass for outliers,
// and with them goes what tells of it.
#include "evidence/fit/structured_objective.h"

namespace formwright {

/// Predictions moved to the data by all of `columns` at once: the robust linear fit (Student's t, so that outliers do
/// not bend it) with the parameters' priors, and structure of the known misfit. `sensitivities`: each object, of
/// `columns`, where `predictions` are. What is left of the data is noise and outliers, or of no cause that the model
/// knows. Every object has at least one point. No simulations; throws nothing.
Predictions freely_fitted(const ForwardModel& model, const Predictions& predictions, const std::vector<int>& columns,
                          const std::vector<Sensitivities>& sensitivities);

}  // namespace formwright
