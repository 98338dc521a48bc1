// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/diagnosis/simulation_choice.h"

#include <algorithm>
#include <memory>
#include <optional>

#include "base/error.h"
#include "evidence/calibration.h"
#include "evidence/fit/hypotheses.h"
#include "evidence/fit/usual_strengths.h"

namespace formwright {
namespace {

constexpr const char* stage = "Choosing the simulation";
constexpr FitOptions choosing_fit{7, 0.01, false};
constexpr FitOptions far_fit{15, 0.005, true};  // an extension must not win by going on from where this one stops
constexpr double min_gain = 20;                 // of log evidence: a finer mesh alone moves it by about as much
constexpr double min_promise = 0;               // of log evidence, of one look: a fit gains more
constexpr int usual_rounds = 2;                 // how often one is added at most, for the progress

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

/// The same where one look from `before` has promised a gain: from there on.
FitProblem promised_calibration(const ForwardModel& model, double softness, const ParameterFit& before) {
  return {mean_distance_objective(model, softness), model.base_parameters(), {before.u}, {}, choosing_fit};
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

/// Of each measurement: weights of its points, without what passes for outliers.
std::vector<Eigen::VectorXd> weights_about(const ForwardModel& model, const Predictions& predictions) {
  const Predictions left = residuals(model, predictions);
  std::vector<Eigen::VectorXd> weights;
  for (std::size_t m = 0; m < left.size(); ++m)
    weights.push_back(estimate_noise(model.measurements()[m], left[m]).weights);
  return weights;
}

/// A simulation, calibrated without causes and with all of them.
struct Calibrated {
  const ForwardModel* model = nullptr;
  ParameterFit alone, with_causes;
  std::vector<Eigen::VectorXd> weights;  // about the fit with all causes
};

/// By how much `other` raises the marginal likelihood. Both with the same weights: what passes for an outlier in one of
/// them only because that one is wrong there counts in both.
double log_evidence_gain(const Calibrated& before, const ForwardModel& other, const ParameterFit& other_with_causes) {
  const std::vector<Eigen::VectorXd>& own = before.weights;
  const std::vector<Eigen::VectorXd> others = weights_about(other, other_with_causes.predictions);
  std::vector<Precisions> precisions;
  for (std::size_t m = 0; m < own.size(); ++m)
    precisions.push_back(
        isotropic((own[m].array() > 0).select(own[m], others[m]), before.model->measurements()[m].measured.cols()));
  const MisfitOfAll misfit(*before.model, precisions);
  return log_evidence(other, other_with_causes, misfit) - log_evidence(*before.model, before.with_causes, misfit);
}

double mean_error(const ForwardModel& model, const ParameterFit& fit) {
  return mean_distance(model, residuals(model, fit.predictions));
}

/// `extension` where `before` is calibrated with all causes; what it brings to fit is at its usual strength. Empty
/// where it has no answer.
std::optional<TriedExtension> one_look(const Calibrated& before, const SimulationExtension& extension, int& simulations,
                                       Context& context) {
  SimulationBag bag(*extension.model);
  Eigen::VectorXd at = before.with_causes.u;
  for (const int p : extension.model->base_parameters())
    if (std::find(before.alone.free.begin(), before.alone.free.end(), p) == before.alone.free.end())
      at[p] = extension.model->parameters()[static_cast<std::size_t>(p)].prior_sd;
  auto there = bag.run(at, context, stage);
  simulations += bag.simulations();
  if (!there) return std::nullopt;
  ParameterFit moved = before.with_causes;
  moved.u = at;
  moved.predictions = std::move(*there);
  TriedExtension tried{extension};
  tried.log_evidence_gain = log_evidence_gain(before, *extension.model, moved);
  tried.error_before_mm = mean_error(*before.model, before.with_causes);
  tried.error_after_mm = mean_error(*extension.model, moved);
  return tried;
}

class Choosing {
 public:
  Choosing(const ForwardModel& model, Context& context)
      : model_(model), context_(context), rounds_(static_cast<int>(model.extensions().size())) {}

  SimulationChoice run();

 private:
  template <class Work>
  auto part(Work&& work) {
    const auto parts = static_cast<double>(3 + 2 * std::min(rounds_, usual_rounds));
    const auto span = context_.span(std::min(1.0, done_ / parts), std::min(1.0, (done_ + 1) / parts), stage);
    ++done_;
    return work();
  }

  bool calibrate_usual() {
    SimulationBag bag(model_);
    const auto at_nominal = bag.run(model_.nominal(), context_, stage);
    if (!at_nominal) return false;
    std::vector<NoiseEstimate> noise;
    const Predictions left = residuals(model_, *at_nominal);
    for (std::size_t m = 0; m < left.size(); ++m) noise.push_back(estimate_noise(model_.measurements()[m], left[m]));
    softness_ = largest_noise(model_, noise);
    best_.model = &model_;
    best_.alone = part([&] { return fit_parameters(bag, calibration(model_, softness_, nullptr), context_, stage); });
    for (const Cause& cause : model_.causes())
      for (const int p : cause.parameters) causes_.columns.push_back(p);
    causes_.sensitivities = part([&] {
      return sensitivities_at(bag, best_.alone.u, best_.alone.predictions, causes_.columns, context_, stage);
    });
    best_.with_causes = part(
        [&] { return fit_parameters(bag, with_causes(model_, softness_, best_.alone, causes_), context_, stage); });
    if (const auto strong = strong_cause_instead_of(best_.alone.value, bag, *mean_distance_objective(model_, softness_),
                                                    context_, stage))
      begin_at(*strong, bag);
    best_.weights = weights_about(model_, best_.with_causes.predictions);
    choice_.simulations = bag.simulations();
    return true;
  }

  /// With all causes, from where `strong` alone leads; kept where it is nearer.
  void begin_at(const StrongCause& strong, SimulationBag& bag) {
    try {
      FitProblem with_all = with_causes(model_, softness_, best_.alone, causes_);
      const ParameterFit led = fit_parameters(
          bag, {with_all.objective, model_.base_and({strong.cause}), {strong.u}, {}, far_fit}, context_, stage);
      with_all.starts = {led.u};
      with_all.known = sensitivities_of(with_all.free, side_by_side(led.sensitivities, with_all.known),
                                        joined(led.free, with_all.free));
      ParameterFit fit = fit_parameters(bag, std::move(with_all), context_, stage);
      if (fit.value >= best_.with_causes.value) return;
      best_.with_causes = std::move(fit);
      strong_cause_ = true;
    } catch (const Error& error) {
      if (error.code() != ErrorCode::could_not_solve) throw;
    }
  }

  /// With all causes, from where the extension is calibrated or, where a strong cause was found without it and that is
  /// nearer, from there.
  FitProblem extended_with_causes(SimulationBag& bag, const ParameterFit& alone) {
    const ForwardModel& model = bag.model();
    FitProblem problem = with_causes(model, softness_, alone, causes_);
    if (!strong_cause_) return problem;
    std::vector<Eigen::VectorXd> starts(2, best_.with_causes.u);
    for (const int p : model.base_parameters())
      if (is_new(p)) starts[1][p] = model.parameters()[static_cast<std::size_t>(p)].prior_sd;
    const auto made = bag.run(starts, context_, stage);
    double lowest = alone.value;
    for (std::size_t i = 0; i < starts.size(); ++i) {
      if (!made[i]) continue;
      const double value = problem.objective->value(residuals(model, *made[i]), starts[i]);
      if (!(value < lowest)) continue;
      lowest = value;
      problem.starts = {starts[i]};
      problem.known = sensitivities_of(problem.free, side_by_side(best_.with_causes.sensitivities, alone.sensitivities),
                                       joined(best_.with_causes.free, alone.free));
    }
    return problem;
  }

  bool is_new(int base_parameter) const {
    const std::vector<int>& before = best_.alone.free;
    return std::find(before.begin(), before.end(), base_parameter) == before.end();
  }

  /// Not where all it has to fit came out as nothing: that is the simulation without it, after more steps.
  bool brings_something(const ForwardModel& extended, const ParameterFit& fit) const {
    const std::vector<int> base = extended.base_parameters();
    const auto nothing = [&](int p) { return !is_new(p) || fit.u[p] == 0; };
    return std::none_of(base.begin(), base.end(), [&](int p) { return is_new(p); }) ||
           !std::all_of(base.begin(), base.end(), nothing);
  }

  /// A fit has shown that it gains little, whatever one look promises.
  bool broken_promise(const SimulationExtension& extension) const {
    return extension.trial == ExtensionTrial::fit_if_one_look_promises &&
           std::any_of(choice_.tried.begin(), choice_.tried.end(), [&](const TriedExtension& t) {
             return t.fitted && t.log_evidence_gain < min_gain && t.extension.name == extension.name;
           });
  }

  /// Those worth a fit; the others are noted as tried.
  std::vector<SimulationExtension> promising() {
    std::vector<SimulationExtension> list;
    for (const SimulationExtension& extension : best_.model->extensions()) {
      if (extension.trial == ExtensionTrial::one_look || broken_promise(extension)) continue;
      if (extension.trial == ExtensionTrial::fit_if_one_look_promises) {
        auto tried = one_look(best_, extension, choice_.simulations, context_);
        if (!tried) continue;
        if (tried->log_evidence_gain <= min_promise) {
          choice_.tried.push_back(std::move(*tried));
          continue;
        }
      }
      list.push_back(extension);
    }
    return list;
  }

  /// Takes the extension that raises the marginal likelihood most. False where none raises it clearly.
  bool extend() {
    const std::vector<SimulationExtension> extensions = promising();
    std::vector<std::unique_ptr<SimulationBag>> bags;
    std::vector<std::optional<FitProblem>> problems;
    for (const SimulationExtension& extension : extensions) {
      bags.push_back(std::make_unique<SimulationBag>(*extension.model));
      problems.push_back(extension.trial == ExtensionTrial::fit
                             ? calibration(*extension.model, softness_, &best_.alone)
                             : promised_calibration(*extension.model, softness_, best_.alone));
    }
    auto fits = part([&] { return fitted(bags, std::move(problems), context_); });
    problems.assign(extensions.size(), std::nullopt);
    for (std::size_t i = 0; i < extensions.size(); ++i)
      if (fits[i]) problems[i] = extended_with_causes(*bags[i], *fits[i]);
    auto fits_with_causes = part([&] { return fitted(bags, std::move(problems), context_); });
    const double error_before = mean_error(*best_.model, best_.alone);
    std::optional<std::size_t> leader;
    std::size_t leading_place = 0;
    double leading = min_gain;
    for (std::size_t i = 0; i < extensions.size(); ++i) {
      choice_.simulations += bags[i]->simulations();
      if (!fits_with_causes[i]) continue;
      const double gain = log_evidence_gain(best_, *extensions[i].model, *fits_with_causes[i]);
      if (gain >= leading && brings_something(*extensions[i].model, *fits_with_causes[i])) {
        leading = gain;
        leader = i;
        leading_place = choice_.tried.size();
      }
      choice_.tried.push_back({extensions[i], true, gain, error_before, mean_error(*extensions[i].model, *fits[i])});
    }
    if (!leader) return false;
    choice_.tried[leading_place].taken = true;
    const ForwardModel& taken = *extensions[*leader].model;
    best_ = {&taken, std::move(*fits[*leader]), std::move(*fits_with_causes[*leader]), {}};
    best_.weights = weights_about(taken, best_.with_causes.predictions);
    return true;
  }

  void advise() {
    for (const SimulationExtension& extension : best_.model->extensions()) {
      if (extension.trial != ExtensionTrial::one_look) continue;
      auto tried = one_look(best_, extension, choice_.simulations, context_);
      if (!tried) continue;
      tried->advised = tried->log_evidence_gain >= min_gain && tried->error_after_mm < tried->error_before_mm;
      choice_.tried.push_back(std::move(*tried));
    }
  }

  const ForwardModel& model_;
  Context& context_;
  int rounds_ = 0;
  double done_ = 0, softness_ = 0;
  Calibrated best_;
  FreeCauses causes_;
  bool strong_cause_ = false;  // best_.with_causes is far from best_.alone
  SimulationChoice choice_;
};

SimulationChoice Choosing::run() {
  if (rounds_ == 0 || !calibrate_usual()) return std::move(choice_);  // whoever calibrates it says so
  while (extend()) continue;
  choice_.u = best_.alone.u;
  part([&] { advise(); });
  return std::move(choice_);
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
    SimulationChoice choice = Choosing(model, context).run();
    choice.seconds = watch.seconds();
    return choice;
  } catch (const Error& error) {
    // Where a cause cannot be tried about the calibrated material, the usual simulation goes on from its own start.
    if (error.code() != ErrorCode::could_not_solve) throw;
    return {};
  }
}

}  // namespace formwright
