// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The explanations a diagnosis compares: each fitted together with the base parameters, each with its marginal
// likelihood. For diagnosis.cpp.
#include <optional>

#include "evidence/fit/hypotheses.h"
#include "evidence/explanations/distorted_measurement.h"
#include "evidence/explanations/pair_search.h"
#include "evidence/fit/structured_objective.h"
#include "evidence/fit/usual_strengths.h"

namespace formwright {

inline constexpr const char* fitting_stage = "Fitting the causes";
inline constexpr double min_movement = 0.5;  // of the known misfit, that a cause must make
/// Of what the base model leaves unexplained (its variance), that a named cause must explain.
inline constexpr double explained_share = 0.5;
inline constexpr double out_of_reach = 60;  // log evidence that polishing, or a finer simulation, does not make up for

class Explanations {
 public:
  struct Refit {
    ParameterFit fit;
    std::vector<int> causes;
    std::optional<ParameterFit> alternative;  // where the fit from the other material ended, which is worse
  };

  Explanations(SimulationBag& bag, bool pairs, Context& context)
      : bag_(bag), model_(bag.model()), pairs_(pairs), context_(context) {}

  // In this order. Each throws Error{could_not_solve, cancelled}.
  /// Fits the base parameters alone, and finds the noise. Begins at the nominal ones or, where it is better and not
  /// empty, at `start`.
  void calibrate(const Eigen::VectorXd& start = {});
  /// Sensitivities to everything about the calibrated model, and what they alone say.
  void screen();
  /// Fits the likeliest causes in earnest, then pairs, then the leaders once more; fills hypotheses().
  void refit();

  /// Mean distance of all points from the most probable explanation.
  double error() const;
  /// Instead of the three: weighs the answer of `coarse`, of a coarser simulation of the same data, or what it has
  /// found nearly as likely, beginning from its fits. Fills everything. Throws Error{could_not_solve, cancelled}.
  void look_again(Explanations& coarse);

  const ForwardModel& model() const { return model_; }
  const ParameterFit& base() const { return base_; }
  const std::vector<NoiseEstimate>& noise() const { return noise_; }
  /// How well each point is known, the simulation's own unreliability counted in.
  const std::vector<Precisions>& precisions() const { return precisions_; }
  const MisfitOfAll& misfit() const { return *misfit_; }
  /// All parameters, and what each does about the calibrated model.
  const std::vector<int>& columns() const { return columns_; }
  const std::vector<Sensitivities>& sensitivities() const { return sensitivities_; }
  /// The same about the set-up's own material, where a cause of one sign is taken at its usual strength:
  /// what it does from there on to zero. Simulates these, on the coarser sheet where there is one. Throws
  /// Error{cancelled}.
  std::vector<Sensitivities> usual_sensitivities();
  /// About the calibrated and about the set-up's own material.
  std::vector<LinearModel> linear_models() const {
    return {{base_.predictions, sensitivities_, base_.u}, {at_nominal_, nominal_sensitivities_, model_.nominal()}};
  }
  /// likenesses() to what the calibrated model leaves.
  std::vector<double> likenesses() const;
  /// What may differ where `causes` and nothing else is at work.
  NuisanceParameters nuisances(const std::vector<int>& causes) const;
  /// The discrepancy parameters alone.
  NuisanceParameters discrepancies() const { return {discrepancies_, discrepancy_sensitivities_}; }
  /// Most probable first.
  const std::vector<Hypothesis>& hypotheses() const { return hypotheses_; }
  bool is_refitted(const std::vector<int>& causes) const;
  /// Of causes that were refitted.
  const Refit& refit_of(const std::vector<int>& causes) const;
  /// Index of the structure size next to `structure`, never that of none.
  std::size_t nearest_size(double structure) const;
  /// How much structure is left with these causes, counted alike whether unknown structure was allowed or not.
  double structure_left(const std::vector<int>& causes) const;
  /// Distance below which the mean distance is rounded off: the noise.
  double softness() const;
  /// Simulations of the cheaper model.
  int cheap_simulations() const { return cheap_simulations_; }
  /// RMS movement, in the measurement's unit, that these parameters make at u.
  double movement_by(const std::vector<int>& parameters, const Eigen::VectorXd& u) const;
  /// The same of a cause.
  double movement(int cause, const Eigen::VectorXd& u) const;
  /// A cause that is there or not (Cause::min_strength), and is not at u.
  bool is_too_weak(int cause, const Eigen::VectorXd& u) const;
  /// Those of `causes` that do something at u: more than the model's own misfit could pass for.
  std::vector<int> causes_that_move(const std::vector<int>& causes, const Eigen::VectorXd& u) const;
  /// Every cause of it does something.
  bool significant(const Hypothesis& h) const;

 private:
  /// Fills noise_, precisions_ and misfit_.
  void estimate_noise_about(const Predictions& predictions);
  /// What the linearised model says of every explanation, about the calibrated or the set-up's own material, or about a
  /// strong cause beside that, whichever speaks best for it.
  void weigh_screened();
  /// Fills strong_ and what is known about it.
  void look_for_strong_cause();
  /// The noise that a linear model with every parameter leaves, about the calibrated model or, where that is less,
  /// about the strong cause.
  void estimate_noise_freely();
  const Hypothesis& screened(const std::vector<int>& causes, bool unknown) const;
  double movement_by(const std::vector<int>& parameters, const Eigen::VectorXd& u,
                     const std::vector<Sensitivities>& sensitivities) const;
  /// Fits base parameters and those of `causes` together, from the best of `starts`. No more structure is allowed than
  /// the right causes would leave: with as much as there is, what the causes should explain would cost nothing
  /// unexplained.
  FitProblem problem(const std::vector<int>& causes, std::vector<Eigen::VectorXd> starts,
                     std::vector<Sensitivities> known, const FitOptions& options) const;
  /// From where the linearised model has them, with the sensitivities it was made of; or from `guess`.
  FitProblem problem_from_base(const std::vector<int>& causes, const PairGuess* guess) const;
  /// The same from the set-up's own material, for at most one cause: a fault that is not among the base parameters
  /// drags them far off, and nothing near there points back. Nothing where it is out of reach.
  std::optional<FitProblem> problem_from_nominal(const std::vector<int>& causes);
  /// Once more from where its fit ended; sensitivities are taken afresh there. What was learnt with more causes counts
  /// for fewer.
  FitProblem polishing(const Refit& refit) const;
  /// All together. Where pairs are not searched, those that cannot lead any more are stopped on their way.
  std::vector<FitInProgress> fitted(std::vector<FitProblem> problems);
  /// None or one cause each, from both materials. Each is weighed.
  void refit_singles(const std::vector<std::vector<int>>& explanations);
  void refit_pairs(const std::vector<PairGuess>& guesses);
  /// Behind the linearised leader and the best fit so far by more than a linear model is wrong: not worth a fit, except
  /// as part of a pair.
  bool cannot_lead(const std::vector<int>& causes) const;
  /// Those with the most log evidence first.
  std::vector<const Refit*> likeliest_refits() const;
  /// One explanation leads all others by more than another mesh moves, and leaves nothing.
  bool decided() const;
  /// The cause that is most like what the calibrated model leaves, if it was refitted and, by its likeness, alone
  /// explains enough of that to be named; else null.
  const Refit* nearest() const;
  struct Again {
    std::vector<const Refit*> likely;  // the likeliest first; the others only where they are in reach
    const Refit* nearest = nullptr;    // where it is none of these
  };
  /// The answer alone where these decide it; else all that are in its reach. Where a coarse sheet leaps, the cause that
  /// is at work may fit it worse than none does: then it is still what the data look like.
  Again worth_looking_again() const;
  /// Once more where a coarser simulation has them, unless they do nothing there.
  void refit_as(const Again& coarse);
  /// Polishes the likeliest `count` explanations, what they are parts of and have as parts, larger ones first.
  void polish_leaders(std::size_t count);
  /// The marginal likelihood of an explanation where its fit has it.
  void weigh_refit(const Refit& refit);
  /// What passed for outliers about the calibrated model may have been misfit that an explanation accounts for: once
  /// more about the best.
  void renew_noise();
  /// The likeliest pairs with the best single causes, found on the cheaper model.
  std::vector<PairGuess> promising_pairs();

  SimulationBag& bag_;
  const ForwardModel& model_;
  bool pairs_;
  Context& context_;
  ParameterFit base_;
  std::vector<NoiseEstimate> noise_;
  std::vector<Precisions> precisions_;
  std::optional<MisfitOfAll> misfit_;
  std::vector<int> columns_;
  std::vector<Sensitivities> sensitivities_;
  std::vector<int> discrepancies_;
  std::vector<Sensitivities> discrepancy_sensitivities_;
  std::vector<std::vector<Eigen::MatrixXd>>
      movements_;  // what the simulation is not to be relied on by: model_covariance()
  Predictions at_nominal_;
  std::vector<Sensitivities> nominal_sensitivities_;
  GramByStructure about_nominal_;
  std::optional<StrongCause> strong_;  // much nearer to the data than the calibrated model
  std::vector<Sensitivities> strong_sensitivities_;
  std::vector<Hypothesis> screened_, hypotheses_;
  std::vector<Refit> refits_;
  int cheap_simulations_ = 0;
  Explanations* coarser_ = nullptr;  // that were looked at before
};

}  // namespace formwright
