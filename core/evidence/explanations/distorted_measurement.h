// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a scanner out of order may do that is in no list: stretch, skew, turn and shift all measured points alike.
#include <optional>

#include "evidence/fit/hypotheses.h"
#include "evidence/fit/structured_objective.h"

namespace formwright {

/// A model and what its parameters do at one place u.
struct LinearModel {
  Predictions predictions;                   // at u
  std::vector<Sensitivities> sensitivities;  // each measurement, of all parameters in their order
  Eigen::VectorXd u;
};

/// Any affine map of the measured points instead of a cause: y + A (y - centre) + t, twelve numbers that are fitted
/// together with the base parameters.
struct DistortedMeasurement {
  std::vector<double> similarity;  // of every cause with it, as similarity() of hypotheses.h has it
  double log_evidence = 0;         // the largest about any of the linear models
};

/// Empty where no places in space were measured. `models`: at least one; similarities are those about the first, with
/// structure of size structure_sizes(model)[structure].
std::optional<DistortedMeasurement> distorted_measurement(const ForwardModel& model, const MisfitOfAll& misfit,
                                                          const std::vector<LinearModel>& models,
                                                          std::size_t structure);

}  // namespace formwright
