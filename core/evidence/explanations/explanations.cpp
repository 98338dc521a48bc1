// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/explanations/explanations.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "base/error.h"
#include "evidence/explanations/likeness.h"
#include "evidence/fit/free_fit.h"

namespace formwright {
namespace {

constexpr std::size_t refitted_singles = 8, refitted_pairs = 6, pair_anchors = 4, leader_count = 4;

}  // namespace

bool Explanations::is_refitted(const std::vector<int>& causes) const {
  return std::any_of(refits_.begin(), refits_.end(), [&](const Refit& r) { return r.causes == causes; });
}

void Explanations::estimate_noise_about(const Predictions& predictions) {
  noise_.clear();
  std::vector<Eigen::VectorXd> weights;
  const Predictions left = residuals(model_, predictions);
  for (std::size_t object = 0; object < left.size(); ++object) {
    noise_.push_back(estimate_noise(model_.measurements()[object], left[object]));
    weights.push_back(noise_.back().weights);
  }
  movements_.resize(left.size());
  precisions_ = precisions_of(model_, weights, movements_);
  misfit_.emplace(model_, precisions_);
}

void Explanations::calibrate(const Eigen::VectorXd& start) {
  const auto span = context_.span(0, 0.08, "Calibrating");
  auto at_nominal = [&] {
    const auto begin = context_.span(0, 0.05, "Calibrating");
    return bag_.run(model_.nominal(), context_, "Calibrating");
  }();
  if (!at_nominal)
    throw Error(ErrorCode::could_not_solve, "",
                "The simulation fails with the set-up's own parameters: check mould and set-up.");
  at_nominal_ = std::move(*at_nominal);
  estimate_noise_about(at_nominal_);
  const auto rest = context_.span(0.05, 1, "Calibrating");
  std::vector<Eigen::VectorXd> starts{model_.nominal()};
  if (start.size() > 0) starts.push_back(start);
  base_ = fit_parameters(bag_, {mean_distance_objective(model_, softness()), model_.base_parameters(), starts},
                         context_, "Calibrating");
  estimate_noise_about(base_.predictions);
}

void Explanations::screen() {
  const auto span = context_.span(0.08, 0.2, "Trying each effect");
  columns_.clear();
  for (std::size_t p = 0; p < model_.parameters().size(); ++p) columns_.push_back(static_cast<int>(p));
  Probing about_base, about_nominal;
  {
    const auto half = context_.span(0, 0.5, "Trying each effect");
    about_base = probe_around(bag_, base_.u, base_.predictions, columns_, context_, "Trying each effect");
    sensitivities_ = about_base.sensitivities;
  }
  {
    const auto half = context_.span(0.5, 1, "Trying each effect");
    about_nominal = probe_around(bag_, model_.nominal(), at_nominal_, columns_, context_, "Trying each effect");
    nominal_sensitivities_ = about_nominal.sensitivities;
  }
  discrepancies_ = model_.parameters_with(ParameterRole::discrepancy);
  discrepancy_sensitivities_ = sensitivities_of(discrepancies_, sensitivities_, columns_);
  movements_ = movements_of(model_, discrepancies_, discrepancy_sensitivities_);
  // A fit cannot settle what the simulation itself does by leaps: such places tell less.
  for (std::size_t object = 0; object < movements_.size(); ++object)
    for (const Probing* probing : {&about_base, &about_nominal})
      for (const Eigen::MatrixXd& bend : probing->bends[object]) movements_[object].push_back(std::sqrt(0.5) * bend);
  look_for_strong_cause();
  estimate_noise_freely();
  screened_ = all_hypotheses(model_, pairs_);
  weigh_screened();
}

void Explanations::look_for_strong_cause() {
  const auto objective = mean_distance_objective(model_, softness());
  const double calibrated = objective->value(residuals(model_, base_.predictions), base_.u);
  strong_ = strong_cause_instead_of(calibrated, bag_, *objective, context_, "Trying each effect");
  if (!strong_) return;
  strong_sensitivities_ = nominal_sensitivities_;
  const std::vector<int>& own = model_.causes()[static_cast<std::size_t>(strong_->cause)].parameters;
  if (own.size() == 1)  // the secant from none to there
    for (std::size_t object = 0; object < strong_sensitivities_.size(); ++object)
      strong_sensitivities_[object][static_cast<std::size_t>(own.front())] =
          (strong_->predictions[object] - at_nominal_[object]) / strong_->u[own.front()];
}

void Explanations::estimate_noise_freely() {
  const Predictions about_base = freely_fitted(model_, base_.predictions, columns_, sensitivities_);
  estimate_noise_about(about_base);
  if (!strong_) return;
  const double noise = softness();
  estimate_noise_about(freely_fitted(model_, strong_->predictions, columns_, strong_sensitivities_));
  if (softness() > noise) estimate_noise_about(about_base);
}

std::vector<Sensitivities> Explanations::usual_sensitivities() {
  if (coarser_ != nullptr) return coarser_->usual_sensitivities();
  return at_usual_strengths(bag_, at_nominal_, nominal_sensitivities_, context_, "Predicting the held-out data");
}

std::vector<double> Explanations::likenesses() const {
  return formwright::likenesses(model_, misfit_->gram(residuals(model_, base_.predictions), sensitivities_));
}

void Explanations::weigh_screened() {
  const GramByStructure about_base = misfit_->gram(residuals(model_, base_.predictions), sensitivities_);
  about_nominal_ = misfit_->gram(residuals(model_, at_nominal_), nominal_sensitivities_);
  const GramByStructure about_strong =
      strong_ ? misfit_->gram(residuals(model_, strong_->predictions), strong_sensitivities_) : GramByStructure{};
  for (Hypothesis& h : screened_) {
    Hypothesis best = h;
    weigh(model_, about_base, columns_, base_.u, best);
    const auto weigh_about = [&](const GramByStructure& gram, const Eigen::VectorXd& u) {
      Hypothesis other = h;
      weigh(model_, gram, columns_, u, other);
      if (other.log_evidence > best.log_evidence) best = std::move(other);
    };
    weigh_about(about_nominal_, model_.nominal());
    if (strong_ && std::find(h.causes.begin(), h.causes.end(), strong_->cause) != h.causes.end())
      weigh_about(about_strong, strong_->u);
    h = std::move(best);
  }
  normalise(screened_);
}

const Hypothesis& Explanations::screened(const std::vector<int>& causes, bool unknown) const {
  return *std::find_if(screened_.begin(), screened_.end(),
                       [&](const Hypothesis& h) { return h.causes == causes && h.unknown_structure == unknown; });
}

NuisanceParameters Explanations::nuisances(const std::vector<int>& causes) const {
  NuisanceParameters result{discrepancies_, {}};
  for (const int p : columns_) {
    const ModelParameter& parameter = model_.parameters()[static_cast<std::size_t>(p)];
    if (parameter.role == ParameterRole::effect && parameter.usual_sd > 0 && !model_.is_of(p, causes))
      result.parameters.push_back(p);
  }
  result.sensitivities = sensitivities_of(result.parameters, sensitivities_, columns_);
  return result;
}

std::size_t Explanations::nearest_size(double structure) const {
  const std::vector<double>& sizes = misfit_->sizes();
  std::size_t best = 1;
  for (std::size_t t = 1; t < sizes.size(); ++t)
    if (std::abs(sizes[t] - structure) < std::abs(sizes[best] - structure)) best = t;
  return best;
}

void Explanations::weigh_refit(const Refit& refit) {
  const NuisanceParameters other = nuisances(refit.causes);
  const std::vector<int> columns = joined(refit.fit.free, other.parameters);
  const GramByStructure gram = misfit_->gram(residuals(model_, refit.fit.predictions),
                                             side_by_side(refit.fit.sensitivities, other.sensitivities));
  for (const bool unknown : {false, true}) {
    auto at = std::find_if(hypotheses_.begin(), hypotheses_.end(), [&](const Hypothesis& h) {
      return h.causes == refit.causes && h.unknown_structure == unknown;
    });
    if (at == hypotheses_.end()) at = hypotheses_.insert(at, screened(refit.causes, unknown));
    weigh(model_, gram, columns, refit.fit.u, *at);
    at->u = refit.fit.u;
  }
}

void Explanations::renew_noise() {
  estimate_noise_about(
      freely_fitted(model_, refit_of(hypotheses_.front().causes).fit.predictions, columns_, sensitivities_));
  weigh_screened();
  for (const Refit& refit : refits_) weigh_refit(refit);
  normalise(hypotheses_);
}

void Explanations::refit() {
  const auto span = context_.span(0.2, 0.75, fitting_stage);
  std::vector<std::vector<int>> singles;
  for (const Hypothesis& h : screened_)
    if (h.causes.size() == 1 && std::find(singles.begin(), singles.end(), h.causes) == singles.end() &&
        singles.size() < refitted_singles)
      singles.push_back(h.causes);
  constexpr double leader_end = 0.2, singles_end = 0.5, search_end = 0.7, pairs_end = 0.8;
  const double none_searched_end = pairs_ ? singles_end : pairs_end;
  std::vector<std::vector<int>> first{{}};
  if (!singles.empty()) first.push_back(singles.front());
  {
    const auto part = context_.span(0, leader_end, fitting_stage);
    refit_singles(first);
  }
  std::erase_if(singles, [&](const std::vector<int>& causes) { return is_refitted(causes) || cannot_lead(causes); });
  {
    const auto part = context_.span(leader_end, none_searched_end, fitting_stage);
    refit_singles(singles);
  }
  normalise(hypotheses_);
  if (pairs_) {
    const std::vector<PairGuess> pairs = [&] {
      const auto part = context_.span(singles_end, search_end, fitting_stage);
      return promising_pairs();
    }();
    const auto part = context_.span(search_end, pairs_end, fitting_stage);
    refit_pairs(pairs);
    normalise(hypotheses_);
  }
  {
    const auto part = context_.span(pairs_end, 1, fitting_stage);
    polish_leaders(leader_count);
  }
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
  // A pair of which one does nothing is the other alone, found from another start.
  std::erase_if(hypotheses_, [&](const Hypothesis& h) { return h.causes.size() == 2 && !significant(h); });
  double without = std::numeric_limits<double>::infinity();
  for (const Hypothesis& h : hypotheses_)
    if (h.causes.empty()) without = std::min(without, h.log_evidence);
  for (Hypothesis& h : hypotheses_)
    if (h.causes.size() == 1 && is_too_weak(h.causes.front(), h.u)) h.log_evidence = std::min(h.log_evidence, without);
  normalise(hypotheses_);
}

std::vector<PairGuess> Explanations::promising_pairs() {
  std::vector<FittedSingle> singles;
  for (const Hypothesis& h : hypotheses_) {
    if (h.causes.size() != 1 ||
        std::any_of(singles.begin(), singles.end(), [&](const FittedSingle& s) { return s.cause == h.causes[0]; }))
      continue;
    const ParameterFit& fit = refit_of(h.causes).fit;
    singles.push_back({h.causes[0], fit.u, fit.predictions});
  }
  const NuisanceParameters equal{discrepancies_, discrepancy_sensitivities_};
  const auto objective =
      std::make_shared<StructuredObjective>(model_, *misfit_, nearest_size(model_.known_misfit()), equal);
  PairSearch search =
      search_pairs(model_, *misfit_, objective, equal, singles, pair_anchors, context_, "Searching for two causes");
  cheap_simulations_ += search.simulations;
  if (search.guesses.size() > refitted_pairs) search.guesses.resize(refitted_pairs);
  return std::move(search.guesses);
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

double Explanations::softness() const { return largest_noise(model_, noise_); }

double Explanations::movement(int cause, const Eigen::VectorXd& u) const {
  const std::vector<int>& own = model_.causes()[static_cast<std::size_t>(cause)].parameters;
  // The calibration that a strong cause has dragged off may lie where it does nothing.
  return strong_ && strong_->cause == cause ? movement_by(own, u, strong_sensitivities_) : movement_by(own, u);
}

double Explanations::movement_by(const std::vector<int>& parameters, const Eigen::VectorXd& u) const {
  return movement_by(parameters, u, sensitivities_);
}

double Explanations::movement_by(const std::vector<int>& parameters, const Eigen::VectorXd& u,
                                 const std::vector<Sensitivities>& sensitivities) const {
  double squares = 0, count = 0;
  for (std::size_t object = 0; object < sensitivities.size(); ++object) {
    const Measurement& m = model_.measurements()[object];
    Eigen::MatrixXd field = Eigen::MatrixXd::Zero(m.measured.rows(), m.measured.cols());
    for (const int p : parameters) field += u[p] * sensitivities[object][static_cast<std::size_t>(p)];
    squares += field.squaredNorm();
    count += static_cast<double>(m.measured.rows());
  }
  return std::sqrt(squares / std::max(count, 1.0));
}

bool Explanations::is_too_weak(int cause, const Eigen::VectorXd& u) const {
  return model_.strength(cause, u) < model_.causes()[static_cast<std::size_t>(cause)].min_strength;
}

std::vector<int> Explanations::causes_that_move(const std::vector<int>& causes, const Eigen::VectorXd& u) const {
  std::vector<int> moving;
  for (const int cause : causes)
    if (movement(cause, u) > min_movement * model_.known_misfit() && !is_too_weak(cause, u)) moving.push_back(cause);
  return moving;
}

bool Explanations::significant(const Hypothesis& h) const {
  return causes_that_move(h.causes, h.u).size() == h.causes.size();
}

}  // namespace formwright
