// SPDX-License-Identifier: GPL-3.0-or-later
// Which explanations are fitted in earnest, in what order and from where: Explanations::refit.
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "evidence/explanations.h"

namespace formwright {
namespace {

constexpr std::size_t refitted_singles = 8, first_pairs = 4, swapped_pairs = 3, looked_from = 3, most_polished = 4;
constexpr int quick_iterations = 5, polishing_iterations = 8;
constexpr double out_of_reach = 60;   // log evidence that a fit in progress does not make up for
constexpr double near_the_best = 30;  // log evidence that polishing may make up for
constexpr double far_reach = 3;       // in probes: secants hold about so far, and a longer way is gone in steps

std::vector<int> parameters_of(const ForwardModel& model, const std::vector<int>& causes) {
  std::vector<int> list = model.base_parameters();
  for (const int cause : causes) {
    const std::vector<int>& own = model.causes()[static_cast<std::size_t>(cause)].parameters;
    list.insert(list.end(), own.begin(), own.end());
  }
  return list;
}

/// Of `all`, which has every parameter in order, what belongs to `wanted`.
std::vector<Sensitivities> chosen(const std::vector<Sensitivities>& all, const std::vector<int>& wanted) {
  std::vector<Sensitivities> result(all.size());
  for (const int p : wanted)
    for (std::size_t object = 0; object < all.size(); ++object)
      result[object].push_back(all[object][static_cast<std::size_t>(p)]);
  return result;
}

}  // namespace

StepwiseFit Explanations::contender(const std::vector<int>& causes, const std::vector<Eigen::VectorXd>& starts,
                                    std::vector<Sensitivities> known, FitEffort effort) const {
  FitOptions options;
  options.most_iterations = effort == FitEffort::quick ? quick_iterations : polishing_iterations;
  options.tolerance = 0;
  // In units of log evidence, of which a tenth is nothing and a handful may decide.
  options.least_gain = effort == FitEffort::quick ? 2 : 0.5;
  options.most_renewals = effort == FitEffort::thorough ? 1 : 0;
  return {model_, *objective_, parameters_of(model_, causes), starts, std::move(known), options};
}

void Explanations::race(std::vector<std::vector<int>> causes, std::vector<StepwiseFit> fits) {
  double lowest = std::numeric_limits<double>::infinity();
  for (const Refit& r : refits_) lowest = std::min(lowest, r.fit.value);
  run_side_by_side(bag_, fits, lowest, out_of_reach, context_, fitting_stage);
  for (std::size_t i = 0; i < fits.size(); ++i) {
    const auto known =
        std::find_if(refits_.begin(), refits_.end(), [&](const Refit& r) { return r.causes == causes[i]; });
    if (known == refits_.end())
      refits_.push_back({fits[i].fit(), causes[i]});
    else if (fits[i].fit().value < known->fit.value)
      known->fit = fits[i].fit();
  }
  for (const Refit& r : refits_)
    if (std::find(causes.begin(), causes.end(), r.causes) != causes.end()) weigh_refit(r);
  normalise(hypotheses_);
}

Eigen::VectorXd Explanations::step_towards(const Eigen::VectorXd& from, const Eigen::VectorXd& to,
                                           const std::vector<int>& free) const {
  Eigen::VectorXd u = from;
  for (const int p : free) {
    const double reach = far_reach * model_.parameters()[static_cast<std::size_t>(p)].probe;
    u[p] += std::clamp(to[p] - u[p], -reach, reach);
  }
  return u;
}

void Explanations::fit_singles() {
  std::vector<std::vector<int>> causes{{}};
  for (const Hypothesis& h : screened_)
    if (h.causes.size() == 1 && std::find(causes.begin(), causes.end(), h.causes) == causes.end() &&
        causes.size() <= refitted_singles)
      causes.push_back(h.causes);
  std::vector<StepwiseFit> fits;
  for (const auto& c : causes) {
    const Hypothesis &plain = screened(c, false), &rough = screened(c, true);
    const std::vector<int> free = parameters_of(model_, c);
    const Eigen::VectorXd near =
        step_towards(base_.u, (plain.probability >= rough.probability ? plain : rough).u, free);
    fits.push_back(contender(c, {base_.u, near}, chosen(sensitivities_, free), FitEffort::quick));
  }
  // The calibrated base may have swallowed an effect that only goes one way: nothing near it points back.
  std::vector<Eigen::VectorXd> far;
  std::vector<std::vector<int>> whose;
  for (const auto& c : causes)
    if (const Eigen::VectorXd u = far_start(c); u.size() > 0) far.push_back(u), whose.push_back(c);
  const auto answers = bag_.run(far, context_, fitting_stage);
  for (std::size_t i = 0; i < far.size(); ++i) {
    if (!answers[i]) continue;
    const std::vector<int> free = parameters_of(model_, whose[i]);
    std::vector<Sensitivities> secants = chosen(sensitivities_, free);
    broyden_update(model_, secants, free, base_.predictions, *answers[i], far[i] - base_.u);
    fits.push_back(contender(whose[i], {far[i]}, std::move(secants), FitEffort::quick));
    causes.push_back(whose[i]);
  }
  race(std::move(causes), std::move(fits));
}

Eigen::VectorXd Explanations::far_start(const std::vector<int>& causes) const {
  if (causes.size() != 1) return {};
  Eigen::VectorXd u = 0.5 * base_.u;
  bool one_sided = false;
  for (const int p : model_.causes()[static_cast<std::size_t>(causes.front())].parameters) {
    const ModelParameter& parameter = model_.parameters()[static_cast<std::size_t>(p)];
    u[p] = parameter.prior_sd;
    one_sided |= parameter.one_sided();
  }
  return one_sided ? within_ranges(model_, u) : Eigen::VectorXd();
}

Linearisation Explanations::about(const Refit& refit) const {
  Linearisation result{refit.causes, refit.fit.u, residuals(model_, refit.fit.predictions), sensitivities_};
  for (std::size_t object = 0; object < sensitivities_.size(); ++object)
    for (std::size_t a = 0; a < refit.fit.free.size(); ++a)
      result.sensitivities[object][static_cast<std::size_t>(refit.fit.free[a])] = refit.fit.sensitivities[object][a];
  return result;
}

Linearisation Explanations::about_anew(const Refit& refit) {
  Linearisation result = about(refit);
  std::vector<int> others;
  for (const int p : model_.parameters_with(ParameterRole::effect))
    if (std::find(refit.fit.free.begin(), refit.fit.free.end(), p) == refit.fit.free.end()) others.push_back(p);
  const std::vector<Sensitivities> anew =
      sensitivities_at(bag_, refit.fit.u, refit.fit.predictions, others, context_, fitting_stage);
  for (std::size_t object = 0; object < anew.size(); ++object)
    for (std::size_t i = 0; i < others.size(); ++i)
      result.sensitivities[object][static_cast<std::size_t>(others[i])] = anew[object][i];
  return result;
}

void Explanations::fit_pairs() {
  std::vector<std::vector<int>> singles;
  for (const Hypothesis& h : hypotheses_)
    if (h.causes.size() == 1 && std::find(singles.begin(), singles.end(), h.causes) == singles.end())
      singles.push_back(h.causes);
  singles.resize(std::min(singles.size(), looked_from));
  std::vector<Linearisation> places{{{}, base_.u, residuals(model_, base_.predictions), sensitivities_}};
  for (std::size_t i = 0; i < singles.size(); ++i) {
    // A strong cause changes what others do. Where none leads, the calibrated model is near enough.
    const bool leads = i == 0 && !hypotheses_.front().causes.empty();
    if (leads) polish(refit_with(singles[i]), FitEffort::thorough);
    places.push_back(leads ? about_anew(refit_of(singles[i])) : about(refit_of(singles[i])));
  }
  try_pairs(places, first_pairs);
  // Of the best pair each may stand for something else.
  const auto best =
      std::find_if(hypotheses_.begin(), hypotheses_.end(), [](const Hypothesis& h) { return h.causes.size() == 2; });
  if (best == hypotheses_.end()) return;
  const std::vector<int> pair = best->causes;
  Linearisation both = about(refit_of(pair));
  // What the others do is known best about a part of it.
  for (std::size_t place = places.size() - 1; place > 0; --place) {
    if (!std::includes(pair.begin(), pair.end(), places[place].causes.begin(), places[place].causes.end())) continue;
    std::vector<Sensitivities> known = places[place].sensitivities;
    for (const int p : refit_of(pair).fit.free)
      for (std::size_t object = 0; object < known.size(); ++object)
        known[object][static_cast<std::size_t>(p)] = both.sensitivities[object][static_cast<std::size_t>(p)];
    both.sensitivities = std::move(known);
  }
  try_pairs({without_cause(model_, both, pair[0]), without_cause(model_, both, pair[1])}, swapped_pairs);
}

void Explanations::try_pairs(const std::vector<Linearisation>& places, std::size_t most) {
  std::vector<std::vector<int>> causes;
  std::vector<StepwiseFit> fits;
  for (const PairGuess& guess : guess_pairs(model_, *misfit_, places)) {
    if (fits.size() >= most) break;
    if (is_refitted(guess.causes)) continue;
    const std::vector<int> free = parameters_of(model_, guess.causes);
    const Linearisation& from = places[guess.from];
    std::vector<Eigen::VectorXd> starts{step_towards(from.u, guess.u, free), base_.u};
    for (const Refit& r : refits_)  // a pair may start from what its parts are like alone
      if (r.causes.size() == 1 &&
          std::find(guess.causes.begin(), guess.causes.end(), r.causes[0]) != guess.causes.end())
        starts.push_back(r.fit.u);
    fits.push_back(contender(guess.causes, starts, chosen(from.sensitivities, free), FitEffort::quick));
    causes.push_back(guess.causes);
  }
  race(std::move(causes), std::move(fits));
}

Explanations::Refit& Explanations::refit_with(const std::vector<int>& causes) {
  return *std::find_if(refits_.begin(), refits_.end(), [&](const Refit& r) { return r.causes == causes; });
}

void Explanations::polish(Refit& refit, FitEffort effort) {
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
  std::vector<StepwiseFit> fit;
  fit.push_back(contender(refit.causes, starts,
                          effort == FitEffort::thorough ? std::vector<Sensitivities>() : refit.fit.sensitivities,
                          effort));
  constexpr double never = std::numeric_limits<double>::infinity();
  run_side_by_side(bag_, fit, never, never, context_, fitting_stage);
  refit.fit = fit.front().fit();
  refit.polished = effort == FitEffort::thorough;
  weigh_refit(refit);
  normalise(hypotheses_);
}

void Explanations::polish_leaders() {
  // The best, and what polishing may make the best, until those that stand first have stood the test.
  std::set<std::vector<int>> leaders{{}};
  for (std::size_t count = 0; count < most_polished; ++count) {
    const double highest = hypotheses_.front().log_evidence;
    const auto next = std::find_if(hypotheses_.begin(), hypotheses_.end(), [&](const Hypothesis& h) {
      return !h.causes.empty() && !refit_of(h.causes).polished && h.log_evidence > highest - near_the_best;
    });
    if (next == hypotheses_.end()) break;
    const std::vector<int> causes = next->causes;
    polish(refit_with(causes), FitEffort::thorough);
  }
  const std::vector<int> best = hypotheses_.front().causes;
  if (best.size() == 2)
    for (const int cause : best) leaders.insert({cause});
  for (const std::size_t size : {1u, 0u})
    for (Refit& r : refits_)
      if (r.causes.size() == size && !r.polished && leaders.contains(r.causes)) polish(r, FitEffort::as_it_is);
}

void Explanations::refit() {
  const auto span = context_.span(0.4, 0.85, fitting_stage);
  objective_.emplace(model_, *misfit_, nearest_size(model_.known_misfit()), liberties_, liberty_sensitivities_);
  {
    const auto part = context_.span(0, pairs_ ? 0.3 : 0.6, fitting_stage);
    fit_singles();
  }
  if (pairs_) {
    const auto part = context_.span(0.3, 0.7, fitting_stage);
    fit_pairs();
  }
  {
    const auto part = context_.span(pairs_ ? 0.7 : 0.6, 1, fitting_stage);
    polish_leaders();
  }
  objective_.reset();
  renew_noise();
  // The others stay as the linearised model has them, but no better than the worst that was tried in earnest.
  double worst = std::numeric_limits<double>::infinity();
  for (const Hypothesis& h : hypotheses_)
    if (h.causes.size() == 1) worst = std::min(worst, h.log_evidence);
  for (Hypothesis h : screened_) {
    if (h.causes.size() != 1 || is_refitted(h.causes)) continue;
    h.log_evidence = std::min(h.log_evidence, worst);
    hypotheses_.push_back(h);
  }
  // A pair of which one does nothing is the other alone, found on another way.
  std::erase_if(hypotheses_, [&](const Hypothesis& h) { return h.causes.size() == 2 && !significant(h); });
  normalise(hypotheses_);
}

}  // namespace formwright
