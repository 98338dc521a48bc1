// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a diagnosis is compared with: the cause whose sensitivity points most nearly along the residual of the
// calibrated simulation. It knows the same noise and the same sensitivities, and nothing of explanations.
#include <string>
#include <utility>
#include <vector>

#include "evidence/diagnosis/explanations.h"

namespace formwright {

/// Every cause with its cosine, the largest first: between the residual and the nearest direction of what the cause
/// does, both without what the base parameters can do, in the metric of the noise. `tried`: calibrated and screened.
std::vector<std::pair<std::string, double>> nearest_sensitivities(const ForwardModel& model, const Explanations& tried);

}  // namespace formwright
