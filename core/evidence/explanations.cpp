// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/explanations.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"

namespace formwright {
namespace {

constexpr double least_movement = 0.5;  // of the known misfit

std::vector<int> joined(std::vector<int> a, const std::vector<int>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// Columns of `all` (in the order of `columns`) that belong to `wanted`.
std::vector<Sensitivities> chosen(const std::vector<Sensitivities>& all, const std::vector<int>& columns,
                                  const std::vector<int>& wanted) {
  std::vector<Sensitivities> result(all.size());
  for (const int p : wanted) {
    const auto at = static_cast<std::size_t>(std::find(columns.begin(), columns.end(), p) - columns.begin());
    for (std::size_t object = 0; object < all.size(); ++object) result[object].push_back(all[object][at]);
  }
  return result;
}

std::vector<Sensitivities> side_by_side(std::vector<Sensitivities> a, const std::vector<Sensitivities>& b) {
  for (std::size_t object = 0; object < a.size(); ++object)
    a[object].insert(a[object].end(), b[object].begin(), b[object].end());
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
  if (!at_nominal)
    throw Error(ErrorCode::could_not_solve, "",
                "The simulation fails with the set-up's own parameters: check mould and set-up.");
  estimate_noise_about(*at_nominal);
  base_ = fit_parameters(bag_, *mean_distance_objective(model_, softness()), model_.base_parameters(), model_.nominal(),
                         {}, {}, context_, "Calibrating");
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
  return *std::find_if(screened_.begin(), screened_.end(),
                       [&](const Hypothesis& h) { return h.causes == causes && h.unknown_structure == unknown; });
}

std::size_t Explanations::nearest_size(double structure) const {
  const std::vector<double>& sizes = misfit_->sizes();
  std::size_t best = 1;
  for (std::size_t t = 1; t < sizes.size(); ++t)
    if (std::abs(sizes[t] - structure) < std::abs(sizes[best] - structure)) best = t;
  return best;
}

void Explanations::weigh_refit(const Refit& refit) {
  const std::vector<int> columns = joined(refit.fit.free, liberties_);
  const GramByStructure gram = misfit_->gram(residuals(model_, refit.fit.predictions),
                                             side_by_side(refit.fit.sensitivities, liberty_sensitivities_));
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
  estimate_noise_about(refit_of(hypotheses_.front().causes).fit.predictions);
  weights_ = weights_with_liberties(model_, std::move(weights_), liberties_, liberty_sensitivities_);
  misfit_.emplace(model_, weights_);
  const GramByStructure gram = misfit_->gram(residuals(model_, base_.predictions), sensitivities_);
  for (Hypothesis& h : screened_) weigh(model_, gram, columns_, base_.u, h);
  normalise(screened_);
  for (const Refit& refit : refits_) weigh_refit(refit);
  normalise(hypotheses_);
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
    for (const int p : model_.causes()[static_cast<std::size_t>(cause)].parameters)
      field += u[p] * sensitivities_[object][static_cast<std::size_t>(p)];
    squares += field.squaredNorm();
    count += static_cast<double>(m.measured.rows());
  }
  return std::sqrt(squares / std::max(count, 1.0));
}

bool Explanations::significant(const Hypothesis& h) const {
  return std::all_of(h.causes.begin(), h.causes.end(),
                     [&](int cause) { return movement(cause, h.u) > least_movement * model_.known_misfit(); });
}

}  // namespace formwright
