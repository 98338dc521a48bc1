// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What was found of every cause of the list, before any is named. For diagnosis.cpp.
#include "evidence/diagnosis/diagnosis.h"
#include "evidence/explanations/explanations.h"

namespace formwright {

/// In the order of the model's causes; intervals by what the fit alone knows. `tried`: screened and refitted; `base`:
/// calibrated without causes. Throws Error{cancelled}.
std::vector<CauseFinding> cause_findings(Explanations& tried, const ParameterFit& base);

/// Values of its parameters, and its strength, at u.
void set_values(const ForwardModel& model, const Eigen::VectorXd& u, CauseFinding& finding);

}  // namespace formwright
