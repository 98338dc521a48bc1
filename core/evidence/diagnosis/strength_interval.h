// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// 95 % intervals of strengths: what the fit knows, and what equally good simulations make of it. For diagnosis.cpp.
#include "evidence/diagnosis/diagnosis.h"
#include "evidence/explanations/explanations.h"

namespace formwright {

double half_width(const CauseFinding& finding);
void set_half_width(CauseFinding& finding, double half);

/// By how much the cause changes what set-up, profile and chosen simulation already have of it.
double change(const ForwardModel& model, const CauseFinding& finding);

/// How many times as strong the cause is at `u` as at `from`, along its parameters there; at least a tenth, at most ten
/// times: beyond that one of the two has not found the cause.
double strength_factor(const ForwardModel& model, int cause, const Eigen::VectorXd& from, const Eigen::VectorXd& u);

/// By what leaving out a quarter of the data changes: that knows of misfits that no prior has. `extended`: the fit that
/// was held out; `steps`: HeldOut's.
void widen_by_jackknife(const ForwardModel& model, const ParameterFit& extended, const Eigen::MatrixXd& steps,
                        CauseFinding& finding);

/// With what the model itself does not know: the misfit that it is known to have can pass for half of what is just
/// visible (two of its standard deviations), and another simulation makes other movements of the same cause.
double half_width_with_model(const ForwardModel& model, const CauseFinding& finding);

/// Intervals of the named causes, by the strengths that equally good simulations find (the discrepancy parameters, each
/// by itself). What they differ by is a factor of the strength: an interval reaches farther up than down, and not to
/// zero by that alone. `tried`: what was fitted with `bag`. Throws Error{cancelled}.
void widen_by_other_simulations(Diagnosis& result, const Explanations& tried, SimulationBag& bag, Context& context);

/// What is impossible is not in the interval: a parameter has a range, and a strength of several is their length.
void keep_in_range(const ForwardModel& model, CauseFinding& finding);

}  // namespace formwright
