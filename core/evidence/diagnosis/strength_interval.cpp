// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/diagnosis/strength_interval.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "evidence/explanations/fitted_strength.h"
#include "evidence/explanations/wide_secants.h"

namespace formwright {
namespace {

constexpr double max_factor = 10;  // between two simulations

/// Standard deviation of the logarithm of the strength.
double log_deviation(const Explanations& tried, SimulationBag& bag, const std::vector<int>& causes, int cause,
                     Context& context) {
  const ForwardModel& model = bag.model();
  double variance = 0;
  const auto own = step_on_wide_secants(bag, tried, causes, {}, context);
  if (!own) return 0;
  for (const int d : model.parameters_with(ParameterRole::discrepancy)) {
    const auto step = step_on_wide_secants(bag, tried, causes, d, context);
    if (!step) continue;
    const double log_factor = std::log(strength_factor(model, cause, *own, *step));
    variance += std::pow(model.parameters()[static_cast<std::size_t>(d)].prior_sd * log_factor, 2);
  }
  return std::sqrt(variance);
}

}  // namespace

double half_width(const CauseFinding& finding) { return 0.5 * (finding.high - finding.low); }

void set_half_width(CauseFinding& finding, double half) {
  finding.low = finding.strength - half;
  finding.high = finding.strength + half;
}

double change(const ForwardModel& model, const CauseFinding& finding) {
  const std::vector<int>& own = model.causes()[static_cast<std::size_t>(finding.cause)].parameters;
  double squares = 0;
  for (std::size_t k = 0; k < own.size(); ++k)
    squares += std::pow(finding.values[k] - model.parameters()[static_cast<std::size_t>(own[k])].nominal, 2);
  return std::sqrt(squares);
}

double strength_factor(const ForwardModel& model, int cause, const Eigen::VectorXd& from, const Eigen::VectorXd& u) {
  const std::vector<int>& own = model.causes()[static_cast<std::size_t>(cause)].parameters;
  const Eigen::VectorXd here = from(own), there = u(own);
  const double squares = here.squaredNorm();
  return squares > 0 ? std::clamp(there.dot(here) / squares, 1 / max_factor, max_factor) : 1;
}

void widen_by_jackknife(const ForwardModel& model, const ParameterFit& extended, const Eigen::MatrixXd& steps,
                        CauseFinding& finding) {
  const double variance =
      beyond_noise(jackknife_deviation(model, extended, steps, finding.cause, finding.values), finding.noise_deviation);
  set_half_width(finding, std::sqrt(std::pow(half_width(finding), 2) + normal_quantile * normal_quantile * variance));
}

double half_width_with_model(const ForwardModel& model, const CauseFinding& finding) {
  // What is just visible is four standard deviations.
  const double misfit = std::isfinite(finding.min_visible_strength)
                            ? 4 * beyond_noise(0.25 * finding.min_visible_strength, finding.noise_deviation)
                            : 0;
  const double gain =
      normal_quantile * model.causes()[static_cast<std::size_t>(finding.cause)].gain_error * change(model, finding);
  return std::sqrt(std::pow(half_width(finding), 2) + misfit + gain * gain);
}

void widen_by_other_simulations(Diagnosis& result, const Explanations& tried, SimulationBag& bag, Context& context) {
  std::vector<int> causes = result.verdict;
  std::sort(causes.begin(), causes.end());
  if (causes.empty() || !tried.is_refitted(causes)) return;
  for (CauseFinding& finding : result.causes) {
    if (std::find(causes.begin(), causes.end(), finding.cause) == causes.end()) continue;
    const double deviation = normal_quantile * log_deviation(tried, bag, causes, finding.cause, context);
    const double half = half_width(finding), length = std::abs(finding.strength);
    const double more = std::hypot(half, length * std::expm1(deviation)),
                 less = std::hypot(half, -length * std::expm1(-deviation));
    const bool negative = finding.strength < 0;
    finding.low = finding.strength - (negative ? more : less);
    finding.high = finding.strength + (negative ? less : more);
  }
}

void keep_in_range(const ForwardModel& model, CauseFinding& finding) {
  const std::vector<int>& own = model.causes()[static_cast<std::size_t>(finding.cause)].parameters;
  if (own.size() > 1) {
    finding.low = std::max(finding.low, 0.0);
    return;
  }
  const ModelParameter& parameter = model.parameters()[static_cast<std::size_t>(own.front())];
  finding.low = std::min(std::max(finding.low, parameter.low), finding.strength);
  finding.high = std::max(std::min(finding.high, parameter.high), finding.strength);
}

}  // namespace formwright
