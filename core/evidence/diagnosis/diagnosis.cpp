// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/diagnosis/diagnosis.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "base/error.h"
#include "evidence/diagnosis/cause_findings.h"
#include "evidence/diagnosis/strength_interval.h"
#include "evidence/explanations/explanations.h"
#include "evidence/explanations/wide_secants.h"

namespace formwright {
namespace {

constexpr double likely = 0.5;
constexpr double max_left =
    2;  // of the noise: with more left on held-out blocks a named cause is not all of it, or a relative of what it is
constexpr double plain_strength = 2.5;            // half widths of its interval
constexpr double distinguishable_strength = 1.5;  // the same: with some fifteen causes tried, 5 % for all of them
                                                  // is 2.9 standard deviations of one, not 1.96
constexpr std::size_t max_failed = 3;             // checks, of answers that fail: more tries find more by chance
constexpr double min_gain = 0.01;                 // of the held-out error
constexpr double sure_gain = 0.8;                 // probability that there is one
constexpr double certain_gain = 0.99;             // the same, where a field of unknown origin does as well
constexpr double inseparable_likeness = 0.9;
constexpr const char* stays_unexplained = "Part of the misfit stays unexplained.";
constexpr const char* nearly_as_likely = "Another explanation is nearly as likely.";
constexpr const char* other_material = "The material would have to be far from what was measured before.";
constexpr const char* simulations_disagree = "Equally good simulations find strengths that are far apart.";
constexpr double max_interval = 2;    // times the strength, that its interval may reach
constexpr double surprising = 3;      // prior standard deviations
constexpr double max_refinement = 2;  // a factor of the fitted strength
constexpr double max_worse = 1.25;    // the same of the held-out error

class Diagnostician {
 public:
  /// `tried` was fitted with `bag`.
  Diagnostician(SimulationBag& bag, Explanations& tried, Context& context)
      : bag_(bag), model_(bag.model()), context_(context), tried_(tried) {}

  Diagnosis run() {
    result_.base = tried_.base();
    result_.noise = tried_.noise();
    result_.hypotheses = tried_.hypotheses();
    judge();
    const auto span = context_.span(0.98, 1, measuring_strengths);
    widen_by_other_simulations(result_, tried_, bag_, context_);
    doubt_wide_intervals();
    for (CauseFinding& finding : result_.causes) keep_in_range(model_, finding);
    return std::move(result_);
  }

 private:
  /// Without the effects that are usually there: many points drag them as far as any cause.
  HeldOut held_out(const ParameterFit& fit) {
    return hold_out(bag_, fit, tried_.precisions(), tried_.nearest_size(model_.known_misfit()), tried_.discrepancies(),
                    context_);
  }

  std::vector<Eigen::VectorXd> weights() const {
    std::vector<Eigen::VectorXd> list;
    for (const Precisions& precisions : tried_.precisions()) list.push_back(mean_weights(precisions));
    return list;
  }

  std::vector<Eigen::VectorXd> predicted(const ParameterFit& fit, const std::vector<int>& causes) const {
    return predictive_errors(model_, fit, tried_.precisions(), tried_.nearest_size(tried_.structure_left(causes)),
                             tried_.discrepancies());
  }

  void judge() {
    const auto span = context_.span(0.9, 0.98, "Predicting the held-out data");
    result_.causes = cause_findings(tried_, result_.base);
    result_.noise_floor = noise_floor(model_, result_.noise, tried_.precisions());
    before_ = held_out(result_.base).errors;
    result_.unexplained_before = tried_.structure_left({});
    result_.extended = result_.base;
    find_answer();
    refine_strengths();
    widen_by_model();
    measure_gain();
    if (result_.verdict.empty()) {
      result_.reading = result_.answers.front().unknown_cause ? Reading::unknown : Reading::none;
      return;
    }
    std::stable_sort(result_.verdict.begin(), result_.verdict.end(), [&](int a, int b) {
      return tried_.movement(a, result_.extended.u) > tried_.movement(b, result_.extended.u);
    });
    result_.reading = Reading::cause;
    find_doubts();
    const bool explains_too_little = result_.doubtful() && share_explained() < explained_share;
    std::vector<int> causes = result_.verdict;
    std::sort(causes.begin(), causes.end());
    if (explains_too_little && result_.unexplained_before <= model_.max_misfit_left()) {
      // Others fit worse, and explain less.
      result_.verdict.clear();
      result_.doubts.clear();
      result_.extended = result_.base;
      fail({causes, {}, Failure::nothing_to_explain});
      if (!result_.answers.front().causes.empty()) fail_all_others();
      check_material();
      measure_gain();
      result_.reading = result_.answers.front().unknown_cause ? Reading::unknown : Reading::none;
      return;
    }
    if (explains_too_little) result_.reading = Reading::unknown;
    find_twins();
    doubt_measurement();
    if (explains_too_little) fail({causes, {}, Failure::explains_too_little});
  }

  /// What is left with the verdict.
  void measure_gain() {
    const std::vector<Eigen::VectorXd>& after = result_.verdict.empty() ? before_ : checked_.errors;
    result_.held_out = compare_distances(model_, before_, after);
    result_.held_out_others.clear();
    for (std::size_t m = 0; m < before_.size(); ++m)
      if (!model_.measurements()[m].is_place())
        result_.held_out_others.push_back(compare_errors_of(model_, m, before_, after));
    result_.unexplained_after = tried_.structure_left(result_.verdict);
    result_.structure = tried_.nearest_size(result_.unexplained_after);
    measure_structure();
  }

  /// That nothing is wrong is no answer where it needs another material.
  void check_material() {
    if (!result_.answers.front().unknown_cause && is_other_material(tried_.refit_of({}).fit.u))
      fail({{}, {}, Failure::other_material});
  }

  /// Checks the most probable answer, until the most probable one has passed or is a cause that is not in the list. The
  /// check of an answer with causes is the same for all, and against the same fit without any.
  void find_answer() {
    weigh_answers();
    const std::vector<Eigen::VectorXd> without = predicted(tried_.refit_of({}).fit, {});
    std::size_t failed_causes = 0;
    for (;;) {
      const Answer top = result_.answers.front();
      if (top.causes.empty()) {
        check_material();
        return;
      }
      if (failed_causes++ >= max_failed) {
        fail_all_others();
        continue;
      }
      if (const std::optional<FailedCheck> failed = check(top.causes, without)) {
        fail(*failed);
        continue;
      }
      result_.verdict = top.causes;
      if (top.unknown_cause) doubt(stays_unexplained);
      if (field_does_as_well_) doubt("A field of unknown origin would predict points that were left out as well.");
      return;
    }
  }

  /// Each of `causes` moves points by more than the simulation's own error, together they predict better than none or
  /// explain most of what is held out, and each is distinguishable from zero. Empty where all hold.
  std::optional<FailedCheck> check(const std::vector<int>& causes, const std::vector<Eigen::VectorXd>& without) {
    if (!tried_.is_refitted(causes)) return FailedCheck{causes, {}, Failure::behind_failed};
    const std::vector<int> large = tried_.causes_that_move(causes, tried_.refit_of(causes).fit.u);
    result_.trials.push_back({causes, large.size() == causes.size(), {}});
    if (large.size() < causes.size()) return FailedCheck{causes, large, Failure::too_small};
    field_does_as_well_ = !predicts_better(causes, without);
    const ParameterFit& fit = tried_.refit_of(causes).fit;
    result_.extended = recalibrated(fit, {fit.u});
    checked_ = held_out(result_.extended);
    // A field of unknown origin may guess a left-out block from its neighbours as well as the cause has it. A cause
    // that explains that block without a field is still one.
    if (field_does_as_well_ && !explains_held_out(compare_distances(model_, before_, checked_.errors))) {
      result_.extended = result_.base;
      return FailedCheck{causes, {}, Failure::predicts_no_better};
    }
    for (const int cause : causes) widen_by_jackknife(model_, result_.extended, checked_.steps, finding_of(cause));
    const std::vector<int> shown = distinguishable_from_zero(causes);
    if (shown.size() == causes.size()) return {};
    result_.extended = result_.base;
    const bool imitated = causes.size() == 1 && !std::isfinite(finding_of(causes.front()).min_visible_strength);
    return FailedCheck{causes, shown, imitated ? Failure::like_the_material : Failure::near_zero};
  }

  /// What is named is as strong as one step on wide secants has it (wide_secants.h), unless that is far from the fit,
  /// or predicts held-out data much worse: then the movement is no straight line up to there.
  void refine_strengths() {
    const std::vector<int>& causes = result_.verdict;
    if (causes.empty()) return;
    const ParameterFit& fit = tried_.refit_of(causes).fit;
    const auto u = step_on_wide_secants(bag_, tried_, causes, {}, context_);
    const auto is_far = [&](int cause) {
      return std::abs(std::log(strength_factor(model_, cause, fit.u, *u))) > std::log(max_refinement);
    };
    if (!u || std::any_of(causes.begin(), causes.end(), is_far)) return;
    Eigen::VectorXd causes_alone = *u;
    for (const int p : model_.base_parameters()) causes_alone[p] = fit.u[p];
    // Where a calibration leaps from the better start it may not from the other.
    if (!extend_from(fit, {*u, causes_alone}) && !extend_from(fit, {*u}) && !extend_from(fit, {causes_alone})) return;
    for (const int cause : causes) {
      CauseFinding& finding = finding_of(cause);
      const double half = half_width(finding);
      set_values(model_, result_.extended.u, finding);
      set_half_width(finding, half);
    }
  }

  /// False, and changes nothing, where the model has no answer, or held-out points are predicted much worse than by the
  /// extended model so far.
  bool extend_from(const ParameterFit& fit, std::vector<Eigen::VectorXd> starts) {
    try {
      ParameterFit extended = recalibrated(fit, std::move(starts));
      HeldOut checked = held_out(extended);
      const HeldOutGain gain = compare_distances(model_, checked_.errors, checked.errors);
      if (gain.after.mean > max_worse * gain.before.mean) return false;
      result_.extended = std::move(extended);
      checked_ = std::move(checked);
      return true;
    } catch (const Error& error) {
      if (error.code() != ErrorCode::could_not_solve) throw;
      return false;
    }
  }

  void weigh_answers() {
    result_.answers = answers_of(result_.hypotheses, result_.failed);
    for (CauseFinding& finding : result_.causes)
      finding.probability = probability_of_cause(result_.answers, finding.cause);
    std::stable_sort(result_.causes.begin(), result_.causes.end(),
                     [](const CauseFinding& a, const CauseFinding& b) { return a.probability > b.probability; });
  }

  void fail(FailedCheck failed) {
    for (const Hypothesis& h : result_.hypotheses)
      if (h.causes == failed.causes) failed.fit_probability += h.probability;
    result_.failed.push_back(std::move(failed));
    weigh_answers();
  }

  void fail_all_others() {
    std::set<std::vector<int>> others;
    for (const Hypothesis& h : result_.hypotheses)
      if (!h.causes.empty()) others.insert(h.causes);
    for (const FailedCheck& failed : result_.failed) others.erase(failed.causes);
    for (const std::vector<int>& causes : others) fail({causes, {}, Failure::behind_failed});
  }

  /// Held-out blocks, with these causes and `without` any; kept in the last trial.
  bool predicts_better(const std::vector<int>& causes, const std::vector<Eigen::VectorXd>& without) {
    const ParameterFit& fit = tried_.refit_of(causes).fit;
    const HeldOutGain gain = compare_weighed_errors(model_, without, predicted(fit, causes), weights());
    result_.trials.back().gain = gain;
    return gain.gain_probability >= sure_gain && gain.gain_share >= min_gain;
  }

  /// Those distinguishable from zero, and one that stands alone only if these data can show it at all: on data of
  /// a machine without fault the others are named as well, a weak vacuum for a sheet that is a little stiffer than
  /// thought. Beside another cause the pair has to explain what that one and the material do not.
  std::vector<int> distinguishable_from_zero(const std::vector<int>& causes) const {
    std::vector<int> shown;
    for (const int cause : causes) {
      const CauseFinding& finding = finding_of(cause);
      const bool can_be_shown = causes.size() > 1 || std::isfinite(finding.min_visible_strength);
      if (can_be_shown && change(model_, finding) > distinguishable_strength * half_width_with_model(model_, finding))
        shown.push_back(cause);
    }
    return shown;
  }

  void doubt(const char* why) {
    if (std::find(result_.doubts.begin(), result_.doubts.end(), why) == result_.doubts.end())
      result_.doubts.emplace_back(why);
  }

  /// Relatives of what is wrong leave something, or do so little that the fit's own error could be it.
  void find_doubts() {
    if (result_.unexplained_after > model_.max_misfit_left()) doubt(stays_unexplained);
    if (result_.held_out.after.mean > max_left * result_.noise_floor)
      doubt("On held-out data, the error is still more than twice the noise.");
    if (is_other_material(result_.extended.u)) doubt(other_material);
    for (const int cause : result_.verdict) {
      const CauseFinding& finding = finding_of(cause);
      if (finding.probability < likely) doubt(nearly_as_likely);
      if (change(model_, finding) < plain_strength * half_width(finding))
        doubt("Its strength is hardly distinguishable from zero.");
    }
  }

  /// What equally good simulations find several times as strong, or not at all, may be something else as well.
  void doubt_wide_intervals() {
    for (const int cause : result_.verdict) {
      const CauseFinding& finding = finding_of(cause);
      const double far = finding.strength < 0 ? -finding.low : finding.high;
      if (far > max_interval * std::abs(finding.strength)) doubt(simulations_disagree);
    }
  }

  /// Far from one that was measured before, and what is beyond moves points by more than the simulation's own error:
  /// some parameters stand in for each other, and run far without doing anything.
  bool is_other_material(const Eigen::VectorXd& u) const {
    const std::vector<int> base = model_.base_parameters();
    Eigen::VectorXd beyond = Eigen::VectorXd::Zero(u.size());
    for (const int p : base) {
      const ModelParameter& parameter = model_.parameters()[static_cast<std::size_t>(p)];
      if (parameter.was_measured)
        beyond[p] = std::copysign(std::max(0.0, std::abs(u[p]) - surprising * parameter.prior_sd), u[p]);
    }
    return tried_.movement_by(base, beyond) > min_movement * model_.known_misfit();
  }

  /// Of what was unexplained (its variance): by the structure that is left, where there was more than the simulation
  /// has by itself, or by the error on held-out blocks above the noise.
  double share_explained() const {
    const double held_out = explained_on_held_out(result_.held_out);
    if (result_.unexplained_before <= model_.max_misfit_left()) return held_out;
    const double left = result_.unexplained_after / result_.unexplained_before;
    return std::max(1 - left * left, held_out);
  }

  bool explains_held_out(const HeldOutGain& gain) const {
    return gain.gain_probability >= certain_gain && explained_on_held_out(gain) >= explained_share;
  }

  double explained_on_held_out(const HeldOutGain& gain) const {
    const double noise_squared = result_.noise_floor * result_.noise_floor;
    const double before = std::pow(gain.before.mean, 2) - noise_squared,
                 after = std::pow(gain.after.mean, 2) - noise_squared;
    return before > 0 ? 1 - std::max(0.0, after) / before : 0;
  }

  /// What was named stays as `starts` have it; the base parameters are calibrated about it as those of the base model
  /// were, from the best of these.
  ParameterFit recalibrated(const ParameterFit& fit, std::vector<Eigen::VectorXd> starts) {
    const std::vector<int> base = model_.base_parameters();
    ParameterFit result = fit_parameters(bag_,
                                         {mean_distance_objective(model_, tried_.softness()), base, std::move(starts),
                                          sensitivities_of(base, fit.sensitivities, fit.free), quick_fit},
                                         context_, fitting_stage);
    for (std::size_t a = result.free.size(); a < fit.free.size(); ++a) {
      result.free.push_back(fit.free[a]);
      for (std::size_t object = 0; object < result.sensitivities.size(); ++object)
        result.sensitivities[object].push_back(fit.sensitivities[object][a]);
    }
    return result;
  }

  void widen_by_model() {
    for (CauseFinding& finding : result_.causes)
      if (finding.fitted) set_half_width(finding, half_width_with_model(model_, finding));
  }

  static auto& finding_in(auto& causes, int cause) {
    return *std::find_if(causes.begin(), causes.end(), [&](const CauseFinding& f) { return f.cause == cause; });
  }
  const CauseFinding& finding_of(int cause) const { return finding_in(result_.causes, cause); }
  CauseFinding& finding_of(int cause) { return finding_in(result_.causes, cause); }

  /// Causes that do the same as a named one as far as these data go. Where something stays unexplained, or another mesh
  /// could turn the balance, probabilities do not separate such causes: what the simulation gets wrong decides between
  /// them.
  void find_twins() {
    const bool in_doubt = result_.doubtful();
    const GramByStructure gram =
        tried_.misfit().gram(residuals(model_, result_.base.predictions), tried_.sensitivities());
    for (const int named : result_.verdict)
      for (int other = 0; other < static_cast<int>(model_.causes().size()); ++other) {
        if (std::find(result_.verdict.begin(), result_.verdict.end(), other) != result_.verdict.end()) continue;
        const double alike = similarity(model_, gram, result_.structure, tried_.columns(), named, other);
        // Equal in every respect, or not distinguished by these data.
        const bool undecided = finding_of(other).probability > 0.15 * finding_of(named).probability;
        if (alike > inseparable_likeness || (undecided && alike > 0.5))
          result_.not_separable.push_back({named, other, alike});
        const bool meshes_decide =
            finding_of(named).log_evidence - finding_of(other).log_evidence < model_.mesh_error();
        if ((in_doubt || meshes_decide) && alike > inseparable_likeness && result_.reading == Reading::cause)
          result_.reading = Reading::cannot_separate;
        if (!undecided) continue;
        if (alike > 0.5 && result_.reading == Reading::cause) result_.reading = Reading::cannot_separate;
        else if (alike <= 0.5) doubt(nearly_as_likely);
      }
  }

  /// Any scanner out of order may do nearly the same, though no cause of the list that does is as likely.
  void doubt_measurement() {
    if (result_.verdict.size() != 1) return;
    const auto named = static_cast<std::size_t>(result_.verdict.front());
    if (model_.causes()[named].fault_of == FaultOf::measurement) return;  // then it is one
    const auto distorted = distorted_measurement(model_, tried_.misfit(), tried_.linear_models(), result_.structure);
    if (!distorted || distorted->similarity[named] <= inseparable_likeness) return;
    double log_evidence = -std::numeric_limits<double>::infinity();
    for (const Hypothesis& h : result_.hypotheses)
      if (h.causes == result_.verdict) log_evidence = std::max(log_evidence, h.log_evidence);
    if (log_evidence - distorted->log_evidence < model_.mesh_error())
      doubt("A scan that is stretched, skewed or turned in some other way would look nearly the same.");
  }

  void measure_structure() {
    result_.structure_before.clear();
    result_.structure_after.clear();
    const Predictions left = residuals(model_, result_.base.predictions),
                      left_after = residuals(model_, result_.extended.predictions);
    for (std::size_t object = 0; object < tried_.precisions().size(); ++object) {
      const Eigen::VectorXd weights = mean_weights(tried_.precisions()[object]);
      result_.structure_before.push_back(test_structure(model_.measurements()[object], left[object], weights));
      result_.structure_after.push_back(test_structure(model_.measurements()[object], left_after[object], weights));
    }
  }

  SimulationBag& bag_;
  const ForwardModel& model_;
  Context& context_;
  Explanations& tried_;
  Diagnosis result_;
  HeldOut checked_;                      // of result_.extended
  bool field_does_as_well_ = false;      // at what was checked last
  std::vector<Eigen::VectorXd> before_;  // errors on held-out blocks without causes
};

}  // namespace

const char* reading_name(Reading reading) {
  switch (reading) {
    case Reading::none: return "none";
    case Reading::cause: return "cause";
    case Reading::cannot_separate: return "cannot_separate";
    case Reading::unknown: return "unknown";
  }
  return "";
}

Diagnosis diagnose(SimulationBag& bag, const DiagnosisOptions& options, Context& context) {
  Stopwatch watch;
  Explanations tried(bag, options.pairs, context);
  tried.calibrate(options.start);
  const double seconds_calibration = watch.seconds();
  tried.screen();
  tried.refit();
  const ForwardModel* const finer = bag.model().finer();
  Diagnosis result;
  int simulations = 0;
  if (finer != nullptr) {
    SimulationBag fine_bag(*finer);
    Explanations again(fine_bag, options.pairs, context);
    try {
      again.look_again(tried);
      // A finer sheet that fits worse has not found what a coarser one has: where steep walls make it leap, its fits
      // end early.
      if (again.error() <= tried.error()) {
        result = Diagnostician(fine_bag, again, context).run();
        result.looked_again = true;
      }
    } catch (const Error& error) {
      if (error.code() != ErrorCode::could_not_solve) throw;
      // Where it has no answer the coarser one's stands, with its doubts.
    }
    simulations = fine_bag.simulations();
  }
  if (!result.looked_again) result = Diagnostician(bag, tried, context).run();
  result.simulations = simulations + bag.simulations() + tried.cheap_simulations();
  result.seconds_calibration = seconds_calibration;
  result.seconds = watch.seconds();
  return result;
}

}  // namespace formwright
