// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/calibration.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "evidence/fit/hypotheses.h"

namespace formwright {
namespace {

constexpr double half_log_likelihood = 1.92;  // of chi-square with one degree of freedom, 95 %
constexpr double identified_share =
    0.5;  // of the searched range that an identified parameter's interval may take at most

std::vector<Eigen::VectorXd> take_noise(const ForwardModel& model, const Predictions& left,
                                        std::vector<NoiseEstimate>& noise) {
  std::vector<Eigen::VectorXd> weights;
  noise.clear();
  for (std::size_t object = 0; object < left.size(); ++object) {
    noise.push_back(estimate_noise(model.measurements()[object], left[object]));
    weights.push_back(noise.back().weights);
  }
  return weights;
}

/// The size of structure under which what is left is most probable, but no less than the model's own: contact alone
/// makes simulations chatter by more than the mean of many points could tell.
std::size_t likeliest_structure(const ForwardModel& model, const MisfitOfAll& misfit, const Predictions& left) {
  const GramByStructure gram = misfit.gram(left, std::vector<Sensitivities>(left.size()));
  std::size_t best = 0;
  while (misfit.sizes()[best] < model.known_misfit()) ++best;
  for (std::size_t t = best + 1; t < gram.gram.size(); ++t)
    if (gram.gram[t](0, 0) + gram.log_determinant[t] < gram.gram[best](0, 0) + gram.log_determinant[best]) best = t;
  return best;
}

/// Where the interval ends on one side, between the profile's points.
double crossing(const std::vector<ProfilePoint>& points, std::size_t best, int side) {
  std::size_t inside = best;
  for (std::size_t i = best; side > 0 ? i + 1 < points.size() : i > 0;) {
    i = side > 0 ? i + 1 : i - 1;
    if (points[i].log_likelihood < -half_log_likelihood) {
      // Log likelihoods fall with the square of the distance, so their roots are linear.
      const double a = std::sqrt(-points[inside].log_likelihood), b = std::sqrt(-points[i].log_likelihood);
      const double t = b > a ? (std::sqrt(half_log_likelihood) - a) / (b - a) : 1;
      return points[inside].value + std::clamp(t, 0.0, 1.0) * (points[i].value - points[inside].value);
    }
    inside = i;
  }
  return points[inside].value;
}

/// Fixes each base parameter at values around the best, lets the others follow as the quadratic model has it,
/// simulates, and compares.
std::vector<ParameterProfile> profile(SimulationBag& bag, const ParameterFit& fit, const FitObjective& objective,
                                      Context& context) {
  const ForwardModel& model = bag.model();
  static constexpr double offsets[] = {-6, -3, -1.5, -0.7, 0.7, 1.5, 3, 6};  // in probes
  const auto k = static_cast<Eigen::Index>(fit.free.size());
  Eigen::VectorXd g;
  Eigen::MatrixXd H;
  objective.quadratic(residuals(model, fit.predictions), fit.sensitivities, fit.free, fit.u, g, H);
  std::vector<Eigen::VectorXd> points;
  std::vector<Eigen::Index> owner;
  for (Eigen::Index a = 0; a < k; ++a)
    for (const double offset : offsets) {
      Eigen::VectorXd low(k), high(k);
      for (Eigen::Index b = 0; b < k; ++b) {
        const Eigen::Index p = fit.free[static_cast<std::size_t>(b)];
        const ModelParameter& parameter = model.parameters()[static_cast<std::size_t>(p)];
        low[b] = std::max(parameter.low_u() - fit.u[p], -4 * parameter.probe);
        high[b] = std::min(parameter.high_u() - fit.u[p], 4 * parameter.probe);
        if (b == a)
          low[b] = high[b] =
              std::clamp(offset * parameter.probe, parameter.low_u() - fit.u[p], parameter.high_u() - fit.u[p]);
      }
      if (low[a] == 0) continue;  // at the end of the range
      // The fit's own unrest is not the profile's.
      const Eigen::VectorXd step = bounded_step(H, Eigen::VectorXd::Zero(k), low, high);
      Eigen::VectorXd u = fit.u;
      for (Eigen::Index b = 0; b < k; ++b) u[fit.free[static_cast<std::size_t>(b)]] += step[b];
      points.push_back(within_ranges(model, u));
      owner.push_back(a);
    }
  const auto predictions = bag.run(points, context, "Finding how certain each parameter is");
  std::vector<ParameterProfile> profiles;
  for (Eigen::Index a = 0; a < k; ++a) {
    const Eigen::Index p = fit.free[static_cast<std::size_t>(a)];
    const ModelParameter& parameter = model.parameters()[static_cast<std::size_t>(p)];
    ParameterProfile own;
    own.parameter = static_cast<int>(p);
    own.points.push_back({parameter.value(fit.u[p]), -objective.value(residuals(model, fit.predictions), fit.u)});
    for (std::size_t i = 0; i < points.size(); ++i)
      if (owner[i] == a && predictions[i])
        own.points.push_back(
            {parameter.value(points[i][p]), -objective.value(residuals(model, *predictions[i]), points[i])});
    std::stable_sort(own.points.begin(), own.points.end(),
                     [](const ProfilePoint& x, const ProfilePoint& y) { return x.value < y.value; });
    const auto best = std::max_element(
        own.points.begin(), own.points.end(),
        [](const ProfilePoint& x, const ProfilePoint& y) { return x.log_likelihood < y.log_likelihood; });
    const double highest = best->log_likelihood;
    const auto at = static_cast<std::size_t>(best - own.points.begin());
    for (ProfilePoint& point : own.points) point.log_likelihood -= highest;
    own.best = parameter.value(fit.u[p]);
    // Least distances and greatest likelihood need not meet in one point: the interval has both.
    own.low = std::min(own.best, crossing(own.points, at, -1));
    own.high = std::max(own.best, crossing(own.points, at, 1));
    const double reach = parameter.logarithmic ? std::log(own.points.back().value / own.points.front().value)
                                               : own.points.back().value - own.points.front().value;
    const double width = parameter.logarithmic ? std::log(own.high / own.low) : own.high - own.low;
    own.identified = width < identified_share * reach;
    profiles.push_back(std::move(own));
  }
  return profiles;
}

/// Predictions at the nominal point; sets the error before and the noise.
Predictions at_nominal(SimulationBag& bag, Calibration& result, Context& context) {
  const ForwardModel& model = bag.model();
  auto nominal = [&] {
    const auto span = context.span(0, 0.05, "Simulating the set-up as it is");
    return bag.run(model.nominal(), context, "Simulating the set-up as it is");
  }();
  if (!nominal)
    throw Error(ErrorCode::could_not_solve, "",
                "The simulation fails with the set-up's own parameters: check mould and set-up.");
  const Predictions left = residuals(model, *nominal);
  result.error_nominal = mean_distance(model, left);
  take_noise(model, left, result.noise);
  return std::move(*nominal);
}

/// Fits from the nominal values or from `start`, and fills in all but the intervals.
ParameterFit fitted(SimulationBag& bag, const Eigen::VectorXd& start, Calibration& result, Context& context) {
  const ForwardModel& model = bag.model();
  at_nominal(bag, result, context);
  const auto span = context.span(0.05, 1, "Fitting");
  std::vector<Eigen::VectorXd> starts{model.nominal()};
  if (start.size() > 0) starts.push_back(start);
  ParameterFit fit = fit_parameters(
      bag, {mean_distance_objective(model, largest_noise(model, result.noise)), model.base_parameters(), starts},
      context, "Fitting");
  result.u = fit.u;
  result.predictions = fit.predictions;
  result.objective = fit.value;
  result.error = mean_distance(model, residuals(model, fit.predictions));
  return fit;
}

}  // namespace

double mean_distance(const ForwardModel& model, const Predictions& left) {
  double sum = 0, count = 0;
  for (std::size_t m = 0; m < left.size(); ++m) {
    if (!model.measurements()[m].is_place()) continue;
    sum += left[m].rowwise().norm().sum();
    count += static_cast<double>(left[m].rows());
  }
  return count > 0 ? sum / count : 0;
}

Calibration calibrate_quickly(SimulationBag& bag, Context& context, const Eigen::VectorXd& start) {
  Stopwatch watch;
  Calibration result;
  fitted(bag, start, result, context);
  result.simulations = bag.simulations();
  result.seconds = watch.seconds();
  return result;
}

Calibration calibrate(SimulationBag& bag, Context& context, const Eigen::VectorXd& start) {
  Stopwatch watch;
  const ForwardModel& model = bag.model();
  Calibration result;
  const ParameterFit fit = [&] {
    const auto span = context.span(0, 0.6, "Fitting");
    return fitted(bag, start, result, context);
  }();
  {
    const auto span = context.span(0.6, 1, "Finding how certain each parameter is");
    // What another, equally good simulation would do differently is not known any better than that.
    const std::vector<int> discrepancies = model.parameters_with(ParameterRole::discrepancy);
    const std::vector<Sensitivities> freedom = [&] {
      const auto begin = context.span(0, 0.3, "Finding how certain each parameter is");
      return sensitivities_at(bag, fit.u, fit.predictions, discrepancies, context,
                              "Finding how certain each parameter is");
    }();
    const std::vector<Eigen::VectorXd> weights = take_noise(model, residuals(model, fit.predictions), result.noise);
    // Directions alike: what little the simulation errs across walls, the material would be made to answer for.
    std::vector<Precisions> precisions = precisions_of(model, weights, movements_of(model, discrepancies, freedom));
    for (std::size_t object = 0; object < precisions.size(); ++object)
      precisions[object] = isotropic(mean_weights(precisions[object]), model.measurements()[object].measured.cols());
    const MisfitOfAll misfit(model, precisions);
    const StructuredObjective objective(model, misfit,
                                        likeliest_structure(model, misfit, residuals(model, fit.predictions)),
                                        NuisanceParameters{discrepancies, freedom});
    result.profiles = profile(bag, fit, objective, context);
  }
  result.simulations = bag.simulations();
  result.seconds = watch.seconds();
  return result;
}

Calibration grid_search(SimulationBag& bag, const std::vector<GridAxis>& axes, int per_side,
                        const std::vector<int>& place_parameters, double reach, Context& context) {
  Stopwatch watch;
  const ForwardModel& model = bag.model();
  Calibration result;
  const Predictions nominal = at_nominal(bag, result, context);
  const std::vector<Sensitivities> moved =
      sensitivities_at(bag, model.nominal(), nominal, place_parameters, context, "Moving the mould");

  std::vector<Eigen::VectorXd> points{model.nominal()};
  for (const GridAxis& axis : axes) {
    std::vector<Eigen::VectorXd> next;
    for (const Eigen::VectorXd& u : points)
      for (int i = 0; i < per_side; ++i) {
        next.push_back(u);
        const double value = axis.low + (axis.high - axis.low) * i / std::max(1, per_side - 1);
        next.back()[axis.parameter] = model.parameters()[static_cast<std::size_t>(axis.parameter)].coordinate(value);
      }
    points = std::move(next);
  }
  result.error = std::numeric_limits<double>::infinity();
  // In batches, so that memory stays small and what is best so far is known early.
  constexpr std::size_t batch = 25;
  constexpr int steps = 4;  // of the translation, to each side
  for (std::size_t first = 0; first < points.size(); first += batch) {
    const std::size_t last = std::min(first + batch, points.size());
    const auto span =
        context.span(static_cast<double>(first) / static_cast<double>(points.size()),
                     static_cast<double>(last) / static_cast<double>(points.size()), "Searching the grid");
    const std::vector<Eigen::VectorXd> part(points.begin() + static_cast<std::ptrdiff_t>(first),
                                            points.begin() + static_cast<std::ptrdiff_t>(last));
    const auto predictions = bag.run(part, context, "Searching the grid");
    bag.forget();
    for (std::size_t i = 0; i < part.size(); ++i) {
      if (!predictions[i]) continue;
      const Predictions left = residuals(model, *predictions[i]);
      Eigen::VectorXd shift = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(place_parameters.size()));
      const auto try_shift = [&] {
        Predictions shifted = left;
        for (std::size_t object = 0; object < left.size(); ++object)
          for (Eigen::Index a = 0; a < shift.size(); ++a)
            shifted[object] -= shift[a] * moved[object][static_cast<std::size_t>(a)];
        const double error = mean_distance(model, shifted);
        if (error >= result.error) return;
        result.error = error;
        result.u = part[i];
        for (Eigen::Index a = 0; a < shift.size(); ++a)
          result.u[place_parameters[static_cast<std::size_t>(a)]] = shift[a];
        result.predictions = *predictions[i];
        for (std::size_t object = 0; object < left.size(); ++object)
          result.predictions[object] = model.measurements()[object].measured - shifted[object];
      };
      if (place_parameters.empty()) {
        try_shift();
        continue;
      }
      const bool two = place_parameters.size() > 1;
      for (int x = -steps; x <= steps; ++x)
        for (int y = two ? -steps : 0; y <= (two ? steps : 0); ++y) {
          shift[0] = reach * x / steps;
          if (two) shift[1] = reach * y / steps;
          try_shift();
        }
    }
  }
  if (!std::isfinite(result.error))
    throw Error(ErrorCode::could_not_solve, "", "The simulation fails everywhere on the grid: check mould and set-up.");
  result.simulations = bag.simulations();
  result.seconds = watch.seconds();
  return result;
}

}  // namespace formwright
