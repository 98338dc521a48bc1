// SPDX-License-Identifier: GPL-3.0-or-later
// What a coarse simulation has found, fitted once more by a finer one: its answer, or where it does not decide, its
// likeliest explanations.
#include <algorithm>
#include <limits>

#include "base/error.h"
#include "evidence/calibration.h"
#include "evidence/explanations/explanations.h"
#include "evidence/fit/free_fit.h"

namespace formwright {
namespace {

constexpr std::size_t polished_again = 1;  // beside none
constexpr std::size_t max_again = 5;       // explanations with causes

const Hypothesis& plain_none(const std::vector<Hypothesis>& hypotheses) {
  return *std::find_if(hypotheses.begin(), hypotheses.end(),
                       [](const Hypothesis& h) { return h.causes.empty() && !h.unknown_structure; });
}

}  // namespace

bool Explanations::decided() const {
  const Hypothesis& best = hypotheses_.front();
  if (best.unknown_structure || structure_left(best.causes) > model_.max_misfit_left()) return false;
  // Where nothing is left to explain, no finer sheet finds a cause of it.
  if (best.causes.empty()) return true;
  return std::all_of(hypotheses_.begin(), hypotheses_.end(), [&](const Hypothesis& h) {
    return h.causes == best.causes || h.log_evidence < best.log_evidence - model_.mesh_error();
  });
}

double Explanations::error() const {
  return mean_distance(model_, residuals(model_, refit_of(hypotheses_.front().causes).fit.predictions));
}

std::vector<const Explanations::Refit*> Explanations::likeliest_refits() const {
  std::vector<const Refit*> list;
  const auto evidence = [&](const Refit& r) {
    double best = -std::numeric_limits<double>::infinity();
    for (const Hypothesis& h : hypotheses_)
      if (h.causes == r.causes) best = std::max(best, h.log_evidence);
    return best;
  };
  for (const Refit& r : refits_) list.push_back(&r);
  std::stable_sort(list.begin(), list.end(),
                   [&](const Refit* a, const Refit* b) { return evidence(*a) > evidence(*b); });
  return list;
}

const Explanations::Refit* Explanations::nearest() const {
  const std::vector<double> like = likenesses();
  const auto most = std::max_element(like.begin(), like.end());
  const std::vector<int> cause{static_cast<int>(most - like.begin())};
  return *most * *most >= explained_share && is_refitted(cause) ? &refit_of(cause) : nullptr;
}

Explanations::Again Explanations::worth_looking_again() const {
  if (decided()) {
    const std::vector<int>& causes = hypotheses_.front().causes;
    return causes.empty() ? Again{} : Again{{&refit_of(causes)}, nullptr};
  }
  double best = plain_none(hypotheses_).log_evidence;
  for (const Hypothesis& h : hypotheses_) best = std::max(best, h.log_evidence);
  Again again;
  for (const Refit* r : likeliest_refits()) {
    const bool in_reach = std::any_of(hypotheses_.begin(), hypotheses_.end(), [&](const Hypothesis& h) {
      return h.causes == r->causes && h.log_evidence > best - out_of_reach;
    });
    if (!r->causes.empty() && in_reach && again.likely.size() < max_again) again.likely.push_back(r);
  }
  const Refit* const alike = nearest();
  if (std::find(again.likely.begin(), again.likely.end(), alike) == again.likely.end()) again.nearest = alike;
  return again;
}

void Explanations::refit_as(const Again& coarse) {
  struct Candidate {
    const Refit* refit;
    const ParameterFit* fit;
  };
  std::vector<const Refit*> refits = coarse.likely;
  if (coarse.nearest != nullptr) refits.push_back(coarse.nearest);
  std::vector<Candidate> candidates;
  std::vector<Eigen::VectorXd> starts;
  for (const Refit* refit : refits)
    for (const ParameterFit* fit : {&refit->fit, refit->alternative ? &*refit->alternative : nullptr}) {
      if (fit == nullptr || std::any_of(refit->causes.begin(), refit->causes.end(), [&](int cause) {
            return movement(cause, fit->u) <= min_movement * model_.known_misfit();
          }))
        continue;
      candidates.push_back({refit, fit});
      starts.push_back(fit->u);
      // The finer sheet may want another material.
      candidates.push_back({refit, fit});
      starts.push_back(refit_of({}).fit.u);
      for (const int cause : refit->causes)
        for (const int p : model_.causes()[static_cast<std::size_t>(cause)].parameters) starts.back()[p] = fit->u[p];
    }
  if (starts.empty()) return;
  const auto predictions = bag_.run(starts, context_, fitting_stage);
  std::vector<FitProblem> problems;
  std::vector<const Refit*> again;
  for (const Refit* refit : refits) {
    const bool in_any_case = refit == refits.front() || refit == coarse.nearest;
    double best_value = in_any_case ? std::numeric_limits<double>::infinity() : refit_of({}).fit.value + out_of_reach;
    std::optional<FitProblem> best;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      if (candidates[i].refit != refit || !predictions[i]) continue;
      FitProblem candidate = problem(refit->causes, {starts[i]}, candidates[i].fit->sensitivities, quick_fit);
      const double value = candidate.objective->value(residuals(model_, *predictions[i]), starts[i]);
      if (value < best_value) best_value = value, best = std::move(candidate);
    }
    if (!best) continue;
    problems.push_back(std::move(*best));
    again.push_back(refit);
  }
  const std::vector<FitInProgress> fits = fitted(std::move(problems));
  for (std::size_t i = 0; i < again.size(); ++i) {
    refits_.push_back({fits[i].fit(), again[i]->causes, {}});
    weigh_refit(refits_.back());
  }
}

void Explanations::look_again(Explanations& coarse) {
  const char* const looking = "Repeating on a finer sheet";
  const auto span = context_.span(0.75, 0.9, looking);
  auto at_nominal = [&] {
    const auto begin = context_.span(0, 0.05, looking);
    return bag_.run(model_.nominal(), context_, looking);
  }();
  if (!at_nominal)
    throw Error(ErrorCode::could_not_solve, "", "The finer simulation fails with the set-up's own parameters.");
  at_nominal_ = std::move(*at_nominal);
  coarser_ = &coarse;
  columns_ = coarse.columns_;
  sensitivities_ = coarse.sensitivities_;
  nominal_sensitivities_ = coarse.nominal_sensitivities_;
  if (coarse.strong_)
    if (auto there = bag_.run(coarse.strong_->u, context_, looking)) {
      strong_ = StrongCause{coarse.strong_->cause, coarse.strong_->u, std::move(*there)};
      strong_sensitivities_ = coarse.strong_sensitivities_;
    }
  discrepancies_ = coarse.discrepancies_;
  noise_ = coarse.noise_;
  {
    const auto begin = context_.span(0.05, 0.2, looking);
    base_ = fit_parameters(bag_,
                           {mean_distance_objective(model_, softness()),
                            model_.base_parameters(),
                            {coarse.base_.u},
                            sensitivities_of(model_.base_parameters(), sensitivities_, columns_)},
                           context_, looking);
  }
  // What equally good simulations would do is less on a finer sheet; where a coarse one leaps a fine one does, too.
  {
    const auto begin = context_.span(0.2, 0.3, looking);
    discrepancy_sensitivities_ = sensitivities_at(bag_, base_.u, base_.predictions, discrepancies_, context_, looking);
  }
  movements_ = movements_of(model_, discrepancies_, discrepancy_sensitivities_);
  for (std::size_t object = 0; object < movements_.size(); ++object) {
    const std::vector<Eigen::MatrixXd>& all = coarse.movements_[object];
    movements_[object].insert(movements_[object].end(),
                              all.begin() + static_cast<std::ptrdiff_t>(coarse.discrepancies_.size()), all.end());
    for (std::size_t k = 0; k < discrepancies_.size(); ++k) {
      const auto column =
          static_cast<std::size_t>(std::find(columns_.begin(), columns_.end(), discrepancies_[k]) - columns_.begin());
      sensitivities_[object][column] = discrepancy_sensitivities_[object][k];
    }
  }
  estimate_noise_freely();
  screened_ = all_hypotheses(model_, pairs_);
  weigh_screened();

  const Refit& plain = coarse.refit_of({});
  const auto refitting = context_.span(0.3, 0.8, looking);
  refits_.push_back(
      {fitted({problem({}, {base_.u, plain.fit.u}, plain.fit.sensitivities, quick_fit)}).front().fit(), {}, {}});
  weigh_refit(refits_.back());
  {
    const auto part = context_.span(0.1, 0.6, looking);
    refit_as(coarse.worth_looking_again());
  }
  normalise(hypotheses_);
  {
    const auto part = context_.span(0.6, 1, looking);
    polish_leaders(polished_again);
  }
  renew_noise();
  // The others stay as far from none as they were, and no better: they were out of reach, or did nothing.
  const double none = plain_none(hypotheses_).log_evidence, coarse_none = plain_none(coarse.hypotheses_).log_evidence;
  for (Hypothesis h : coarse.hypotheses_) {
    if (h.causes.size() != 1 || is_refitted(h.causes)) continue;
    h.log_evidence = none + std::min(0.0, h.log_evidence - coarse_none);
    hypotheses_.push_back(h);
  }
  std::erase_if(hypotheses_, [&](const Hypothesis& h) { return h.causes.size() == 2 && !significant(h); });
  normalise(hypotheses_);
}

}  // namespace formwright
