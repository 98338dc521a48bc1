// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How strong the named causes are, once more, with secants as wide as the causes are strong. For diagnosis.cpp.
//
// A fit moves by steps, and takes its secants over them. A sheet that sticks to a mould answers to a small step with
// leaps of its own. They make the sensitivities look larger than they are, so that the fit stops short of the strength
// (errors in the variable, [Ful87] 1.1). From no cause to the whole of it the movement is large beside the leaps.
#include <optional>
#include <vector>

#include "evidence/explanations/explanations.h"

namespace formwright {

inline constexpr const char* measuring_strengths = "Measuring how sure the strengths are";

/// A discrepancy parameter that is turned on by one of its units: an equally good simulation.
using OtherSimulation = std::optional<int>;

/// All parameters' coordinates after one step from where `causes` were fitted (Explanations::refit_of, with `bag`), of
/// base parameters and theirs, bounded by the parameters' ranges alone. Simulates once for each of the causes'
/// parameters, and once more with another simulation; empty where the model has no answer. Throws Error{cancelled}.
std::optional<Eigen::VectorXd> step_on_wide_secants(SimulationBag& bag, const Explanations& tried,
                                                    const std::vector<int>& causes, OtherSimulation other,
                                                    Context& context);

}  // namespace formwright
