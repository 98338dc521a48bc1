// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a fit makes small.
#include <memory>
#include <vector>

#include "evidence/fit/probing.h"

namespace formwright {

/// measured - predicted, each object.
Predictions residuals(const ForwardModel& model, const Predictions& predictions);

class FitObjective {
 public:
  virtual ~FitObjective() = default;
  virtual double value(const Predictions& residuals, const Eigen::VectorXd& u) const = 0;
  /// Quadratic model about u for steps of the `free` parameters: value + g^T s + s^T H s / 2, H positive semi-definite.
  virtual void quadratic(const Predictions& residuals, const std::vector<Sensitivities>& sensitivities,
                         const std::vector<int>& free, const Eigen::VectorXd& u, Eigen::VectorXd& g,
                         Eigen::MatrixXd& H) const = 0;
};

/// The thesis's error, the mean Euclidean distance of all points, rounded off below `soft` (the noise): mean sqrt(|r|^2
/// + soft^2) - soft. A weak pull of the priors decides where the data say nothing.
std::unique_ptr<FitObjective> mean_distance_objective(const ForwardModel& model, double soft);

}  // namespace formwright
