// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Fits some of a forward model's parameters to its data: Levenberg and Marquardt with secant sensitivities [Bro65].
// Several fits go on together: each says what it wants simulated next, and all of that is one batch for all cores.
#include <functional>

#include "base/error.h"
#include "evidence/fit/fit_objective.h"

namespace formwright {

/// s that minimises g^T s + s^T H s / 2 with low <= s <= high; H positive definite, small. By active sets.
Eigen::VectorXd bounded_step(const Eigen::MatrixXd& H, const Eigen::VectorXd& g, const Eigen::VectorXd& low,
                             const Eigen::VectorXd& high);

struct FitOptions {
  int max_iterations = 12;
  double tolerance = 2e-3;          // relative gain below which the fit has converged
  bool renew_sensitivities = true;  // take them afresh, once, where the known ones lead no farther
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

struct FitProblem {
  std::shared_ptr<const FitObjective> objective;
  std::vector<int> free;                  // parameters
  std::vector<Eigen::VectorXd> starts;    // at least one: begins at the best of them that the model has an answer for
  std::vector<Sensitivities> known = {};  // to begin with; empty: taken at the start
  FitOptions options = {};
};

/// One fit that says what it wants simulated next.
class FitInProgress {
 public:
  FitInProgress(const ForwardModel& model, FitProblem problem);
  /// Empty: finished.
  const std::vector<Eigen::VectorXd>& wanted() const { return wanted_; }
  /// What it will want next where wanted() gains little: worth making by whoever is idle.
  std::vector<Eigen::VectorXd> wanted_later() const;
  /// What the model predicts at wanted(), empty where it has no answer.
  void take(std::vector<std::optional<Predictions>> made);
  /// Where it stands is its result.
  void stop() { wanted_.clear(); }

  /// False where the model has no answer at any start, or on either side of a parameter there: see why_not().
  bool has_answer() const { return fit_.u.size() > 0 && !why_not_; }
  const std::optional<Error>& why_not() const { return why_not_; }
  /// Steps that were tried.
  int iterations() const { return iteration_; }
  /// What the quadratic model promises at the next step; the value where none was modelled.
  double promised() const { return fit_.value - promised_gain_; }
  /// Of its work, at most 1.
  double share_done() const;
  const ParameterFit& fit() const { return fit_; }
  const ForwardModel& model() const { return model_; }

 private:
  enum class Asked { starts, sensitivities, full_step, short_step };

  void begin(const std::vector<std::optional<Predictions>>& made);
  void renew();
  bool may_renew() const { return problem_.options.renew_sensitivities && probings_ == 0; }
  void next_step();
  void converged();
  /// The better of those steps that improve on where it stands.
  void decide();
  Eigen::VectorXd place_after(const Eigen::VectorXd& step) const;

  const ForwardModel& model_;
  FitProblem problem_;
  ParameterFit fit_;
  Asked asked_ = Asked::starts;
  std::vector<Eigen::VectorXd> wanted_;
  std::optional<ProbingInProgress> probing_;
  std::optional<Error> why_not_;
  bool began_fresh_ = false;
  int probings_ = 0;  // after the start
  Eigen::VectorXd probe_;
  double damping_ = 0.03, promised_gain_ = 0;
  int iteration_ = 0, small_gains_ = 0;
  // Of the current iteration, the full step first.
  std::vector<Eigen::VectorXd> steps_;
  std::vector<std::optional<Predictions>> tried_;
};

/// Runs all to their ends, each with the bag of its model. A fit that `hopeless` holds for after a step is stopped
/// where it stands.
void run_fits(const std::vector<SimulationBag*>& bags, std::vector<FitInProgress>& fits, Context& context,
              const std::string& stage, const std::function<bool(const FitInProgress&)>& hopeless = {});

/// One alone. Throws Error{could_not_solve} where it has no answer.
ParameterFit fit_parameters(SimulationBag& bag, FitProblem problem, Context& context, const std::string& stage);

/// `from`, moved to `to` in the parameters `free`, but by three probes each at most: secants hold no farther, and a
/// longer distance is covered in steps.
Eigen::VectorXd towards(const ForwardModel& model, const std::vector<int>& free, const Eigen::VectorXd& from,
                        const Eigen::VectorXd& to);

}  // namespace formwright
