// SPDX-License-Identifier: GPL-3.0-or-later
// Fits of explanations, those of several at a time: what each wants simulated next is one batch.
#include <algorithm>
#include <limits>
#include <set>

#include "evidence/explanations/explanations.h"
#include "evidence/fit/usual_strengths.h"

namespace formwright {
namespace {

constexpr double linear_error = 150;  // of log evidence: linear models, and fits after two steps, err by less
/// Times that: about zero, linear models of a cause of one sign say little.
constexpr double one_sided_error = 2;
constexpr int judged_after = 2;  // steps
constexpr FitOptions polishing_fit{8, 0.01, true}, renewing_fit{6, 0.01, true};

}  // namespace

FitProblem Explanations::problem(const std::vector<int>& causes, std::vector<Eigen::VectorXd> starts,
                                 std::vector<Sensitivities> known, const FitOptions& options) const {
  return {
      std::make_shared<StructuredObjective>(model_, *misfit_, nearest_size(model_.known_misfit()), nuisances(causes)),
      model_.base_and(causes), std::move(starts), std::move(known), options};
}

std::vector<FitInProgress> Explanations::fitted(std::vector<FitProblem> problems) {
  std::vector<FitInProgress> fits;
  for (FitProblem& p : problems) fits.emplace_back(model_, std::move(p));
  run_fits({&bag_}, fits, context_, fitting_stage, [&](const FitInProgress& fit) {
    // A cause that is far behind may still be a good part of a pair.
    if (pairs_ || fit.iterations() <= judged_after) return false;
    double lowest = std::numeric_limits<double>::infinity();
    for (const Refit& r : refits_) lowest = std::min(lowest, r.fit.value);
    for (const FitInProgress& f : fits)
      if (f.has_answer()) lowest = std::min(lowest, f.fit().value);
    return fit.promised() > lowest + linear_error;
  });
  return fits;
}

FitProblem Explanations::problem_from_base(const std::vector<int>& causes, const PairGuess* guess) const {
  const Hypothesis& plain = screened(causes, false);
  const Hypothesis& rough = screened(causes, true);
  const Hypothesis& start = plain.probability >= rough.probability ? plain : rough;
  const std::vector<int> free = model_.base_and(causes);
  std::vector<Eigen::VectorXd> starts{base_.u, towards(model_, free, base_.u, start.u)};
  if (guess != nullptr) starts.push_back(guess->u);
  for (const auto& r : refits_)  // a pair may start from what its parts are like alone
    if (causes.size() == 2 && r.causes.size() == 1 && (r.causes[0] == causes[0] || r.causes[0] == causes[1]))
      starts.push_back(r.fit.u);
  return problem(causes, starts,
                 guess != nullptr ? guess->sensitivities : sensitivities_of(free, sensitivities_, columns_), quick_fit);
}

bool Explanations::cannot_lead(const std::vector<int>& causes) const {
  if (causes.empty() || pairs_) return false;
  const double linear = std::max(screened(causes, false).log_evidence, screened(causes, true).log_evidence);
  double fitted = -std::numeric_limits<double>::infinity();
  for (const Hypothesis& h : hypotheses_) fitted = std::max(fitted, h.log_evidence);
  const double leading = std::min(screened_.front().log_evidence, fitted);
  return linear < leading - (model_.has_one_sign(causes) ? one_sided_error : 1) * linear_error;
}

std::optional<FitProblem> Explanations::problem_from_nominal(const std::vector<int>& causes) {
  const std::vector<int> free = model_.base_and(causes);
  std::vector<Sensitivities> known = sensitivities_of(free, nominal_sensitivities_, columns_);
  if (model_.has_one_sign(causes)) {
    // At zero it has a derivative on one side only, and that says little: start at the best of some strengths, with the
    // secant from none to there.
    FitProblem result = problem(causes, strengths_to_start_from(model_, causes), {}, renewing_fit);
    Eigen::VectorXd start = result.starts.front();
    std::optional<Predictions> there;
    double lowest = std::numeric_limits<double>::infinity();
    const auto made = bag_.run(result.starts, context_, fitting_stage);
    for (std::size_t i = 0; i < made.size(); ++i) {
      if (!made[i]) continue;
      const double value = result.objective->value(residuals(model_, *made[i]), result.starts[i]);
      if (!(value < lowest)) continue;
      lowest = value;
      start = result.starts[i];
      there = made[i];
    }
    const std::size_t own = free.size() - model_.base_parameters().size();
    if (own == 1 && there) {
      for (std::size_t object = 0; object < known.size(); ++object)
        known[object].back() = ((*there)[object] - at_nominal_[object]) / start[free.back()];
      result.known = std::move(known);
    }
    result.starts = {start, within_ranges(model_, start + 0.5 * base_.u)};
    return result;
  }
  Hypothesis h = screened(causes, false);
  weigh(model_, about_nominal_, columns_, model_.nominal(), h);
  if (h.log_evidence < screened_.front().log_evidence - one_sided_error * linear_error) return {};
  return problem(causes, {model_.nominal(), towards(model_, free, model_.nominal(), h.u)}, std::move(known), quick_fit);
}

void Explanations::refit_singles(const std::vector<std::vector<int>>& explanations) {
  if (explanations.empty()) return;
  std::vector<Eigen::VectorXd> usual;
  for (const std::vector<int>& causes : explanations)
    if (model_.has_one_sign(causes))
      for (Eigen::VectorXd& u : strengths_to_start_from(model_, causes)) usual.push_back(std::move(u));
  if (!usual.empty()) bag_.run(usual, context_, fitting_stage);
  std::vector<FitProblem> problems;
  for (const std::vector<int>& causes : explanations) problems.push_back(problem_from_base(causes, nullptr));
  std::vector<std::size_t> from_nominal;  // of `explanations`
  for (std::size_t i = 0; i < explanations.size(); ++i)
    if (auto other = problem_from_nominal(explanations[i])) {
      problems.push_back(std::move(*other));
      from_nominal.push_back(i);
    }
  const std::vector<FitInProgress> fits = fitted(std::move(problems));
  const std::size_t before = refits_.size();
  for (std::size_t i = 0; i < explanations.size(); ++i) refits_.push_back({fits[i].fit(), explanations[i], {}});
  for (std::size_t k = 0; k < from_nominal.size(); ++k) {
    const FitInProgress& other = fits[explanations.size() + k];
    if (!other.has_answer()) continue;
    Refit& refit = refits_[before + from_nominal[k]];
    refit.alternative = other.fit();
    if (refit.alternative->value < refit.fit.value) std::swap(refit.fit, *refit.alternative);
  }
  for (std::size_t r = before; r < refits_.size(); ++r) weigh_refit(refits_[r]);
}

void Explanations::refit_pairs(const std::vector<PairGuess>& guesses) {
  if (guesses.empty()) return;
  std::vector<FitProblem> problems;
  for (const PairGuess& guess : guesses) problems.push_back(problem_from_base(guess.causes, &guess));
  const std::vector<FitInProgress> fits = fitted(std::move(problems));
  for (std::size_t i = 0; i < guesses.size(); ++i) {
    refits_.push_back({fits[i].fit(), guesses[i].causes, {}});
    weigh_refit(refits_.back());
  }
}

FitProblem Explanations::polishing(const Refit& refit) const {
  std::vector<Eigen::VectorXd> starts{refit.fit.u};
  for (const Refit& larger : refits_) {
    if (larger.causes.size() <= refit.causes.size() ||
        !std::includes(larger.causes.begin(), larger.causes.end(), refit.causes.begin(), refit.causes.end()))
      continue;
    Eigen::VectorXd u = larger.fit.u;
    for (std::size_t p = 0; p < model_.parameters().size(); ++p)
      if (std::find(refit.fit.free.begin(), refit.fit.free.end(), static_cast<int>(p)) == refit.fit.free.end())
        u[static_cast<Eigen::Index>(p)] = 0;
    starts.push_back(u);
  }
  return problem(refit.causes, starts, refit.fit.sensitivities, polishing_fit);
}

void Explanations::polish_leaders(std::size_t count) {
  std::set<std::vector<int>> leaders{{}};
  const double highest = hypotheses_.front().log_evidence;
  for (const Hypothesis& h : hypotheses_) {
    if (leaders.size() > count || (leaders.size() > 2 && h.log_evidence < highest - out_of_reach)) break;
    leaders.insert(h.causes);
    if (h.causes.size() == 2)
      for (const int cause : h.causes) leaders.insert({cause});
  }
  for (const std::size_t size : {2u, 1u, 0u}) {
    std::vector<Refit*> group;
    std::vector<FitProblem> problems;
    for (Refit& r : refits_)
      if (r.causes.size() == size && leaders.contains(r.causes)) {
        group.push_back(&r);
        problems.push_back(polishing(r));
      }
    if (group.empty()) continue;
    const double left = static_cast<double>(size) / 3;
    const auto part = context_.span(2.0 / 3 - left, 1 - left, fitting_stage);
    const std::vector<FitInProgress> fits = fitted(std::move(problems));
    for (std::size_t i = 0; i < group.size(); ++i) {
      group[i]->fit = fits[i].fit();
      weigh_refit(*group[i]);
    }
  }
  normalise(hypotheses_);
}

}  // namespace formwright
