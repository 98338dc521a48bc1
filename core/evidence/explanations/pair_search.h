// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Which two causes may be at work together. Linear models cannot tell: sensitivities of forming over steep walls are as
// much the mesh's as the sheet's, and one-sided causes have none at zero. So pairs are fitted, on the model's cheaper
// self where it has one.
#include "evidence/fit/parameter_fit.h"
#include "evidence/fit/structured_objective.h"

namespace formwright {

/// A cheaper model made to agree with the full one at one place: cheap(u) + full(anchor) - cheap(anchor). What a coarse
/// mesh gets wrong everywhere alike is gone, what parameters change stays (additive correction of variable-fidelity
/// optimisation: Alexandrov et al. 2001).
class AnchoredModel : public ForwardModel {
 public:
  /// `cheap` must outlive it. `correction`: full(anchor) - cheap(anchor), each object.
  AnchoredModel(const ForwardModel& cheap, Predictions correction)
      : cheap_(cheap), correction_(std::move(correction)) {}

  const std::vector<ModelParameter>& parameters() const override { return cheap_.parameters(); }
  const std::vector<Cause>& causes() const override { return cheap_.causes(); }
  const std::vector<Measurement>& measurements() const override { return cheap_.measurements(); }
  double known_misfit() const override { return cheap_.known_misfit(); }
  double max_misfit_left() const override { return cheap_.max_misfit_left(); }
  bool claim(int object, const Eigen::VectorXd& u, const Context& context) const override {
    return cheap_.claim(object, u, context);
  }
  std::optional<ResultTask> task(int object, const Eigen::VectorXd& u, const Context& context) const override {
    return cheap_.task(object, u, context);
  }
  Eigen::MatrixXd predict(int object, const Eigen::VectorXd& u, const Context& context) const override {
    return cheap_.predict(object, u, context) + correction_[static_cast<std::size_t>(object)];
  }

 private:
  const ForwardModel& cheap_;
  Predictions correction_;
};

/// A single cause that was fitted.
struct FittedSingle {
  int cause = 0;
  Eigen::VectorXd u;
  Predictions predictions;  // of the full model
};

struct PairGuess {
  std::vector<int> causes;                   // two, ascending
  double log_evidence = 0;                   // on the cheaper model
  Eigen::VectorXd u;                         // where it fits best
  std::vector<Sensitivities> sensitivities;  // each object, of base_and(causes), near u
};

struct PairSearch {
  std::vector<PairGuess> guesses;  // each pair once, the likeliest first
  int simulations = 0;
};

/// Fits each of the first `anchors` of `singles`, likeliest first, together with the others that have a chance beside
/// it. `misfit` and `objective` are the diagnosis's own. Throws Error{cancelled}; where the model has no answer, pairs
/// are left out.
PairSearch search_pairs(const ForwardModel& model, const MisfitOfAll& misfit,
                        const std::shared_ptr<const FitObjective>& objective, const NuisanceParameters& discrepancies,
                        const std::vector<FittedSingle>& singles, std::size_t anchors, Context& context,
                        const std::string& stage);

}  // namespace formwright
