// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Fits some of a forward model's parameters to its data: Levenberg and Marquardt with secant sensitivities, since a simulation with
// contact has no derivative worth the name at the scale of round-off.
#include <memory>
#include <vector>

#include "evidence/simulation_bag.h"

namespace formwright {

/// Sensitivities of one object: for each free parameter, n x d, per unit of u.
using Sensitivities = std::vector<Eigen::MatrixXd>;

/// measured - predicted, each object.
Predictions residuals(const ForwardModel& model, const Predictions& predictions);

/// What a fit makes small.
class FitObjective {
 public:
  virtual ~FitObjective() = default;
  virtual double value(const Predictions& residuals, const Eigen::VectorXd& u) const = 0;
  /// Quadratic model about u for steps of the `free` parameters: value + g^T s + s^T H s / 2, H positive semi-definite.
  virtual void quadratic(const Predictions& residuals, const std::vector<Sensitivities>& sensitivities, const std::vector<int>& free, const Eigen::VectorXd& u,
                         Eigen::VectorXd& g, Eigen::MatrixXd& H) const = 0;
};

/// The thesis's error, the mean Euclidean distance of all points, rounded off below `soft` (the noise): mean sqrt(|r|^2 + soft^2) - soft. A weak
/// pull of the priors decides where the data say nothing.
std::unique_ptr<FitObjective> mean_distance_objective(const ForwardModel& model, double soft);

/// s that minimises g^T s + s^T H s / 2 with low <= s <= high; H positive definite, small. By active sets.
Eigen::VectorXd bounded_step(const Eigen::MatrixXd& H, const Eigen::VectorXd& g, const Eigen::VectorXd& low, const Eigen::VectorXd& high);

struct FitOptions {
  int most_iterations = 12;
  double tolerance = 2e-3;          // relative gain below which the fit has converged
  bool renew_sensitivities = true;  // take them afresh where secants lead nowhere; otherwise stop there
};

struct ParameterFit {
  Eigen::VectorXd u;                        // all parameters
  Predictions predictions;                  // at u
  std::vector<Sensitivities> sensitivities; // each object, of the free parameters, near u
  std::vector<int> free;
  double value = 0;
};

/// One object's sensitivities to `free` at `u`, by steps of the parameters' probes: to both sides where the range allows it.
/// Throws Error{could_not_solve} where the model has no answer on either side.
std::vector<Sensitivities> sensitivities_at(SimulationBag& bag, const Eigen::VectorXd& u, const Predictions& at_u, const std::vector<int>& free, Context& context,
                                            const std::string& stage);

/// Starts from `start`, whose predictions must exist (else Error{could_not_solve}). `known`: sensitivities to begin with, may be empty.
ParameterFit fit_parameters(SimulationBag& bag, const FitObjective& objective, const std::vector<int>& free, const Eigen::VectorXd& start,
                            std::vector<Sensitivities> known, const FitOptions& options, Context& context, const std::string& stage);

}  // namespace formwright
