// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The explanations a diagnosis compares: each fitted together with the base parameters, each with its marginal
// likelihood. For diagnosis.cpp.
#include <optional>

#include "evidence/pair_search.h"
#include "evidence/stepwise_fit.h"

namespace formwright {

inline constexpr const char* fitting_stage = "Fitting the causes";

class Explanations {
 public:
  struct Refit {
    ParameterFit fit;
    std::vector<int> causes;
    bool polished = false;  // with sensitivities taken where it stands
  };

  Explanations(SimulationBag& bag, bool pairs, Context& context)
      : bag_(bag), model_(bag.model()), pairs_(pairs), context_(context) {}

  // In this order. Each throws Error{could_not_solve, cancelled}.
  /// Fits the base parameters alone, and finds the noise.
  void calibrate();
  /// Sensitivities to everything about the calibrated model, and what they alone say.
  void screen();
  /// Fits the likeliest causes in earnest, side by side, then pairs, then the leaders once more; fills hypotheses().
  /// Base parameters and causes are fitted together, and no more structure is allowed than the right causes would
  /// leave: with as much as there is, what the causes should explain would cost nothing unexplained.
  void refit();

  const ParameterFit& base() const { return base_; }
  const std::vector<NoiseEstimate>& noise() const { return noise_; }
  const std::vector<Eigen::VectorXd>& weights() const { return weights_; }
  const MisfitOfAll& misfit() const { return *misfit_; }
  /// All parameters, and what each does about the calibrated model.
  const std::vector<int>& columns() const { return columns_; }
  const std::vector<Sensitivities>& sensitivities() const { return sensitivities_; }
  const std::vector<int>& liberties() const { return liberties_; }
  const std::vector<Sensitivities>& liberty_sensitivities() const { return liberty_sensitivities_; }
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
  /// RMS movement, in the measurement's unit, that a cause makes at u.
  double movement(int cause, const Eigen::VectorXd& u) const;
  /// Every cause of it does something: more than the model's own misfit could pass for.
  bool significant(const Hypothesis& h) const;

 private:
  void estimate_noise_about(const Predictions& predictions);
  const Hypothesis& screened(const std::vector<int>& causes, bool unknown) const;
  enum class FitEffort {
    quick,     // near enough to see who leads
    as_it_is,  // to the end, with the secants there are
    thorough,  // to the end, with sensitivities taken where the fit stands
  };
  StepwiseFit contender(const std::vector<int>& causes, const std::vector<Eigen::VectorXd>& starts,
                        std::vector<Sensitivities> known, FitEffort effort) const;
  /// Runs the fits, one of each element of `causes`, side by side, keeps the better where there are two, and weighs
  /// them.
  void race(std::vector<std::vector<int>> causes, std::vector<StepwiseFit> fits);
  Eigen::VectorXd step_towards(const Eigen::VectorXd& from, const Eigen::VectorXd& to,
                               const std::vector<int>& free) const;
  /// None, and the causes that the linearised model likes, from where it has them.
  void fit_singles();
  /// The nominal model with a one-sided cause at its usual strength; empty for other causes.
  Eigen::VectorXd far_start(const std::vector<int>& causes) const;
  /// With the sensitivities about the calibrated model where the fit has none of its own; `anew`: with what every other
  /// cause does there.
  Linearisation about(const Refit& refit) const;
  Linearisation about_anew(const Refit& refit);
  Refit& refit_with(const std::vector<int>& causes);
  /// Pairs that linear models like, taken about the calibrated model and the best single causes, then about the best
  /// pair with one of its causes exchanged.
  void fit_pairs();
  /// Fits the likeliest `most` pairs that were not yet fitted.
  void try_pairs(const std::vector<Linearisation>& places, std::size_t most);
  /// Once more to the end; what was learnt with more causes counts for fewer.
  void polish(Refit& refit, FitEffort effort);
  /// Those that may yet be the best, thoroughly; none, and what the best pair is made of, as they are.
  void polish_leaders();
  /// The marginal likelihood of an explanation where its fit has it.
  void weigh_refit(const Refit& refit);
  /// What passed for outliers about the calibrated model may have been misfit that an explanation accounts for: once
  /// more about the best.
  void renew_noise();

  SimulationBag& bag_;
  const ForwardModel& model_;
  bool pairs_;
  Context& context_;
  ParameterFit base_;
  std::vector<NoiseEstimate> noise_;
  std::vector<Eigen::VectorXd> weights_;
  std::optional<MisfitOfAll> misfit_;
  std::optional<StructuredObjective> objective_;  // while refitting
  std::vector<int> columns_;
  std::vector<Sensitivities> sensitivities_;
  std::vector<int> liberties_;
  std::vector<Sensitivities> liberty_sensitivities_;
  std::vector<Hypothesis> screened_, hypotheses_;
  std::vector<Refit> refits_;
};

}  // namespace formwright
