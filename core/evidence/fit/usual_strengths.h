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

/// All of `causes` at half, once and twice their usual strength beside the set-up's own material: fits start there.
std::vector<Eigen::VectorXd> strengths_to_start_from(const ForwardModel& model, const std::vector<int>& causes);

/// One cause of one sign beside the set-up's own material.
struct StrongCause {
  int cause = 0;
  Eigen::VectorXd u;
  Predictions predictions;  // at u
};

/// A strong cause of one sign drags a calibration so far off that no sensitivity there points back. Where much is left
/// by the calibrated model (`calibrated`, the value of `objective` there): of all such causes at
/// strengths_to_start_from(), the one that leaves least, if that is less than half as much. Simulates these. Throws
/// Error{cancelled}.
std::optional<StrongCause> strong_cause_instead_of(double calibrated, SimulationBag& bag, const FitObjective& objective,
                                                   Context& context, const std::string& stage);

}  // namespace formwright
