// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/explanations/pair_search.h"

#include <algorithm>

#include "base/error.h"
#include "evidence/fit/hypotheses.h"

namespace formwright {
namespace {

constexpr std::size_t partners = 6;  // that the linear model likes best; causes of one sign are tried in any case

/// One anchor's search.
class Neighbourhood {
 public:
  Neighbourhood(const ForwardModel& cheap, Predictions correction, const MisfitOfAll& misfit,
                std::shared_ptr<const FitObjective> objective, const NuisanceParameters& discrepancies,
                const std::vector<FittedSingle>& singles, const FittedSingle& anchor)
      : model_(cheap, std::move(correction)),
        bag_(model_),
        misfit_(misfit),
        objective_(std::move(objective)),
        discrepancies_(discrepancies),
        singles_(singles),
        anchor_(anchor) {}

  /// What every base and effect parameter does about the anchor, and what that says of each partner.
  void linearise(Context& context, const std::string& stage) {
    for (std::size_t p = 0; p < model_.parameters().size(); ++p)
      if (model_.parameters()[p].role != ParameterRole::discrepancy) columns_.push_back(static_cast<int>(p));
    sensitivities_ = sensitivities_at(bag_, anchor_.u, anchor_.predictions, columns_, context, stage);
    const GramByStructure gram = misfit_.gram(residuals(model_, anchor_.predictions),
                                              side_by_side(sensitivities_, discrepancies_.sensitivities));
    for (Hypothesis& h : all_hypotheses(model_, true)) {
      if (h.unknown_structure || h.causes.size() != 2 ||
          std::find(h.causes.begin(), h.causes.end(), anchor_.cause) == h.causes.end())
        continue;
      weigh(model_, gram, joined(columns_, discrepancies_.parameters), anchor_.u, h);
      linear_.push_back(std::move(h));
    }
    std::stable_sort(linear_.begin(), linear_.end(),
                     [](const Hypothesis& a, const Hypothesis& b) { return a.log_evidence > b.log_evidence; });
    std::size_t rank = 0;
    std::erase_if(linear_,
                  [&](const Hypothesis& h) { return rank++ >= partners && !model_.has_one_sign({partner(h)}); });
  }

  /// The pairs, fitted. The model has an answer at the anchor at least.
  std::vector<PairGuess> fit(Context& context, const std::string& stage) {
    std::vector<FitInProgress> fits;
    for (const Hypothesis& linear : linear_) fits.emplace_back(model_, problem(linear));
    run_fits({&bag_}, fits, context, stage);
    std::vector<PairGuess> guesses;
    for (std::size_t i = 0; i < linear_.size(); ++i) {
      const ParameterFit& fit = fits[i].fit();
      Hypothesis h = linear_[i];
      weigh(model_,
            misfit_.gram(residuals(model_, fit.predictions),
                         side_by_side(fit.sensitivities, discrepancies_.sensitivities)),
            joined(fit.free, discrepancies_.parameters), fit.u, h);
      guesses.push_back({h.causes, h.log_evidence, fit.u, fit.sensitivities});
    }
    return guesses;
  }

  int simulations() const { return bag_.simulations(); }

 private:
  FitProblem problem(const Hypothesis& linear) const {
    const std::vector<int> free = model_.base_and(linear.causes);
    std::vector<Eigen::VectorXd> starts{anchor_.u, towards(model_, free, anchor_.u, linear.u)};
    if (model_.has_one_sign({partner(linear)})) {
      starts.push_back(anchor_.u);
      for (const int p : model_.causes()[static_cast<std::size_t>(partner(linear))].parameters)
        starts.back()[p] = model_.parameters()[static_cast<std::size_t>(p)].prior_sd;
    }
    for (const FittedSingle& single : singles_) {
      // What the partner is like alone is no nearer in general, but on the right side of what these data hardly show.
      if (single.cause != partner(linear)) continue;
      starts.push_back(anchor_.u);
      for (const int p : model_.causes()[static_cast<std::size_t>(single.cause)].parameters)
        starts.back()[p] = single.u[p];
    }
    return {objective_, free, std::move(starts), sensitivities_of(free, sensitivities_, columns_), quick_fit};
  }

  int partner(const Hypothesis& h) const { return h.causes[0] == anchor_.cause ? h.causes[1] : h.causes[0]; }
  AnchoredModel model_;
  SimulationBag bag_;
  const MisfitOfAll& misfit_;
  std::shared_ptr<const FitObjective> objective_;
  const NuisanceParameters& discrepancies_;
  const std::vector<FittedSingle>& singles_;
  const FittedSingle& anchor_;
  std::vector<int> columns_;
  std::vector<Sensitivities> sensitivities_;
  std::vector<Hypothesis> linear_;
};

}  // namespace

PairSearch search_pairs(const ForwardModel& model, const MisfitOfAll& misfit,
                        const std::shared_ptr<const FitObjective>& objective, const NuisanceParameters& discrepancies,
                        const std::vector<FittedSingle>& singles, std::size_t anchors, Context& context,
                        const std::string& stage) {
  const ForwardModel& cheap = model.cheaper() != nullptr ? *model.cheaper() : model;
  PairSearch found;
  SimulationBag cheap_bag(cheap);
  anchors = std::min(anchors, singles.size());
  for (std::size_t a = 0; a < anchors; ++a) {
    const auto span = context.span(static_cast<double>(a) / static_cast<double>(anchors),
                                   static_cast<double>(a + 1) / static_cast<double>(anchors), stage);
    Predictions correction = singles[a].predictions;
    const auto at_anchor = cheap_bag.run(singles[a].u, context, stage);
    if (!at_anchor) continue;
    for (std::size_t object = 0; object < correction.size(); ++object) correction[object] -= (*at_anchor)[object];
    Neighbourhood near(cheap, std::move(correction), misfit, objective, discrepancies, singles, singles[a]);
    try {
      const auto part = context.span(0, 0.3, stage);
      near.linearise(context, stage);
    } catch (const Error& error) {
      if (error.code() != ErrorCode::could_not_solve) throw;
      continue;  // at the edge of what can be simulated: the other anchors go on
    }
    const auto part = context.span(0.3, 1, stage);
    for (PairGuess& guess : near.fit(context, stage)) {
      const auto known = std::find_if(found.guesses.begin(), found.guesses.end(),
                                      [&](const PairGuess& g) { return g.causes == guess.causes; });
      if (known == found.guesses.end()) found.guesses.push_back(std::move(guess));
      else if (guess.log_evidence > known->log_evidence) *known = std::move(guess);
    }
    found.simulations += near.simulations();
  }
  found.simulations += cheap_bag.simulations();
  std::stable_sort(found.guesses.begin(), found.guesses.end(),
                   [](const PairGuess& a, const PairGuess& b) { return a.log_evidence > b.log_evidence; });
  return found;
}

}  // namespace formwright
