// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a cause of one sign does: at zero it has a derivative on one side only, and that says little.
#include "evidence/fit/parameter_fit.h"

namespace formwright {

/// `sensitivities` (each object, of all parameters, about nominal()), those of effects of one sign replaced by what
/// their usual strength does, per unit of u. `at_nominal`: predictions there. Simulates these; where the model has no
/// answer, the given sensitivity stays. Throws Error{cancelled}.
std::vector<Sensitivities> at_usual_strengths(SimulationBag& bag, const Predictions& at_nominal,
                                              std::vector<Sensitivities> sensitivities, Context& context,
                                              const std::string& stage);

}  // namespace formwright
