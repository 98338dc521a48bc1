// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/fit/parameter_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"

namespace formwright {
namespace {

class MeanDistance : public FitObjective {
 public:
  MeanDistance(const ForwardModel& model, double soft) : model_(model), soft_(std::max(soft, 1e-9)) {
    for (const Measurement& measurement : model.measurements())
      count_ += static_cast<double>(measurement.measured.rows());
  }

  double value(const Predictions& residuals, const Eigen::VectorXd& u) const override {
    double sum = 0;
    for (const Eigen::MatrixXd& r : residuals)
      sum += ((r.rowwise().squaredNorm().array() + soft_ * soft_).sqrt() - soft_).sum();
    sum /= count_;
    for (Eigen::Index p = 0; p < u.size(); ++p) sum += 0.5 * pull(p) * u[p] * u[p];
    return sum;
  }

  void quadratic(const Predictions& residuals, const std::vector<Sensitivities>& sensitivities,
                 const std::vector<int>& free, const Eigen::VectorXd& u, Eigen::VectorXd& g,
                 Eigen::MatrixXd& H) const override {
    const auto k = static_cast<Eigen::Index>(free.size());
    g = Eigen::VectorXd::Zero(k);
    H = Eigen::MatrixXd::Zero(k, k);
    for (std::size_t object = 0; object < residuals.size(); ++object) {
      const Eigen::VectorXd w =
          (residuals[object].rowwise().squaredNorm().array() + soft_ * soft_).sqrt().inverse() / count_;
      for (Eigen::Index a = 0; a < k; ++a) {
        const Eigen::MatrixXd weighted = w.asDiagonal() * sensitivities[object][static_cast<std::size_t>(a)];
        g[a] -= weighted.cwiseProduct(residuals[object]).sum();
        for (Eigen::Index b = 0; b <= a; ++b)
          H(a, b) += weighted.cwiseProduct(sensitivities[object][static_cast<std::size_t>(b)]).sum();
      }
    }
    H.triangularView<Eigen::StrictlyUpper>() = H.transpose();
    for (Eigen::Index a = 0; a < k; ++a) {
      const double weight = pull(free[static_cast<std::size_t>(a)]);
      g[a] += weight * u[free[static_cast<std::size_t>(a)]];
      H(a, a) += weight;
    }
  }

 private:
  /// As many points as neighbours that know nothing of each other, about a hundred, would weigh against the prior:
  /// little against any data, yet enough to leave near its nominal value what they do not tell.
  double pull(Eigen::Index p) const {
    return 1e-2 * soft_ / std::pow(model_.parameters()[static_cast<std::size_t>(p)].prior_sd, 2);
  }

  const ForwardModel& model_;
  double soft_, count_ = 0;
};

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

std::unique_ptr<FitObjective> mean_distance_objective(const ForwardModel& model, double soft) {
  return std::make_unique<MeanDistance>(model, soft);
}

Predictions residuals(const ForwardModel& model, const Predictions& predictions) {
  Predictions result;
  for (std::size_t object = 0; object < predictions.size(); ++object)
    result.push_back(model.measurements()[object].measured - predictions[object]);
  return result;
}

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

Probing probe_around(SimulationBag& bag, const Eigen::VectorXd& u, const Predictions& at_u,
                     const std::vector<int>& free, Context& context, const std::string& stage) {
  const ForwardModel& model = bag.model();
  std::vector<Eigen::VectorXd> points;
  for (const int p : free)
    for (const double sign : {1.0, -1.0}) {
      Eigen::VectorXd moved = u;
      moved[p] += sign * model.parameters()[static_cast<std::size_t>(p)].probe;
      // Discrepancies are switches: there is no other side.
      const bool switched =
          model.parameters()[static_cast<std::size_t>(p)].role == ParameterRole::discrepancy && sign < 0;
      points.push_back(switched ? u : within_ranges(model, moved));
    }
  auto predictions = bag.run(points, context, stage);
  // Where there is no answer on either side a shorter step may have one.
  constexpr double shorter = 0.25;
  std::vector<std::size_t> again;
  std::vector<Eigen::VectorXd> nearer;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!predictions[i] && (!predictions[i ^ 1] || points[i ^ 1] == u)) {
      again.push_back(i);
      points[i] = u + shorter * (points[i] - u);
      nearer.push_back(points[i]);
    }
  if (!nearer.empty()) {
    auto found = bag.run(nearer, context, stage);
    for (std::size_t i = 0; i < again.size(); ++i) predictions[again[i]] = std::move(found[i]);
  }
  Probing result{std::vector<Sensitivities>(at_u.size()), std::vector<std::vector<Eigen::MatrixXd>>(at_u.size())};
  for (std::size_t i = 0; i < free.size(); ++i) {
    const Eigen::Index p = free[i];
    const bool plus = predictions[2 * i] && points[2 * i][p] != u[p],
               minus = predictions[2 * i + 1] && points[2 * i + 1][p] != u[p];
    if (!plus && !minus)
      throw Error(
          ErrorCode::could_not_solve, "",
          "The simulation fails on both sides of " + model.parameters()[static_cast<std::size_t>(p)].label + ".");
    const double upper = plus ? points[2 * i][p] : u[p], lower = minus ? points[2 * i + 1][p] : u[p];
    for (std::size_t object = 0; object < at_u.size(); ++object) {
      const Eigen::MatrixXd& above = plus ? (*predictions[2 * i])[object] : at_u[object];
      const Eigen::MatrixXd& below = minus ? (*predictions[2 * i + 1])[object] : at_u[object];
      result.sensitivities[object].push_back((above - below) / (upper - lower));
      if (plus && minus) result.bends[object].push_back(0.5 * (above + below) - at_u[object]);
    }
  }
  return result;
}

std::vector<Sensitivities> sensitivities_at(SimulationBag& bag, const Eigen::VectorXd& u, const Predictions& at_u,
                                            const std::vector<int>& free, Context& context, const std::string& stage) {
  return probe_around(bag, u, at_u, free, context, stage).sensitivities;
}

ParameterFit fit_parameters(SimulationBag& bag, const FitObjective& objective, const std::vector<int>& free,
                            const Eigen::VectorXd& start, std::vector<Sensitivities> known, const FitOptions& options,
                            Context& context, const std::string& stage) {
  const ForwardModel& model = bag.model();
  ParameterFit fit;
  fit.free = free;
  fit.u = within_ranges(model, start);
  constexpr double prepared = 0.3;  // of the work: simulations about the start
  const auto first = [&] {
    const auto span = context.span(0, 0.05, stage);
    return bag.run(fit.u, context, stage);
  }();
  if (!first)
    throw Error(ErrorCode::could_not_solve, "",
                "The simulation fails at the parameters to start from: check the set-up.");
  fit.predictions = *first;
  fit.value = objective.value(residuals(model, fit.predictions), fit.u);
  bool fresh = known.empty();
  {
    const auto span = context.span(0.05, prepared, stage);
    fit.sensitivities = fresh ? sensitivities_at(bag, fit.u, fit.predictions, free, context, stage) : std::move(known);
  }

  const auto k = static_cast<Eigen::Index>(free.size());
  Eigen::VectorXd probe(k);
  for (Eigen::Index a = 0; a < k; ++a)
    probe[a] = model.parameters()[static_cast<std::size_t>(free[static_cast<std::size_t>(a)])].probe;
  double damping = 0.03;
  int small_gains = 0;
  for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
    const auto until = [&](int done) { return prepared + (1 - prepared) * done / options.max_iterations; };
    const auto span = context.span(until(iteration), until(iteration + 1), stage);
    Eigen::VectorXd g, low(k), high(k);
    Eigen::MatrixXd H;
    objective.quadratic(residuals(model, fit.predictions), fit.sensitivities, free, fit.u, g, H);
    for (Eigen::Index a = 0; a < k; ++a) {
      const Eigen::Index p = free[static_cast<std::size_t>(a)];
      const ModelParameter& parameter = model.parameters()[static_cast<std::size_t>(p)];
      // Secants hold within a few probes.
      low[a] = std::max(parameter.low_u() - fit.u[p], -4 * probe[a]);
      high[a] = std::min(parameter.high_u() - fit.u[p], 4 * probe[a]);
    }
    // Two lengths of step at a time, one for each of two cores.
    std::vector<Eigen::VectorXd> points;
    std::vector<Eigen::VectorXd> steps;
    for (const double factor : {1.0, 30.0}) {
      Eigen::MatrixXd damped = H;
      const double scale = (probe.asDiagonal() * H * probe.asDiagonal()).diagonal().maxCoeff();
      for (Eigen::Index a = 0; a < k; ++a)
        damped(a, a) += damping * factor * std::max(H(a, a), 1e-3 * scale / (probe[a] * probe[a])) + 1e-12;
      steps.push_back(bounded_step(damped, g, low, high));
      points.push_back(fit.u);
      for (Eigen::Index a = 0; a < k; ++a) points.back()[free[static_cast<std::size_t>(a)]] += steps.back()[a];
    }
    const auto tried = [&] {
      const auto half = context.span(0, 0.5, stage);
      return bag.run(points, context, stage);
    }();
    int best = -1;
    double best_value = fit.value;
    for (int c = 0; c < 2; ++c) {
      if (!tried[static_cast<std::size_t>(c)]) continue;
      const double value =
          objective.value(residuals(model, *tried[static_cast<std::size_t>(c)]), points[static_cast<std::size_t>(c)]);
      if (value < best_value) best = c, best_value = value;
    }
    // The shorter step first: what the longer one teaches is then the last word where both were seen.
    for (const int c : {1, 0})
      if (tried[static_cast<std::size_t>(c)] && c != best)
        broyden_update(fit.sensitivities, fit.predictions, *tried[static_cast<std::size_t>(c)],
                       steps[static_cast<std::size_t>(c)], probe);
    if (best >= 0) {
      const auto b = static_cast<std::size_t>(best);
      broyden_update(fit.sensitivities, fit.predictions, *tried[b], steps[b], probe);
      const double gain = (fit.value - best_value) / std::max(std::abs(fit.value), 1e-12);
      fit.u = points[b];
      fit.predictions = *tried[b];
      fit.value = best_value;
      damping = best == 0 ? damping * 0.3 : damping * 10;
      fresh = false;
      small_gains = gain < options.tolerance ? small_gains + 1 : 0;
      if (small_gains >= 2) break;
    } else if (!fresh && options.renew_sensitivities) {
      const auto half = context.span(0.5, 1, stage);
      fit.sensitivities = sensitivities_at(bag, fit.u, fit.predictions, free, context, stage);
      fresh = true;
    } else {
      damping *= 100;
      if (damping > 1e4 || (!fresh && damping > 10)) break;
    }
  }
  return fit;
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

ParameterFit fit_from_best(SimulationBag& bag, const FitObjective& objective, const std::vector<int>& free,
                           const std::vector<Eigen::VectorXd>& starts, std::vector<Sensitivities> known,
                           const FitOptions& options, Context& context, const std::string& stage) {
  const auto predictions = bag.run(starts, context, stage);
  std::size_t best = 0;
  double best_value = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < starts.size(); ++i) {
    const std::optional<Predictions>& there = predictions[i];
    if (!there) continue;
    const double value = objective.value(residuals(bag.model(), *there), starts[i]);
    if (value < best_value) best = i, best_value = value;
  }
  return fit_parameters(bag, objective, free, starts[best], std::move(known), options, context, stage);
}

std::vector<Sensitivities> sensitivities_of(const std::vector<int>& wanted, const std::vector<Sensitivities>& all,
                                            const std::vector<int>& columns) {
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

std::vector<int> joined(std::vector<int> a, const std::vector<int>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

}  // namespace formwright
