// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a forward model does around a place: secants over steps to both sides, since a simulation with contact has no
// derivative worth the name at the scale of round-off.
#include "evidence/fit/simulation_bag.h"

namespace formwright {

/// Sensitivities of one object: for each free parameter, n x d, per unit of u.
using Sensitivities = std::vector<Eigen::MatrixXd>;

/// Slopes, and for each parameter that was stepped to both sides half the second difference, n x d: by how much a
/// prediction misses the secant. It is small for what is smooth, and large where a simulation jumps, as a sheet that
/// snaps into a corner.
struct Probing {
  std::vector<Sensitivities> sensitivities;         // each object, of the probed parameters
  std::vector<std::vector<Eigen::MatrixXd>> bends;  // each object
};

/// A probing that says what it wants simulated next, so that several may share a batch.
class ProbingInProgress {
 public:
  /// Steps of the parameters' probes from `u`, to both sides where the range allows it.
  ProbingInProgress(const ForwardModel& model, Eigen::VectorXd u, std::vector<int> free);
  /// Empty: finished.
  const std::vector<Eigen::VectorXd>& wanted() const { return wanted_; }
  /// What the model predicts at wanted(), empty where it has no answer.
  void take(std::vector<std::optional<Predictions>> made);
  /// When finished. Throws Error{could_not_solve} where the model has no answer on either side of a parameter.
  Probing result(const Predictions& at_u) const;

 private:
  bool has_answer(std::size_t i) const { return predictions_[i] && points_[i] != u_; }

  const ForwardModel& model_;
  Eigen::VectorXd u_;
  std::vector<int> free_;
  std::vector<Eigen::VectorXd> points_;  // upper and lower of each parameter
  std::vector<std::optional<Predictions>> predictions_;
  std::vector<Eigen::VectorXd> wanted_;
  std::vector<std::size_t> again_;  // of points_, that wanted_ are once shortened
};

/// Probes at once.
Probing probe_around(SimulationBag& bag, const Eigen::VectorXd& u, const Predictions& at_u,
                     const std::vector<int>& free, Context& context, const std::string& stage);

/// The slopes alone.
std::vector<Sensitivities> sensitivities_at(SimulationBag& bag, const Eigen::VectorXd& u, const Predictions& at_u,
                                            const std::vector<int>& free, Context& context, const std::string& stage);

/// Of `all`, in the order of `columns`, those of `wanted`.
std::vector<Sensitivities> sensitivities_of(const std::vector<int>& wanted, const std::vector<Sensitivities>& all,
                                            const std::vector<int>& columns);
std::vector<Sensitivities> side_by_side(std::vector<Sensitivities> a, const std::vector<Sensitivities>& b);
std::vector<int> joined(std::vector<int> a, const std::vector<int>& b);

}  // namespace formwright
