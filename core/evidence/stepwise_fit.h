// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Levenberg and Marquardt with secants (Broyden 1965), one simulation at a time: a fit says which simulations it wants
// next, so that several fits go on side by side, and those that fall too far behind are left where they are.
#include <span>

#include "evidence/parameter_fit.h"

namespace formwright {

class StepwiseFit {
 public:
  /// Begins at the best of `starts`. `known`: sensitivities to begin with, each object, in the order of `free`; empty:
  /// taken there. `model` and `objective` must outlive it.
  StepwiseFit(const ForwardModel& model, const FitObjective& objective, std::vector<int> free,
              const std::vector<Eigen::VectorXd>& starts, std::vector<Sensitivities> known, const FitOptions& options);

  /// Where the model is to be asked next; none once the fit is done.
  const std::vector<Eigen::VectorXd>& wanted() const { return wanted_; }
  bool done() const { return wanted_.empty(); }
  /// The model's answers to wanted(). Throws Error{could_not_solve} where it has none at any start, or to either side
  /// of it.
  void take(const std::vector<std::optional<Predictions>>& answers);
  /// Leaves the fit where it is.
  void stop() { wanted_.clear(); }

  const ParameterFit& fit() const { return fit_; }
  int iterations() const { return iterations_; }
  /// What the quadratic model hopes to gain by the next step.
  double hoped_gain() const { return hoped_gain_; }

 private:
  enum class Stage { starting, probing, long_step, short_step };

  void probe();
  /// Wants the step that the quadratic model has at damping_, or `shorter`; is done where that is not worth a
  /// simulation.
  void propose(bool shorter);
  void step_taken(const std::optional<Predictions>& answer);
  double enough() const;

  const ForwardModel& model_;
  const FitObjective& objective_;
  FitOptions options_;
  Stage stage_ = Stage::starting;
  ParameterFit fit_;
  std::vector<Eigen::VectorXd> wanted_;
  Eigen::VectorXd probe_;
  double damping_, hoped_gain_ = 0;
  int iterations_ = 0, small_gains_ = 0, renewals_ = 0;
  bool fresh_ = false;
};

/// Points that tell the sensitivities to `free` at u, both sides of each (discrepancies, which are switches: one), and
/// the sensitivities from the model's answers. Throws Error{could_not_solve} where there is none on either side.
std::vector<Eigen::VectorXd> probe_points(const ForwardModel& model, const Eigen::VectorXd& u,
                                          const std::vector<int>& free);
std::vector<Sensitivities> sensitivities_from(const ForwardModel& model, const Eigen::VectorXd& u,
                                              const Predictions& at_u, const std::vector<int>& free,
                                              const std::vector<Eigen::VectorXd>& points,
                                              const std::vector<std::optional<Predictions>>& answers);

/// The least change of sensitivities to `free`, in units of the probes, that accounts for what a step (of all
/// parameters) did: Broyden's good update.
void broyden_update(const ForwardModel& model, std::vector<Sensitivities>& sensitivities, const std::vector<int>& free,
                    const Predictions& before, const Predictions& after, const Eigen::VectorXd& step);

/// Runs all fits to their ends. One whose value, less twice the gain it hopes for, stays more than `reach` above the
/// lowest of all (and of `lowest`) after two steps is stopped: what it lacks is not made up for.
void run_side_by_side(SimulationBag& bag, std::span<StepwiseFit> fits, double lowest, double reach, Context& context,
                      const std::string& stage);

}  // namespace formwright
