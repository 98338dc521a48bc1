// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/explanations.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "base/error.h"

namespace formwright {
namespace {

constexpr std::size_t refitted_singles = 8, leader_count = 4;
constexpr int refitted_pairs = 6, quick_iterations = 5, polishing_iterations = 8;
constexpr double out_of_reach = 60;     // log evidence that polishing does not make up for
constexpr double least_movement = 0.5;  // of the known misfit

std::vector<int> joined(std::vector<int> a, const std::vector<int>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

std::vector<int> parameters_of(const ForwardModel& model, const std::vector<int>& causes) {
  std::vector<int> list = model.base_parameters();
  for (const int cause : causes) list = joined(std::move(list), model.causes()[static_cast<std::size_t>(cause)].parameters);
  return list;
}

/// Columns of `all` (in the order of `columns`) that belong to `wanted`.
std::vector<Sensitivities> chosen(const std::vector<Sensitivities>& all, const std::vector<int>& columns, const std::vector<int>& wanted) {
  std::vector<Sensitivities> result(all.size());
  for (const int p : wanted) {
    const auto at = static_cast<std::size_t>(std::find(columns.begin(), columns.end(), p) - columns.begin());
    for (std::size_t object = 0; object < all.size(); ++object) result[object].push_back(all[object][at]);
  }
  return result;
}

std::vector<Sensitivities> side_by_side(std::vector<Sensitivities> a, const std::vector<Sensitivities>& b) {
  for (std::size_t object = 0; object < a.size(); ++object) a[object].insert(a[object].end(), b[object].begin(), b[object].end());
  return a;
}

}  // namespace

bool Explanations::is_refitted(const std::vector<int>& causes) const {
  return std::any_of(refits_.begin(), refits_.end(), [&](const Refit& r) { return r.causes == causes; });
}

void Explanations::estimate_noise_about(const Predictions& predictions) {
  weights_.clear();
  noise_.clear();
  const Predictions left = residuals(model_, predictions);
  for (std::size_t object = 0; object < left.size(); ++object) {
    noise_.push_back(estimate_noise(model_.measurements()[object], left[object]));
    weights_.push_back(noise_.back().weights);
  }
}

void Explanations::calibrate() {
  const auto span = context_.span(0, 0.2, "Calibrating");
  const auto at_nominal = bag_.run(model_.nominal(), context_, "Calibrating");
  if (!at_nominal) throw Error(ErrorCode::could_not_solve, "", "The simulation fails with the set-up's own parameters: check mould and set-up.");
  estimate_noise_about(*at_nominal);
  base_ = fit_parameters(bag_, *mean_distance_objective(model_, softness()), model_.base_parameters(), model_.nominal(), {}, {}, context_, "Calibrating");
  estimate_noise_about(base_.predictions);
  misfit_.emplace(model_, weights_);
}

void Explanations::screen() {
  const auto span = context_.span(0.2, 0.4, "Trying each effect");
  columns_.clear();
  for (std::size_t p = 0; p < model_.parameters().size(); ++p) columns_.push_back(static_cast<int>(p));
  sensitivities_ = sensitivities_at(bag_, base_.u, base_.predictions, columns_, context_, "Trying each effect");
  liberties_ = model_.parameters_with(ParameterRole::discrepancy);
  liberty_sensitivities_ = chosen(sensitivities_, columns_, liberties_);
  weights_ = weights_with_liberties(model_, std::move(weights_), liberties_, liberty_sensitivities_);
  misfit_.emplace(model_, weights_);
  const GramByStructure gram = misfit_->gram(residuals(model_, base_.predictions), sensitivities_);
  screened_ = all_hypotheses(model_, pairs_);
  for (Hypothesis& h : screened_) weigh(model_, gram, columns_, base_.u, h);
  normalise(screened_);
}

const Hypothesis& Explanations::screened(const std::vector<int>& causes, bool unknown) const {
  return *std::find_if(screened_.begin(), screened_.end(), [&](const Hypothesis& h) { return h.causes == causes && h.unknown_structure == unknown; });
}

std::size_t Explanations::nearest_size(double structure) const {
  const std::vector<double>& sizes = misfit_->sizes();
  std::size_t best = 1;
  for (std::size_t t = 1; t < sizes.size(); ++t)
    if (std::abs(sizes[t] - structure) < std::abs(sizes[best] - structure)) best = t;
  return best;
}

ParameterFit Explanations::fit_from(const std::vector<int>& causes, const std::vector<Eigen::VectorXd>& starts, std::vector<Sensitivities> known, int iterations) {
  const std::vector<int> free = parameters_of(model_, causes);
  const StructuredObjective objective(model_, *misfit_, nearest_size(model_.known_misfit()), liberties_, liberty_sensitivities_);
  const auto predictions = bag_.run(starts, context_, fitting_stage);
  std::size_t best = 0;
  double best_value = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < starts.size(); ++i) {
    if (!predictions[i]) continue;
    const double value = objective.value(residuals(model_, *predictions[i]), starts[i]);
    if (value < best_value) best = i, best_value = value;
  }
  FitOptions options;
  options.most_iterations = iterations;
  options.tolerance = 0.01;
  options.renew_sensitivities = iterations > quick_iterations;
  return fit_parameters(bag_, objective, free, starts[best], std::move(known), options, context_, fitting_stage);
}

void Explanations::refit_with(const std::vector<int>& causes) {
  const Hypothesis& plain = screened(causes, false);
  const Hypothesis& rough = screened(causes, true);
  const Hypothesis& start = plain.probability >= rough.probability ? plain : rough;
  const std::vector<int> free = parameters_of(model_, causes);
  // Secants hold within a few probes: a longer way is gone in steps.
  Eigen::VectorXd u = base_.u;
  for (const int p : free) {
    const double reach = 3 * model_.parameters()[static_cast<std::size_t>(p)].probe;
    u[p] += std::clamp(start.u[p] - u[p], -reach, reach);
  }
  std::vector<Eigen::VectorXd> starts{base_.u, u};
  for (const auto& r : refits_)  // a pair may start from what its parts are like alone
    if (causes.size() == 2 && r.causes.size() == 1 && (r.causes[0] == causes[0] || r.causes[0] == causes[1])) starts.push_back(r.fit.u);
  refits_.push_back({fit_from(causes, starts, chosen(sensitivities_, columns_, free), quick_iterations), causes});
  if (const Eigen::VectorXd far = far_start(causes); far.size() > 0) {
    // The calibrated base may have swallowed an effect that only goes one way: nothing near it points back.
    ParameterFit other = fit_from(causes, {far}, {}, quick_iterations);
    if (other.value < refits_.back().fit.value) refits_.back().fit = std::move(other);
  }
  weigh_refit(refits_.back());
}

Eigen::VectorXd Explanations::far_start(const std::vector<int>& causes) {
  if (causes.size() != 1) return {};
  Eigen::VectorXd u = 0.5 * base_.u;
  bool one_sided = false;
  for (const int p : model_.causes()[static_cast<std::size_t>(causes.front())].parameters) {
    const ModelParameter& parameter = model_.parameters()[static_cast<std::size_t>(p)];
    u[p] = parameter.prior_sd;
    one_sided |= parameter.one_sided();
  }
  u = within_ranges(model_, u);
  return one_sided && bag_.run(u, context_, fitting_stage) ? u : Eigen::VectorXd();
}

void Explanations::polish(Refit& refit) {
  std::vector<Eigen::VectorXd> starts{refit.fit.u};
  for (const Refit& larger : refits_) {
    if (larger.causes.size() <= refit.causes.size() || !std::includes(larger.causes.begin(), larger.causes.end(), refit.causes.begin(), refit.causes.end())) continue;
    Eigen::VectorXd u = larger.fit.u;
    for (std::size_t p = 0; p < model_.parameters().size(); ++p)
      if (std::find(refit.fit.free.begin(), refit.fit.free.end(), static_cast<int>(p)) == refit.fit.free.end()) u[static_cast<Eigen::Index>(p)] = 0;
    starts.push_back(u);
  }
  refit.fit = fit_from(refit.causes, starts, {}, polishing_iterations);
  weigh_refit(refit);
}

void Explanations::weigh_refit(const Refit& refit) {
  const std::vector<int> columns = joined(refit.fit.free, liberties_);
  const GramByStructure gram = misfit_->gram(residuals(model_, refit.fit.predictions), side_by_side(refit.fit.sensitivities, liberty_sensitivities_));
  for (const bool unknown : {false, true}) {
    auto at = std::find_if(hypotheses_.begin(), hypotheses_.end(), [&](const Hypothesis& h) { return h.causes == refit.causes && h.unknown_structure == unknown; });
    if (at == hypotheses_.end()) at = hypotheses_.insert(at, screened(refit.causes, unknown));
    weigh(model_, gram, columns, refit.fit.u, *at);
    at->u = refit.fit.u;
  }
}

void Explanations::renew_noise() {
  estimate_noise_about(refit_of(hypotheses_.front().causes).fit.predictions);
  weights_ = weights_with_liberties(model_, std::move(weights_), liberties_, liberty_sensitivities_);
  misfit_.emplace(model_, weights_);
  const GramByStructure gram = misfit_->gram(residuals(model_, base_.predictions), sensitivities_);
  for (Hypothesis& h : screened_) weigh(model_, gram, columns_, base_.u, h);
  normalise(screened_);
  for (const Refit& refit : refits_) weigh_refit(refit);
  normalise(hypotheses_);
}

void Explanations::refit() {
  const auto span = context_.span(0.4, 0.85, fitting_stage);
  std::vector<std::vector<int>> singles{{}};
  for (const Hypothesis& h : screened_)
    if (h.causes.size() == 1 && std::find(singles.begin(), singles.end(), h.causes) == singles.end() && singles.size() <= refitted_singles) singles.push_back(h.causes);
  const double parts = static_cast<double>(singles.size()) + (pairs_ ? refitted_pairs : 0) + 2 * leader_count;
  double part = 0;
  const auto stage = [&](auto&& work) {
    // More leaders may have to be polished than were counted on.
    const auto step = context_.span(std::min(1.0, part / parts), std::min(1.0, (part + 1) / parts), fitting_stage);
    work();
    part += 1;
  };
  for (const auto& causes : singles) stage([&] { refit_with(causes); });
  normalise(hypotheses_);
  if (pairs_)
    for (const std::vector<int>& pair : promising_pairs()) stage([&] { refit_with(pair); });
  normalise(hypotheses_);
  // The leaders, what they are parts of and have as parts, larger ones first.
  std::set<std::vector<int>> leaders{{}};
  const double highest = hypotheses_.front().log_evidence;
  for (const Hypothesis& h : hypotheses_) {
    if (leaders.size() > leader_count || (leaders.size() > 2 && h.log_evidence < highest - out_of_reach)) break;
    leaders.insert(h.causes);
    if (h.causes.size() == 2)
      for (const int cause : h.causes) leaders.insert({cause});
  }
  for (const std::size_t size : {2u, 1u, 0u})
    for (Refit& r : refits_)
      if (r.causes.size() == size && leaders.contains(r.causes)) stage([&] { polish(r); });
  normalise(hypotheses_);
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

std::vector<std::vector<int>> Explanations::promising_pairs() const {
  std::vector<Hypothesis> candidates;
  for (const Hypothesis& h : screened_)
    if (h.causes.size() == 2 && candidates.size() < static_cast<std::size_t>(refitted_pairs) / 3) candidates.push_back(h);
  std::vector<Hypothesis> from_singles;
  int leaders = 0;
  for (const Hypothesis& leader : hypotheses_) {
    if (leader.causes.size() != 1 || leaders >= 3) continue;
    const auto r = std::find_if(refits_.begin(), refits_.end(), [&](const Refit& f) { return f.causes == leader.causes; });
    const GramByStructure gram = misfit_->gram(residuals(model_, r->fit.predictions), sensitivities_);
    for (Hypothesis h : all_hypotheses(model_, true)) {
      if (h.causes.size() != 2 || (h.causes[0] != leader.causes[0] && h.causes[1] != leader.causes[0])) continue;
      weigh(model_, gram, columns_, r->fit.u, h);
      from_singles.push_back(h);
    }
    ++leaders;
  }
  if (!from_singles.empty()) normalise(from_singles);
  candidates.insert(candidates.end(), from_singles.begin(), from_singles.end());
  std::vector<std::vector<int>> pairs;
  for (const Hypothesis& h : candidates)
    if (std::find(pairs.begin(), pairs.end(), h.causes) == pairs.end() && pairs.size() < static_cast<std::size_t>(refitted_pairs)) pairs.push_back(h.causes);
  return pairs;
}

const Explanations::Refit& Explanations::refit_of(const std::vector<int>& causes) const {
  return *std::find_if(refits_.begin(), refits_.end(), [&](const Refit& r) { return r.causes == causes; });
}

double Explanations::structure_left(const std::vector<int>& causes) const {
  double structure = 0, weight = 0;
  for (const Hypothesis& h : hypotheses_)
    if (h.causes == causes) structure += (h.probability + 1e-300) * h.structure, weight += h.probability + 1e-300;
  return structure / weight;
}

double Explanations::softness() const {
  double soft = 0;
  for (const NoiseEstimate& noise : noise_) soft = std::max(soft, noise.sigma);
  return soft;
}

double Explanations::movement(int cause, const Eigen::VectorXd& u) const {
  double squares = 0, count = 0;
  for (std::size_t object = 0; object < sensitivities_.size(); ++object) {
    const Measurement& m = model_.measurements()[object];
    Eigen::MatrixXd field = Eigen::MatrixXd::Zero(m.measured.rows(), m.measured.cols());
    for (const int p : model_.causes()[static_cast<std::size_t>(cause)].parameters) field += u[p] * sensitivities_[object][static_cast<std::size_t>(p)];
    squares += field.squaredNorm();
    count += static_cast<double>(m.measured.rows());
  }
  return std::sqrt(squares / std::max(count, 1.0));
}

bool Explanations::significant(const Hypothesis& h) const {
  return std::all_of(h.causes.begin(), h.causes.end(), [&](int cause) { return movement(cause, h.u) > least_movement * model_.known_misfit(); });
}

}  // namespace formwright
