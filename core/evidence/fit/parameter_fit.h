// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Fits some of a forward model's parameters to its data: Levenberg and Marquardt with secant sensitivities, since a
// simulation with contact has no derivative worth the name at the scale of round-off.
#include <memory>
#include <vector>

#include "evidence/fit/simulation_bag.h"

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
  virtual void quadratic(const Predictions& residuals, const std::vector<Sensitivities>& sensitivities,
                         const std::vector<int>& free, const Eigen::VectorXd& u, Eigen::VectorXd& g,
                         Eigen::MatrixXd& H) const = 0;
};

/// The thesis's error, the mean Euclidean distance of all points, rounded off below `soft` (the noise): mean sqrt(|r|^2
/// + soft^2) - soft. A weak pull of the priors decides where the data say nothing.
std::unique_ptr<FitObjective> mean_distance_objective(const ForwardModel& model, double soft);

/// s that minimises g^T s + s^T H s / 2 with low <= s <= high; H positive definite, small. By active sets.
Eigen::VectorXd bounded_step(const Eigen::MatrixXd& H, const Eigen::VectorXd& g, const Eigen::VectorXd& low,
                             const Eigen::VectorXd& high);

struct FitOptions {
  int max_iterations = 12;
  double tolerance = 2e-3;          // relative gain below which the fit has converged
  bool renew_sensitivities = true;  // take them afresh where secants lead nowhere; otherwise stop there
};

/// For searching: a handful of steps on the sensitivities that are known.
inline constexpr FitOptions quick_fit{5, 0.01, false};

struct ParameterFit {
  Eigen::VectorXd u;                         // all parameters
  Predictions predictions;                   // at u
  std::vector<Sensitivities> sensitivities;  // each object, of the free parameters, near u
  std::vector<int> free;
  double value = 0;
};

/// What the model does around a place: slopes, and for each parameter that was stepped to both sides half the second
/// difference, n x d: by how much a prediction misses the secant. It is small for what is smooth, and large where a
/// simulation jumps, as a sheet that snaps into a corner.
struct Probing {
  std::vector<Sensitivities> sensitivities;         // each object, of the probed parameters
  std::vector<std::vector<Eigen::MatrixXd>> bends;  // each object
};

/// Steps of the parameters' probes from `u`, to both sides where the range allows it.
/// Throws Error{could_not_solve} where the model has no answer on either side.
Probing probe_around(SimulationBag& bag, const Eigen::VectorXd& u, const Predictions& at_u,
                     const std::vector<int>& free, Context& context, const std::string& stage);

/// The slopes alone.
std::vector<Sensitivities> sensitivities_at(SimulationBag& bag, const Eigen::VectorXd& u, const Predictions& at_u,
                                            const std::vector<int>& free, Context& context, const std::string& stage);

/// Starts from `start`, whose predictions must exist (else Error{could_not_solve}). `known`: sensitivities to begin
/// with, may be empty.
ParameterFit fit_parameters(SimulationBag& bag, const FitObjective& objective, const std::vector<int>& free,
                            const Eigen::VectorXd& start, std::vector<Sensitivities> known, const FitOptions& options,
                            Context& context, const std::string& stage);

/// `from`, moved to `to` in the parameters `free`, but by three probes each at most: secants hold no farther, and a
/// longer distance is covered in steps.
Eigen::VectorXd towards(const ForwardModel& model, const std::vector<int>& free, const Eigen::VectorXd& from,
                        const Eigen::VectorXd& to);

/// The same from the best of `starts`, none where the model has no answer.
ParameterFit fit_from_best(SimulationBag& bag, const FitObjective& objective, const std::vector<int>& free,
                           const std::vector<Eigen::VectorXd>& starts, std::vector<Sensitivities> known,
                           const FitOptions& options, Context& context, const std::string& stage);

/// Of `all`, in the order of `columns`, those of `wanted`.
std::vector<Sensitivities> sensitivities_of(const std::vector<int>& wanted, const std::vector<Sensitivities>& all,
                                            const std::vector<int>& columns);
std::vector<Sensitivities> side_by_side(std::vector<Sensitivities> a, const std::vector<Sensitivities>& b);
std::vector<int> joined(std::vector<int> a, const std::vector<int>& b);

}  // namespace formwright
