// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/diagnosis/simulation_choice.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>

#include "base/error.h"
#include "evidence/calibration.h"
#include "evidence/fit/hypotheses.h"

namespace formwright {
namespace {

constexpr const char* stage = "Choosing the simulation";
constexpr FitOptions choosing_fit{7, 0.01, false};
constexpr double min_gain = 20;  // of log evidence: a finer mesh alone moves it by about as much

/// The nominal material, `before`'s, and such as differ from the nominal one in one parameter. What an extension brings
/// begins at its usual strength.
std::vector<Eigen::VectorXd> spread_starts(const ForwardModel& model, const ParameterFit* before) {
  constexpr double far_off = 2;  // prior standard deviations
  const std::vector<int> base = model.base_parameters();
  Eigen::VectorXd usual = model.nominal();
  const auto is_new = [&](int p) {
    return before != nullptr && std::find(before->free.begin(), before->free.end(), p) == before->free.end();
  };
  for (const int p : base)
    if (is_new(p)) usual[p] = model.parameters()[static_cast<std::size_t>(p)].prior_sd;
  std::vector<Eigen::VectorXd> starts{usual};
  if (before != nullptr) {
    starts.push_back(before->u);  // with nothing of what is new: no fit ends worse than without it
    starts.push_back(before->u);
    for (const int p : base)
      if (is_new(p)) starts.back()[p] = usual[p];
  }
  for (const int p : base)
    for (const double side : {-far_off, far_off}) {
      if (is_new(p)) continue;
      starts.push_back(usual);
      starts.back()[p] += side * model.parameters()[static_cast<std::size_t>(p)].prior_sd;
      starts.back() = within_ranges(model, starts.back());
    }
  return starts;
}

/// To calibrate it. `before`: without what the extension brings; null for the usual simulation.
FitProblem calibration(const ForwardModel& model, double softness, const ParameterFit* before) {
  return {mean_distance_objective(model, softness),
          model.base_parameters(),
          spread_starts(model, before),
          {},
          choosing_fit};
}

/// What the causes of the usual simulation do about it. An extension changes that little.
struct FreeCauses {
  std::vector<int> columns;
  std::vector<Sensitivities> sensitivities;
};

/// From a calibrated simulation on, every cause fitted as well: what is left then no cause makes.
FitProblem with_causes(const ForwardModel& model, double softness, const ParameterFit& calibrated,
                       const FreeCauses& causes) {
  return {mean_distance_objective(model, softness),
          joined(calibrated.free, causes.columns),
          {calibrated.u},
          side_by_side(calibrated.sensitivities, causes.sensitivities),
          quick_fit};
}

/// Fits in the models of `bags`, all together. Empty where there is no problem, or no answer.
std::vector<std::optional<ParameterFit>> fitted(const std::vector<std::unique_ptr<SimulationBag>>& bags,
                                                std::vector<std::optional<FitProblem>> problems, Context& context) {
  std::vector<SimulationBag*> own;
  std::vector<FitInProgress> fits;
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < bags.size(); ++i) {
    own.push_back(bags[i].get());
    if (!problems[i]) continue;
    fits.emplace_back(bags[i]->model(), std::move(*problems[i]));
    places.push_back(i);
  }
  run_fits(own, fits, context, stage);
  std::vector<std::optional<ParameterFit>> result(bags.size());
  for (std::size_t k = 0; k < fits.size(); ++k)
    if (fits[k].has_answer()) result[places[k]] = fits[k].fit();
  return result;
}

/// Marginal likelihood of the data, about a fit with every cause.
double log_evidence(const ForwardModel& model, const ParameterFit& fit, const MisfitOfAll& misfit) {
  Hypothesis all;
  for (int cause = 0; cause < static_cast<int>(model.causes().size()); ++cause) all.causes.push_back(cause);
  weigh(model, misfit.gram(residuals(model, fit.predictions), fit.sensitivities), fit.free, fit.u, all);
  return all.log_evidence;
}

SimulationChoice chosen(const ForwardModel& model, Context& context) {
  SimulationChoice choice;
  const std::size_t rounds = model.extensions().size();
  if (rounds == 0) return choice;
  const auto parts = static_cast<double>(3 + 2 * rounds);
  double done = 0;
  const auto part = [&](auto&& work) {
    const auto span = context.span(std::min(1.0, done / parts), std::min(1.0, (done + 1) / parts), stage);
    ++done;
    return work();
  };
  SimulationBag usual_bag(model);
  const auto at_nominal = usual_bag.run(model.nominal(), context, stage);
  if (!at_nominal) return choice;  // whoever calibrates it says so
  std::vector<NoiseEstimate> noise;
  const Predictions left = residuals(model, *at_nominal);
  for (std::size_t m = 0; m < left.size(); ++m) noise.push_back(estimate_noise(model.measurements()[m], left[m]));
  const double softness = largest_noise(model, noise);
  ParameterFit best =
      part([&] { return fit_parameters(usual_bag, calibration(model, softness, nullptr), context, stage); });
  FreeCauses causes;
  for (const Cause& cause : model.causes())
    for (const int p : cause.parameters) causes.columns.push_back(p);
  causes.sensitivities =
      part([&] { return sensitivities_at(usual_bag, best.u, best.predictions, causes.columns, context, stage); });
  const ParameterFit best_with_causes =
      part([&] { return fit_parameters(usual_bag, with_causes(model, softness, best, causes), context, stage); });
  // The same weights for all, without what passed for outliers only because a cause was at work.
  const Predictions free = residuals(model, best_with_causes.predictions);
  std::vector<Precisions> precisions;
  for (std::size_t m = 0; m < free.size(); ++m) {
    const Measurement& measurement = model.measurements()[m];
    precisions.push_back(isotropic(estimate_noise(measurement, free[m]).weights, measurement.measured.cols()));
  }
  const MisfitOfAll misfit(model, precisions);
  double best_evidence = log_evidence(model, best_with_causes, misfit);
  const ForwardModel* best_model = &model;
  choice.simulations = usual_bag.simulations();
  for (;;) {
    std::optional<ParameterFit> leader;
    double leading = -std::numeric_limits<double>::infinity();
    const ForwardModel* leading_model = nullptr;
    std::size_t leading_place = 0;
    const double error_before = mean_distance(*best_model, residuals(*best_model, best.predictions));
    const std::vector<SimulationExtension> extensions = best_model->extensions();
    std::vector<std::unique_ptr<SimulationBag>> bags;
    std::vector<std::optional<FitProblem>> problems;
    for (const SimulationExtension& extension : extensions) {
      bags.push_back(std::make_unique<SimulationBag>(*extension.model));
      problems.push_back(calibration(*extension.model, softness, &best));
    }
    const auto fits = part([&] { return fitted(bags, std::move(problems), context); });
    problems.assign(extensions.size(), std::nullopt);
    for (std::size_t i = 0; i < extensions.size(); ++i)
      if (fits[i]) problems[i] = with_causes(*extensions[i].model, softness, *fits[i], causes);
    const auto fits_with_causes = part([&] { return fitted(bags, std::move(problems), context); });
    for (std::size_t i = 0; i < extensions.size(); ++i) {
      choice.simulations += bags[i]->simulations();
      if (!fits_with_causes[i]) continue;
      const double evidence = log_evidence(*extensions[i].model, *fits_with_causes[i], misfit);
      if (evidence > leading) {
        leading = evidence;
        leading_model = extensions[i].model;
        leading_place = choice.tried.size();
        leader = fits[i];
      }
      choice.tried.push_back({extensions[i], evidence - best_evidence, error_before,
                              mean_distance(model, residuals(model, fits[i]->predictions)), false});
    }
    choice.u = best.u;
    if (!leader || leading < best_evidence + min_gain) return choice;
    choice.tried[leading_place].taken = true;
    best = std::move(*leader);
    best_evidence = leading;
    best_model = leading_model;
  }
}

}  // namespace

std::vector<std::string> SimulationChoice::taken() const {
  std::vector<std::string> names;
  for (const TriedExtension& t : tried)
    if (t.taken) names.push_back(t.extension.name);
  return names;
}

SimulationChoice choose_simulation(const ForwardModel& model, Context& context) {
  Stopwatch watch;
  try {
    SimulationChoice choice = chosen(model, context);
    choice.seconds = watch.seconds();
    return choice;
  } catch (const Error& error) {
    // Where a cause cannot be tried about the calibrated material, the usual simulation goes on from its own start.
    if (error.code() != ErrorCode::could_not_solve) throw;
    return {};
  }
}

}  // namespace formwright
