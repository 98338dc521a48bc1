// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/fit/parameter_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"

namespace formwright {
namespace {

constexpr double short_damping = 30;  // times that of the full step
constexpr double good_share = 0.25;   // of the promised gain: with less the shorter step is tried, too
constexpr double max_damping = 10;
constexpr double worth_a_step = 0.25;  // of the tolerance, that a step must promise

/// J += (y - J s) s^T / (s^T D s) with D = diag(1 / probe^2): Broyden's good update in units of the probes.
void broyden_update(std::vector<Sensitivities>& J, const Predictions& before, const Predictions& after,
                    const Eigen::VectorXd& s, const Eigen::VectorXd& probe) {
  const Eigen::VectorXd scaled = s.cwiseQuotient(probe.cwiseAbs2());
  const double length = s.dot(scaled);
  if (!(length > 1e-12)) return;
  for (std::size_t object = 0; object < J.size(); ++object) {
    Eigen::MatrixXd miss = after[object] - before[object];
    for (Eigen::Index a = 0; a < s.size(); ++a) miss -= s[a] * J[object][static_cast<std::size_t>(a)];
    for (Eigen::Index a = 0; a < s.size(); ++a) J[object][static_cast<std::size_t>(a)] += miss * (scaled[a] / length);
  }
}

}  // namespace

Eigen::VectorXd bounded_step(const Eigen::MatrixXd& H, const Eigen::VectorXd& g, const Eigen::VectorXd& low,
                             const Eigen::VectorXd& high) {
  const Eigen::Index k = g.size();
  Eigen::VectorXd s = Eigen::VectorXd::Zero(k).cwiseMax(low).cwiseMin(high);
  // Coordinate descent is exact in the limit, and a handful of parameters makes the limit near.
  for (int sweep = 0; sweep < 2000; ++sweep) {
    double moved = 0;
    for (Eigen::Index a = 0; a < k; ++a) {
      if (!(H(a, a) > 0)) continue;
      const double wanted = std::clamp(s[a] - (g[a] + H.row(a).dot(s)) / H(a, a), low[a], high[a]);
      moved = std::max(moved, std::abs(wanted - s[a]) * std::sqrt(H(a, a)));
      s[a] = wanted;
    }
    if (moved < 1e-9 * std::sqrt(std::max(1e-300, g.cwiseAbs().maxCoeff()))) break;
  }
  return s;
}

FitInProgress::FitInProgress(const ForwardModel& model, FitProblem problem)
    : model_(model), problem_(std::move(problem)), probe_(static_cast<Eigen::Index>(problem_.free.size())) {
  for (Eigen::Index a = 0; a < probe_.size(); ++a)
    probe_[a] = model.parameters()[static_cast<std::size_t>(problem_.free[static_cast<std::size_t>(a)])].probe;
  for (const Eigen::VectorXd& start : problem_.starts) wanted_.push_back(within_ranges(model, start));
}

double FitInProgress::share_done() const {
  if (wanted_.empty()) return 1;
  constexpr double begun = 0.05, prepared = 0.3;
  if (asked_ == Asked::starts) return 0;
  if (iteration_ == 0) return asked_ == Asked::sensitivities ? begun : prepared;
  return prepared + (1 - prepared) * iteration_ / (problem_.options.max_iterations + 1.0);
}

void FitInProgress::take(std::vector<std::optional<Predictions>> made) {
  switch (asked_) {
    case Asked::starts: begin(made); return;
    case Asked::sensitivities:
      probing_->take(std::move(made));
      wanted_ = probing_->wanted();
      if (!wanted_.empty()) return;
      try {
        fit_.sensitivities = probing_->result(fit_.predictions).sensitivities;
      } catch (const Error& error) {
        // At the edge of what can be simulated: with those of before it stays where it is.
        if (fit_.sensitivities.empty()) why_not_ = error;
        return;
      }
      probing_.reset();
      next_step();
      return;
    case Asked::full_step:
    case Asked::short_step:
      tried_.push_back(std::move(made.front()));
      decide();
      return;
  }
}

void FitInProgress::begin(const std::vector<std::optional<Predictions>>& made) {
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < made.size(); ++i) {
    if (!made[i]) continue;
    const double value = problem_.objective->value(residuals(model_, *made[i]), wanted_[i]);
    if (!(value < best)) continue;
    best = fit_.value = value;
    fit_.u = wanted_[i];
    fit_.predictions = *made[i];
  }
  wanted_.clear();
  if (fit_.u.size() == 0) {
    why_not_ = Error(ErrorCode::could_not_solve, "",
                     "The simulation fails at the parameters to start from: check the set-up.");
    return;
  }
  fit_.free = problem_.free;
  if (problem_.known.empty()) {
    renew();
    probings_ = 0;
    began_fresh_ = true;
  } else {
    fit_.sensitivities = std::move(problem_.known);
    next_step();
  }
}

void FitInProgress::renew() {
  ++probings_;
  probing_.emplace(model_, fit_.u, problem_.free);
  wanted_ = probing_->wanted();
  asked_ = Asked::sensitivities;
}

Eigen::VectorXd FitInProgress::place_after(const Eigen::VectorXd& step) const {
  Eigen::VectorXd u = fit_.u;
  for (Eigen::Index a = 0; a < step.size(); ++a) u[problem_.free[static_cast<std::size_t>(a)]] += step[a];
  return u;
}

std::vector<Eigen::VectorXd> FitInProgress::wanted_later() const {
  if (wanted_.empty() || asked_ != Asked::full_step) return {};
  return {place_after(steps_.back())};
}

void FitInProgress::next_step() {
  wanted_.clear();
  promised_gain_ = 0;
  const Eigen::Index k = probe_.size();
  if (k == 0 || iteration_++ >= problem_.options.max_iterations) return;
  Eigen::VectorXd g, low(k), high(k);
  Eigen::MatrixXd H;
  problem_.objective->quadratic(residuals(model_, fit_.predictions), fit_.sensitivities, problem_.free, fit_.u, g, H);
  for (Eigen::Index a = 0; a < k; ++a) {
    const Eigen::Index p = problem_.free[static_cast<std::size_t>(a)];
    const ModelParameter& parameter = model_.parameters()[static_cast<std::size_t>(p)];
    // Secants hold within a few probes.
    low[a] = std::max(parameter.low_u() - fit_.u[p], -4 * probe_[a]);
    high[a] = std::min(parameter.high_u() - fit_.u[p], 4 * probe_[a]);
  }
  const double scale = (probe_.asDiagonal() * H * probe_.asDiagonal()).diagonal().maxCoeff();
  steps_.clear();
  tried_.clear();
  for (const double factor : {1.0, short_damping}) {
    Eigen::MatrixXd damped = H;
    for (Eigen::Index a = 0; a < k; ++a)
      damped(a, a) += damping_ * factor * std::max(H(a, a), 1e-3 * scale / (probe_[a] * probe_[a])) + 1e-12;
    steps_.push_back(bounded_step(damped, g, low, high));
  }
  const Eigen::VectorXd& full = steps_.front();
  promised_gain_ = std::max(0.0, -(g.dot(full) + 0.5 * full.dot(H * full)));
  if (promised_gain_ < worth_a_step * problem_.options.tolerance * std::abs(fit_.value)) {
    converged();
    return;
  }
  asked_ = Asked::full_step;
  wanted_ = {place_after(full)};
}

void FitInProgress::converged() {
  wanted_.clear();
  if (may_renew() && !began_fresh_) renew();
}

void FitInProgress::decide() {
  std::optional<std::size_t> best;
  double best_value = fit_.value;
  for (std::size_t c = 0; c < tried_.size(); ++c) {
    if (!tried_[c]) continue;
    const double value = problem_.objective->value(residuals(model_, *tried_[c]), place_after(steps_[c]));
    if (value < best_value) best = c, best_value = value;
  }
  if (tried_.size() < steps_.size() && fit_.value - best_value < good_share * promised_gain_) {
    asked_ = Asked::short_step;
    wanted_ = {place_after(steps_[tried_.size()])};
    return;
  }
  // The step that is taken last: what it teaches is then the last word.
  for (std::size_t c = tried_.size(); c-- > 0;)
    if (tried_[c] && c != best) broyden_update(fit_.sensitivities, fit_.predictions, *tried_[c], steps_[c], probe_);
  if (best) {
    broyden_update(fit_.sensitivities, fit_.predictions, *tried_[*best], steps_[*best], probe_);
    const double gain = (fit_.value - best_value) / std::max(std::abs(fit_.value), 1e-12);
    fit_.u = place_after(steps_[*best]);
    fit_.predictions = std::move(*tried_[*best]);
    fit_.value = best_value;
    damping_ = *best == 0 ? damping_ * 0.3 : damping_ * 10;
    small_gains_ = gain < problem_.options.tolerance ? small_gains_ + 1 : 0;
    if (small_gains_ >= 2) converged();
    else next_step();
    return;
  }
  if (may_renew()) {
    renew();
    return;
  }
  damping_ *= 100;
  if (damping_ > max_damping) wanted_.clear();
  else next_step();
}

void run_fits(const std::vector<SimulationBag*>& bags, std::vector<FitInProgress>& fits, Context& context,
              const std::string& stage, const std::function<bool(const FitInProgress&)>& hopeless) {
  const auto bag_of = [&](const FitInProgress& fit) {
    return static_cast<std::size_t>(
        std::find_if(bags.begin(), bags.end(), [&](const SimulationBag* b) { return &b->model() == &fit.model(); }) -
        bags.begin());
  };
  const auto share = [&] {
    double sum = 0;
    for (const FitInProgress& fit : fits) sum += fit.share_done();
    return sum / static_cast<double>(fits.size());
  };
  for (;;) {
    std::vector<std::vector<Eigen::VectorXd>> points(bags.size()), later(bags.size());
    std::size_t waiting = 0;
    for (FitInProgress& fit : fits) {
      if (fit.iterations() > 0 && hopeless && hopeless(fit)) fit.stop();
      if (fit.wanted().empty()) continue;
      std::vector<Eigen::VectorXd>& own = points[bag_of(fit)];
      own.insert(own.end(), fit.wanted().begin(), fit.wanted().end());
      const std::vector<Eigen::VectorXd> next = fit.wanted_later();
      later[bag_of(fit)].insert(later[bag_of(fit)].end(), next.begin(), next.end());
      ++waiting;
    }
    if (waiting == 0) return;
    const double done = share(), step = 0.1 * static_cast<double>(waiting) / static_cast<double>(fits.size());
    const auto span = context.span(done, std::min(1.0, done + step), stage);
    const auto made = SimulationBag::run_together(bags, points, context, stage, later);
    std::vector<std::size_t> taken(bags.size(), 0);
    for (FitInProgress& fit : fits) {
      if (fit.wanted().empty()) continue;
      const std::size_t bag = bag_of(fit);
      const auto begin = made[bag].begin() + static_cast<std::ptrdiff_t>(taken[bag]);
      taken[bag] += fit.wanted().size();
      fit.take({begin, begin + static_cast<std::ptrdiff_t>(fit.wanted().size())});
    }
  }
}

ParameterFit fit_parameters(SimulationBag& bag, FitProblem problem, Context& context, const std::string& stage) {
  std::vector<FitInProgress> fits;
  fits.emplace_back(bag.model(), std::move(problem));
  run_fits({&bag}, fits, context, stage);
  if (!fits.front().has_answer()) throw *fits.front().why_not();
  return fits.front().fit();
}

Eigen::VectorXd towards(const ForwardModel& model, const std::vector<int>& free, const Eigen::VectorXd& from,
                        const Eigen::VectorXd& to) {
  Eigen::VectorXd u = from;
  for (const int p : free) {
    const double reach = 3 * model.parameters()[static_cast<std::size_t>(p)].probe;
    u[p] += std::clamp(to[p] - from[p], -reach, reach);
  }
  return u;
}

}  // namespace formwright
