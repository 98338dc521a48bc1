// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a diagnosis predicts of objects that it has not seen.
#include "evidence/diagnosis/diagnosis.h"

namespace formwright {

struct UnseenObjects {
  HeldOutGain gain;                      // errors of the calibrated and of the extended model, and what they fell by
  Predictions base, extended;            // of each object, by these two
  std::vector<Eigen::VectorXd> weights;  // of each point, inverse variances; 0 for outliers
};

/// Errors on objects that were not used, by the calibrated and the extended model, simulated as finely as what was
/// decided. `found` is in coordinates of `from`, whose parameters have the same names as those of `unseen`. Throws
/// Error{could_not_solve, cancelled}.
UnseenObjects predict_unseen(const ForwardModel& unseen, const ForwardModel& from, const Diagnosis& found,
                             Context& context);

}  // namespace formwright
