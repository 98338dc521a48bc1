// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/stepwise_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"

namespace formwright {
namespace {

constexpr double first_damping = 0.03, shorter = 30, hopeless_damping = 1e4;
constexpr double longest_step = 4;  // in probes: secants hold about as far
constexpr int sporting_steps = 2;   // before a fit may be given up
constexpr double optimism = 2;      // a step may gain more than its quadratic model says

}  // namespace

std::vector<Eigen::VectorXd> probe_points(const ForwardModel& model, const Eigen::VectorXd& u,
                                          const std::vector<int>& free) {
  std::vector<Eigen::VectorXd> points;
  for (const int p : free)
    for (const double sign : {1.0, -1.0}) {
      Eigen::VectorXd moved = u;
      moved[p] += sign * model.parameters()[static_cast<std::size_t>(p)].probe;
      const bool switched =
          model.parameters()[static_cast<std::size_t>(p)].role == ParameterRole::discrepancy && sign < 0;
      points.push_back(switched ? u : within_ranges(model, moved));
    }
  return points;
}

std::vector<Sensitivities> sensitivities_from(const ForwardModel& model, const Eigen::VectorXd& u,
                                              const Predictions& at_u, const std::vector<int>& free,
                                              const std::vector<Eigen::VectorXd>& points,
                                              const std::vector<std::optional<Predictions>>& answers) {
  std::vector<Sensitivities> result(at_u.size());
  for (std::size_t i = 0; i < free.size(); ++i) {
    const Eigen::Index p = free[i];
    const bool plus = answers[2 * i] && points[2 * i][p] != u[p],
               minus = answers[2 * i + 1] && points[2 * i + 1][p] != u[p];
    if (!plus && !minus)
      throw Error(
          ErrorCode::could_not_solve, "",
          "The simulation fails on both sides of " + model.parameters()[static_cast<std::size_t>(p)].label + ".");
    const double upper = plus ? points[2 * i][p] : u[p], lower = minus ? points[2 * i + 1][p] : u[p];
    for (std::size_t object = 0; object < at_u.size(); ++object)
      result[object].push_back(
          ((plus ? (*answers[2 * i])[object] : at_u[object]) - (minus ? (*answers[2 * i + 1])[object] : at_u[object])) /
          (upper - lower));
  }
  return result;
}

void broyden_update(const ForwardModel& model, std::vector<Sensitivities>& sensitivities, const std::vector<int>& free,
                    const Predictions& before, const Predictions& after, const Eigen::VectorXd& step) {
  // J += (y - J s) s^T D / (s^T D s) with D = diag(1 / probe^2).
  const auto k = static_cast<Eigen::Index>(free.size());
  Eigen::VectorXd s(k), scaled(k);
  for (Eigen::Index a = 0; a < k; ++a) {
    const int p = free[static_cast<std::size_t>(a)];
    s[a] = step[p];
    scaled[a] = s[a] / std::pow(model.parameters()[static_cast<std::size_t>(p)].probe, 2);
  }
  const double length = s.dot(scaled);
  if (!(length > 1e-12)) return;
  for (std::size_t object = 0; object < sensitivities.size(); ++object) {
    Sensitivities& J = sensitivities[object];
    Eigen::MatrixXd miss = after[object] - before[object];
    for (Eigen::Index a = 0; a < k; ++a) miss -= s[a] * J[static_cast<std::size_t>(a)];
    for (Eigen::Index a = 0; a < k; ++a) J[static_cast<std::size_t>(a)] += miss * (scaled[a] / length);
  }
}

StepwiseFit::StepwiseFit(const ForwardModel& model, const FitObjective& objective, std::vector<int> free,
                         const std::vector<Eigen::VectorXd>& starts, std::vector<Sensitivities> known,
                         const FitOptions& options)
    : model_(model), objective_(objective), options_(options), damping_(first_damping) {
  for (const Eigen::VectorXd& u : starts) wanted_.push_back(within_ranges(model, u));
  probe_.resize(static_cast<Eigen::Index>(free.size()));
  for (std::size_t a = 0; a < free.size(); ++a)
    probe_[static_cast<Eigen::Index>(a)] = model.parameters()[static_cast<std::size_t>(free[a])].probe;
  fit_.free = std::move(free);
  fit_.sensitivities = std::move(known);
}

double StepwiseFit::enough() const { return std::max(options_.tolerance * std::abs(fit_.value), options_.least_gain); }

void StepwiseFit::probe() {
  stage_ = Stage::probing;
  wanted_ = probe_points(model_, fit_.u, fit_.free);
}

void StepwiseFit::take(const std::vector<std::optional<Predictions>>& answers) {
  if (stage_ == Stage::starting) {
    fit_.value = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < answers.size(); ++i) {
      if (!answers[i]) continue;
      const double value = objective_.value(residuals(model_, *answers[i]), wanted_[i]);
      if (!fit_.predictions.empty() && !(value < fit_.value)) continue;
      fit_.u = wanted_[i];
      fit_.predictions = *answers[i];
      fit_.value = value;
    }
    if (fit_.predictions.empty())
      throw Error(ErrorCode::could_not_solve, "",
                  "The simulation fails at the parameters to start from: check the set-up.");
    if (fit_.sensitivities.empty())
      probe();
    else
      propose(false);
  } else if (stage_ == Stage::probing) {
    fit_.sensitivities = sensitivities_from(model_, fit_.u, fit_.predictions, fit_.free, wanted_, answers);
    fresh_ = true;
    propose(false);
  } else {
    step_taken(answers.front());
  }
}

void StepwiseFit::propose(bool short_one) {
  stage_ = short_one ? Stage::short_step : Stage::long_step;
  wanted_.clear();
  hoped_gain_ = 0;
  if (iterations_ >= options_.most_iterations) return;
  const auto k = static_cast<Eigen::Index>(fit_.free.size());
  Eigen::VectorXd g, low(k), high(k);
  Eigen::MatrixXd H;
  objective_.quadratic(residuals(model_, fit_.predictions), fit_.sensitivities, fit_.free, fit_.u, g, H);
  for (Eigen::Index a = 0; a < k; ++a) {
    const Eigen::Index p = fit_.free[static_cast<std::size_t>(a)];
    const ModelParameter& parameter = model_.parameters()[static_cast<std::size_t>(p)];
    low[a] = std::max(parameter.low_u() - fit_.u[p], -longest_step * probe_[a]);
    high[a] = std::min(parameter.high_u() - fit_.u[p], longest_step * probe_[a]);
  }
  Eigen::MatrixXd damped = H;
  const double scale = (probe_.asDiagonal() * H * probe_.asDiagonal()).diagonal().maxCoeff();
  for (Eigen::Index a = 0; a < k; ++a)
    damped(a, a) +=
        damping_ * (short_one ? shorter : 1) * std::max(H(a, a), 1e-3 * scale / (probe_[a] * probe_[a])) + 1e-12;
  const Eigen::VectorXd step = bounded_step(damped, g, low, high);
  hoped_gain_ = -(g.dot(step) + 0.5 * step.dot(H * step));
  if (!(hoped_gain_ > options_.hope * enough())) return;
  wanted_ = {fit_.u};
  for (Eigen::Index a = 0; a < k; ++a) wanted_.front()[fit_.free[static_cast<std::size_t>(a)]] += step[a];
}

void StepwiseFit::step_taken(const std::optional<Predictions>& answer) {
  const bool short_one = stage_ == Stage::short_step;
  const double value =
      answer ? objective_.value(residuals(model_, *answer), wanted_.front()) : std::numeric_limits<double>::infinity();
  if (answer)
    broyden_update(model_, fit_.sensitivities, fit_.free, fit_.predictions, *answer, wanted_.front() - fit_.u);
  if (value < fit_.value) {
    const double gain = fit_.value - value;
    small_gains_ = gain < enough() ? small_gains_ + 1 : 0;
    damping_ *= short_one ? shorter / 3 : gain > 0.5 * hoped_gain_ ? 0.3 : gain < 0.2 * hoped_gain_ ? 3 : 1;
    fit_.u = wanted_.front();
    fit_.predictions = *answer;
    fit_.value = value;
    fresh_ = false;
    ++iterations_;
    if (small_gains_ >= 2)
      stop();
    else
      propose(false);
  } else if (hoped_gain_ < enough()) {
    stop();  // there was little to gain
  } else if (!short_one) {
    propose(true);
  } else if (!fresh_ && renewals_ < options_.most_renewals) {
    ++renewals_;
    ++iterations_;
    probe();
  } else {
    ++iterations_;
    damping_ *= 100;
    if (damping_ > hopeless_damping || (!fresh_ && damping_ > 10))
      stop();
    else
      propose(false);
  }
}

void run_side_by_side(SimulationBag& bag, std::span<StepwiseFit> fits, double lowest, double reach, Context& context,
                      const std::string& stage) {
  constexpr double part = 0.25;  // of what is left of the bar goes to each round: nobody knows how many there will be
  double begun = 0;
  for (;;) {
    std::vector<Eigen::VectorXd> points;
    for (const StepwiseFit& fit : fits) points.insert(points.end(), fit.wanted().begin(), fit.wanted().end());
    if (points.empty()) return;
    const auto span = context.span(begun, begun + part * (1 - begun), stage);
    const auto answers = bag.run(points, context, stage);
    begun += part * (1 - begun);
    auto next = answers.begin();
    for (StepwiseFit& fit : fits) {
      const auto count = static_cast<std::ptrdiff_t>(fit.wanted().size());
      if (count > 0) fit.take({next, next + count});
      next += count;
      if (!fit.fit().predictions.empty()) lowest = std::min(lowest, fit.fit().value);
    }
    for (StepwiseFit& fit : fits)
      if (fit.iterations() >= sporting_steps && fit.fit().value - optimism * fit.hoped_gain() > lowest + reach)
        fit.stop();
  }
}

}  // namespace formwright
