// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/diagnosis.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "base/error.h"

namespace formwright {
namespace {

constexpr std::size_t refitted_singles = 8, leader_count = 4;
constexpr int refitted_pairs = 6, quick_iterations = 5, polishing_iterations = 8;
constexpr const char* fitting = "Fitting the causes";
constexpr double explained_share = 0.6;   // of the base model's structure (its variance) that a named cause must explain
constexpr double likely = 0.5;
constexpr double out_of_reach = 60;        // log evidence that polishing does not make up for
constexpr double least_gain = 0.01;        // of the held-out error
constexpr double sure_gain = 0.8;          // probability that there is one
constexpr double least_movement = 0.5;     // of the known misfit
constexpr double inseparable_likeness = 0.9;

std::vector<int> joined(std::vector<int> a, const std::vector<int>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

std::vector<int> parameters_of(const ForwardModel& model, const std::vector<int>& causes) {
  std::vector<int> list = model.base_parameters();
  for (const int cause : causes) list = joined(std::move(list), model.causes()[static_cast<std::size_t>(cause)].parameters);
  return list;
}

/// Columns of `all` (in the order of `columns`) that belong to `wanted`.
std::vector<Sensitivities> chosen(const std::vector<Sensitivities>& all, const std::vector<int>& columns, const std::vector<int>& wanted) {
  std::vector<Sensitivities> result(all.size());
  for (const int p : wanted) {
    const auto at = static_cast<std::size_t>(std::find(columns.begin(), columns.end(), p) - columns.begin());
    for (std::size_t object = 0; object < all.size(); ++object) result[object].push_back(all[object][at]);
  }
  return result;
}

std::vector<Sensitivities> side_by_side(std::vector<Sensitivities> a, const std::vector<Sensitivities>& b) {
  for (std::size_t object = 0; object < a.size(); ++object) a[object].insert(a[object].end(), b[object].begin(), b[object].end());
  return a;
}

class Diagnostician {
 public:
  Diagnostician(SimulationBag& bag, const DiagnosisOptions& options, Context& context) : bag_(bag), model_(bag.model()), options_(options), context_(context) {}

  Diagnosis run() {
    Stopwatch watch;
    calibrate();
    result_.seconds_calibration = watch.seconds();
    screen();
    refit();
    judge();
    result_.simulations = bag_.simulations();
    result_.seconds = watch.seconds();
    return std::move(result_);
  }

 private:
  struct Refit {
    ParameterFit fit;
    std::vector<int> causes;
  };

  void estimate_noise_about(const Predictions& predictions) {
    weights_.clear();
    result_.noise.clear();
    const Predictions left = residuals(model_, predictions);
    for (std::size_t object = 0; object < left.size(); ++object) {
      result_.noise.push_back(estimate_noise(model_.measurements()[object], left[object]));
      weights_.push_back(result_.noise.back().weights);
    }
  }

  void calibrate() {
    const auto span = context_.span(0, 0.2, "Calibrating");
    const auto at_nominal = bag_.run(model_.nominal(), context_, "Calibrating");
    if (!at_nominal) throw Error(ErrorCode::could_not_solve, "", "The simulation fails with the set-up's own parameters: check mould and set-up.");
    estimate_noise_about(*at_nominal);
    result_.base = fit_parameters(bag_, *mean_distance_objective(model_, softness()), model_.base_parameters(), model_.nominal(), {}, {}, context_, "Calibrating");
    estimate_noise_about(result_.base.predictions);
    misfit_.emplace(model_, weights_);
  }

  /// Sensitivities to everything about the calibrated model, and what they alone say.
  void screen() {
    const auto span = context_.span(0.2, 0.4, "Trying each effect");
    columns_.clear();
    for (std::size_t p = 0; p < model_.parameters().size(); ++p) columns_.push_back(static_cast<int>(p));
    sensitivities_ = sensitivities_at(bag_, result_.base.u, result_.base.predictions, columns_, context_, "Trying each effect");
    result_.liberties = model_.parameters_with(ParameterRole::discrepancy);
    result_.liberty_sensitivities = chosen(sensitivities_, columns_, result_.liberties);
    weights_ = weights_with_liberties(model_, std::move(weights_), result_.liberties, result_.liberty_sensitivities);
    misfit_.emplace(model_, weights_);
    const GramByStructure gram = misfit_->gram(residuals(model_, result_.base.predictions), sensitivities_);
    screened_ = all_hypotheses(model_, options_.pairs);
    for (Hypothesis& h : screened_) weigh(model_, gram, columns_, result_.base.u, h);
    normalise(screened_);
  }

  const Hypothesis& screened(const std::vector<int>& causes, bool unknown) const {
    return *std::find_if(screened_.begin(), screened_.end(), [&](const Hypothesis& h) { return h.causes == causes && h.unknown_structure == unknown; });
  }

  std::size_t nearest_size(double structure) const {
    const std::vector<double>& sizes = misfit_->sizes();
    std::size_t best = 1;
    for (std::size_t t = 1; t < sizes.size(); ++t)
      if (std::abs(sizes[t] - structure) < std::abs(sizes[best] - structure)) best = t;
    return best;
  }

  /// Fits base parameters and those of `causes` together, from the best of `starts`. No more structure is allowed than the right causes
  /// would leave: with as much as there is, what the causes should explain would cost nothing unexplained.
  ParameterFit fit_from(const std::vector<int>& causes, const std::vector<Eigen::VectorXd>& starts, std::vector<Sensitivities> known, int iterations) {
    const std::vector<int> free = parameters_of(model_, causes);
    const StructuredObjective objective(model_, *misfit_, nearest_size(model_.known_misfit()), result_.liberties, result_.liberty_sensitivities);
    const auto predictions = bag_.run(starts, context_, fitting);
    std::size_t best = 0;
    double best_value = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < starts.size(); ++i) {
      if (!predictions[i]) continue;
      const double value = objective.value(residuals(model_, *predictions[i]), starts[i]);
      if (value < best_value) best = i, best_value = value;
    }
    FitOptions options;
    options.most_iterations = iterations;
    options.tolerance = 0.01;
    options.renew_sensitivities = iterations > quick_iterations;
    return fit_parameters(bag_, objective, free, starts[best], std::move(known), options, context_, fitting);
  }

  /// From where the linearised model has them, with the sensitivities it was made of.
  void refit_with(const std::vector<int>& causes) {
    const Hypothesis& plain = screened(causes, false);
    const Hypothesis& rough = screened(causes, true);
    const Hypothesis& start = plain.probability >= rough.probability ? plain : rough;
    const std::vector<int> free = parameters_of(model_, causes);
    // Secants hold within a few probes: a longer way is gone in steps.
    Eigen::VectorXd u = result_.base.u;
    for (const int p : free) {
      const double reach = 3 * model_.parameters()[static_cast<std::size_t>(p)].probe;
      u[p] += std::clamp(start.u[p] - u[p], -reach, reach);
    }
    std::vector<Eigen::VectorXd> starts{result_.base.u, u};
    for (const auto& r : refits_)  // a pair may start from what its parts are like alone
      if (causes.size() == 2 && r.causes.size() == 1 && (r.causes[0] == causes[0] || r.causes[0] == causes[1])) starts.push_back(r.fit.u);
    refits_.push_back({fit_from(causes, starts, chosen(sensitivities_, columns_, free), quick_iterations), causes});
    if (const Eigen::VectorXd far = far_start(causes); far.size() > 0) {
      // The calibrated base may have swallowed an effect that only goes one way: nothing near it points back.
      ParameterFit other = fit_from(causes, {far}, {}, quick_iterations);
      if (other.value < refits_.back().fit.value) refits_.back().fit = std::move(other);
    }
    weigh_refit(refits_.back());
  }

  /// The nominal model with a one-sided cause at its usual strength; empty for other causes, and where the model has no answer there.
  Eigen::VectorXd far_start(const std::vector<int>& causes) {
    if (causes.size() != 1) return {};
    Eigen::VectorXd u = 0.5 * result_.base.u;
    bool one_sided = false;
    for (const int p : model_.causes()[static_cast<std::size_t>(causes.front())].parameters) {
      const ModelParameter& parameter = model_.parameters()[static_cast<std::size_t>(p)];
      u[p] = parameter.prior_sd;
      one_sided |= parameter.one_sided();
    }
    u = within_ranges(model_, u);
    return one_sided && bag_.run(u, context_, fitting) ? u : Eigen::VectorXd();
  }

  /// Once more, with sensitivities taken where the fit stands; what was learnt with more causes counts for fewer.
  void polish(Refit& refit) {
    std::vector<Eigen::VectorXd> starts{refit.fit.u};
    for (const Refit& larger : refits_) {
      if (larger.causes.size() <= refit.causes.size() || !std::includes(larger.causes.begin(), larger.causes.end(), refit.causes.begin(), refit.causes.end())) continue;
      Eigen::VectorXd u = larger.fit.u;
      for (std::size_t p = 0; p < model_.parameters().size(); ++p)
        if (std::find(refit.fit.free.begin(), refit.fit.free.end(), static_cast<int>(p)) == refit.fit.free.end()) u[static_cast<Eigen::Index>(p)] = 0;
      starts.push_back(u);
    }
    refit.fit = fit_from(refit.causes, starts, {}, polishing_iterations);
    weigh_refit(refit);
  }

  /// The marginal likelihood of an explanation where its fit has it.
  void weigh_refit(const Refit& refit) {
    const std::vector<int> columns = joined(refit.fit.free, result_.liberties);
    const GramByStructure gram = misfit_->gram(residuals(model_, refit.fit.predictions), side_by_side(refit.fit.sensitivities, result_.liberty_sensitivities));
    for (const bool unknown : {false, true}) {
      auto at = std::find_if(result_.hypotheses.begin(), result_.hypotheses.end(), [&](const Hypothesis& h) { return h.causes == refit.causes && h.unknown_structure == unknown; });
      if (at == result_.hypotheses.end()) at = result_.hypotheses.insert(at, screened(refit.causes, unknown));
      weigh(model_, gram, columns, refit.fit.u, *at);
      at->u = refit.fit.u;
    }
  }

  /// What passed for outliers about the calibrated model may have been misfit that an explanation accounts for: once more about the best.
  void renew_noise() {
    estimate_noise_about(refit_of(result_.hypotheses.front().causes).fit.predictions);
    weights_ = weights_with_liberties(model_, std::move(weights_), result_.liberties, result_.liberty_sensitivities);
    misfit_.emplace(model_, weights_);
    const GramByStructure gram = misfit_->gram(residuals(model_, result_.base.predictions), sensitivities_);
    for (Hypothesis& h : screened_) weigh(model_, gram, columns_, result_.base.u, h);
    normalise(screened_);
    for (const Refit& refit : refits_) weigh_refit(refit);
    normalise(result_.hypotheses);
  }

  void refit() {
    const auto span = context_.span(0.4, 0.85, fitting);
    std::vector<std::vector<int>> singles{{}};
    for (const Hypothesis& h : screened_)
      if (h.causes.size() == 1 && std::find(singles.begin(), singles.end(), h.causes) == singles.end() && singles.size() <= refitted_singles) singles.push_back(h.causes);
    const double parts = static_cast<double>(singles.size()) + (options_.pairs ? refitted_pairs : 0) + 2 * leader_count;
    double part = 0;
    const auto stage = [&](auto&& work) {
      // More leaders may have to be polished than were counted on.
      const auto step = context_.span(std::min(1.0, part / parts), std::min(1.0, (part + 1) / parts), fitting);
      work();
      part += 1;
    };
    for (const auto& causes : singles) stage([&] { refit_with(causes); });
    normalise(result_.hypotheses);
    if (options_.pairs)
      for (const std::vector<int>& pair : promising_pairs()) stage([&] { refit_with(pair); });
    normalise(result_.hypotheses);
    // The leaders, what they are parts of and have as parts, larger ones first.
    std::set<std::vector<int>> leaders{{}};
    const double highest = result_.hypotheses.front().log_evidence;
    for (const Hypothesis& h : result_.hypotheses) {
      if (leaders.size() > leader_count || (leaders.size() > 2 && h.log_evidence < highest - out_of_reach)) break;
      leaders.insert(h.causes);
      if (h.causes.size() == 2)
        for (const int cause : h.causes) leaders.insert({cause});
    }
    for (const std::size_t size : {2u, 1u, 0u})
      for (Refit& r : refits_)
        if (r.causes.size() == size && leaders.contains(r.causes)) stage([&] { polish(r); });
    normalise(result_.hypotheses);
    renew_noise();
    // The others stay as the linearised model has them, but no better than the worst that was tried in earnest.
    double worst = std::numeric_limits<double>::infinity();
    for (const Hypothesis& h : result_.hypotheses)
      if (h.causes.size() == 1) worst = std::min(worst, h.log_evidence);
    for (Hypothesis h : screened_) {
      const bool tried = std::any_of(refits_.begin(), refits_.end(), [&](const Refit& r) { return r.causes == h.causes; });
      if (h.causes.size() != 1 || tried) continue;
      h.log_evidence = std::min(h.log_evidence, worst);
      result_.hypotheses.push_back(h);
    }
    // A pair of which one does nothing is the other alone, found on another way.
    std::erase_if(result_.hypotheses, [&](const Hypothesis& h) { return h.causes.size() == 2 && !significant(h); });
    normalise(result_.hypotheses);
  }

  /// Pairs that the linearised model likes, about the calibrated model and about the best single causes.
  std::vector<std::vector<int>> promising_pairs() const {
    std::vector<Hypothesis> candidates;
    for (const Hypothesis& h : screened_)
      if (h.causes.size() == 2 && candidates.size() < static_cast<std::size_t>(refitted_pairs) / 3) candidates.push_back(h);
    std::vector<Hypothesis> from_singles;
    int leaders = 0;
    for (const Hypothesis& leader : result_.hypotheses) {
      if (leader.causes.size() != 1 || leaders >= 3) continue;
      const auto r = std::find_if(refits_.begin(), refits_.end(), [&](const Refit& f) { return f.causes == leader.causes; });
      const GramByStructure gram = misfit_->gram(residuals(model_, r->fit.predictions), sensitivities_);
      for (Hypothesis h : all_hypotheses(model_, true)) {
        if (h.causes.size() != 2 || (h.causes[0] != leader.causes[0] && h.causes[1] != leader.causes[0])) continue;
        weigh(model_, gram, columns_, r->fit.u, h);
        from_singles.push_back(h);
      }
      ++leaders;
    }
    if (!from_singles.empty()) normalise(from_singles);
    candidates.insert(candidates.end(), from_singles.begin(), from_singles.end());
    std::vector<std::vector<int>> pairs;
    for (const Hypothesis& h : candidates)
      if (std::find(pairs.begin(), pairs.end(), h.causes) == pairs.end() && pairs.size() < static_cast<std::size_t>(refitted_pairs)) pairs.push_back(h.causes);
    return pairs;
  }

  const Refit& refit_of(const std::vector<int>& causes) const {
    return *std::find_if(refits_.begin(), refits_.end(), [&](const Refit& r) { return r.causes == causes; });
  }

  /// How much structure is left with these causes, counted alike whether unknown structure was allowed or not.
  double structure_left(const std::vector<int>& causes) const {
    double structure = 0, weight = 0;
    for (const Hypothesis& h : result_.hypotheses)
      if (h.causes == causes) structure += (h.probability + 1e-300) * h.structure, weight += h.probability + 1e-300;
    return structure / weight;
  }

  HeldOut held_out(const ParameterFit& fit) {
    return hold_out(bag_, fit, weights_, nearest_size(model_.known_misfit()), result_.liberties, result_.liberty_sensitivities, context_);
  }

  std::vector<Eigen::VectorXd> predicted(const ParameterFit& fit, const std::vector<int>& causes) const {
    return predictive_errors(model_, fit, weights_, nearest_size(structure_left(causes)), result_.liberties, result_.liberty_sensitivities);
  }

  /// The most probable explanation whose causes predict held-out data better than their absence does, all fitted alike.
  void judge() {
    const auto span = context_.span(0.85, 1, "Predicting what was held out");
    find_causes();
    result_.unexplained_before = structure_left({});
    result_.extended = result_.base;
    const std::vector<Eigen::VectorXd> without = predicted(refit_of({}).fit, {});
    std::set<std::vector<int>> seen;
    bool only_structure = false;
    for (const Hypothesis& h : result_.hypotheses) {
      if (h.causes.empty()) {
        only_structure = h.unknown_structure;
        break;
      }
      if (seen.size() >= 3 || h.probability < 1e-3) {
        only_structure = unknown_over_none() > 0;
        break;
      }
      if (!seen.insert(h.causes).second) continue;
      result_.trials.push_back({h.causes, significant(h), {}});
      if (!result_.trials.back().significant) continue;
      const Refit& r = refit_of(h.causes);
      const HeldOutGain gain = compare_errors(model_, without, predicted(r.fit, h.causes), weights_);
      result_.trials.back().gain = gain;
      if (gain.gain_probability < sure_gain || gain.gain_share < least_gain) continue;
      result_.verdict = h.causes;
      result_.doubtful = h.unknown_structure;
      widen_by_jackknife(r.fit, held_out(r.fit).steps);
      result_.extended = recalibrated(r.fit);
      break;
    }
    const auto before = held_out(result_.base).errors;
    result_.held_out = compare_errors(model_, before, result_.verdict.empty() ? before : held_out(result_.extended).errors);
    result_.unexplained_after = structure_left(result_.verdict);
    result_.structure = nearest_size(result_.unexplained_after);
    measure_structure();
    if (result_.verdict.empty()) {
      result_.reading = only_structure ? Reading::unknown : Reading::none;
      return;
    }
    std::stable_sort(result_.verdict.begin(), result_.verdict.end(), [&](int a, int b) { return movement(a, result_.extended.u) > movement(b, result_.extended.u); });
    result_.reading = Reading::cause;
    const double ratio = result_.unexplained_after / std::max(result_.unexplained_before, 1e-12);
    result_.doubtful |= finding_of(result_.verdict.front()).probability < likely;
    if (result_.doubtful && 1 - ratio * ratio < explained_share) result_.reading = Reading::unknown;
    find_twins();
  }

  /// What was named stays; the base parameters are calibrated about it as those of the base model were.
  ParameterFit recalibrated(const ParameterFit& fit) {
    ParameterFit result = fit_parameters(bag_, *mean_distance_objective(model_, softness()), model_.base_parameters(), fit.u, {}, {}, context_, fitting);
    for (std::size_t a = result.free.size(); a < fit.free.size(); ++a) {
      result.free.push_back(fit.free[a]);
      for (std::size_t object = 0; object < result.sensitivities.size(); ++object) result.sensitivities[object].push_back(fit.sensitivities[object][a]);
    }
    return result;
  }

  /// Distance below which the mean distance is rounded off: the noise.
  double softness() const {
    double soft = 0;
    for (const NoiseEstimate& noise : result_.noise) soft = std::max(soft, noise.sigma);
    return soft;
  }

  /// Intervals of the named causes, by what leaving out a quarter of the data changes: that knows of misfits that no prior has.
  void widen_by_jackknife(const ParameterFit& fit, const Eigen::MatrixXd& steps) {
    for (const int cause : result_.verdict) {
      CauseFinding& finding = *std::find_if(result_.causes.begin(), result_.causes.end(), [&](const CauseFinding& f) { return f.cause == cause; });
      const std::vector<int>& own = model_.causes()[static_cast<std::size_t>(cause)].parameters;
      double variance = 0;
      const double length = Eigen::Map<const Eigen::VectorXd>(finding.values.data(), static_cast<Eigen::Index>(finding.values.size())).norm();
      for (Eigen::Index f = 0; f < steps.cols(); ++f) {
        double along = 0;
        for (std::size_t i = 0; i < own.size(); ++i) {
          const auto row = std::find(fit.free.begin(), fit.free.end(), own[i]) - fit.free.begin();
          along += steps(row, f) * (own.size() == 1 ? 1 : finding.values[i] / std::max(length, 1e-12));
        }
        variance += along * along * (fold_count - 1.0) / fold_count;
      }
      const double half = 0.5 * (finding.high - finding.low);
      const double wider = std::sqrt(half * half + 1.96 * 1.96 * variance);
      finding.low = finding.strength - wider;
      finding.high = finding.strength + wider;
    }
  }

  double unknown_over_none() const {
    double sum = 0;
    for (const Hypothesis& h : result_.hypotheses)
      if (h.causes.empty()) sum += (h.unknown_structure ? 1 : -1) * (h.log_prior + h.log_evidence);
    return sum;
  }

  /// RMS movement, in the measurement's unit, that a cause makes at u.
  double movement(int cause, const Eigen::VectorXd& u) const {
    double squares = 0, count = 0;
    for (std::size_t object = 0; object < sensitivities_.size(); ++object) {
      const Measurement& m = model_.measurements()[object];
      Eigen::MatrixXd field = Eigen::MatrixXd::Zero(m.measured.rows(), m.measured.cols());
      for (const int p : model_.causes()[static_cast<std::size_t>(cause)].parameters) field += u[p] * sensitivities_[object][static_cast<std::size_t>(p)];
      squares += field.squaredNorm();
      count += static_cast<double>(m.measured.rows());
    }
    return std::sqrt(squares / std::max(count, 1.0));
  }

  /// Every cause of it does something: more than the model's own misfit could pass for.
  bool significant(const Hypothesis& h) const {
    return std::all_of(h.causes.begin(), h.causes.end(), [&](int cause) { return movement(cause, h.u) > least_movement * model_.known_misfit(); });
  }

  const CauseFinding& finding_of(int cause) const {
    return *std::find_if(result_.causes.begin(), result_.causes.end(), [&](const CauseFinding& f) { return f.cause == cause; });
  }

  void find_causes() {
    const GramByStructure gram = misfit_->gram(residuals(model_, result_.base.predictions), sensitivities_);
    double none = -std::numeric_limits<double>::infinity();
    for (const Hypothesis& h : result_.hypotheses)
      if (h.causes.empty()) none = std::max(none, h.log_evidence);
    for (int cause = 0; cause < static_cast<int>(model_.causes().size()); ++cause) {
      CauseFinding finding;
      finding.cause = cause;
      finding.least_visible = formwright::least_visible(model_, gram, nearest_size(model_.known_misfit()), columns_, cause);
      const Hypothesis* at = nullptr;
      for (const Hypothesis& h : result_.hypotheses) {
        if (std::find(h.causes.begin(), h.causes.end(), cause) == h.causes.end()) continue;
        finding.probability += h.probability;
        if (at == nullptr) at = &h;
      }
      finding.log_evidence = at->log_evidence - none;
      const bool refitted = std::any_of(refits_.begin(), refits_.end(), [&](const Refit& r) { return r.causes == at->causes; });
      if (!refitted) {
        // Far behind the others: where the linearised model has it.
        for (const int p : model_.causes()[static_cast<std::size_t>(cause)].parameters)
          finding.values.push_back(model_.parameters()[static_cast<std::size_t>(p)].value(at->u[p]));
        finding.strength = finding.values.size() == 1 ? finding.values[0] : Eigen::Map<const Eigen::VectorXd>(finding.values.data(), static_cast<Eigen::Index>(finding.values.size())).norm();
        finding.low = finding.high = finding.strength;
        result_.causes.push_back(finding);
        continue;
      }
      const Refit& r = refit_of(at->causes);
      const StructuredObjective objective(model_, *misfit_, nearest_size(at->structure), result_.liberties, result_.liberty_sensitivities);
      Eigen::VectorXd g;
      Eigen::MatrixXd H;
      objective.quadratic(residuals(model_, r.fit.predictions), r.fit.sensitivities, r.fit.free, r.fit.u, g, H);
      const Eigen::MatrixXd covariance = H.llt().solve(Eigen::MatrixXd::Identity(H.rows(), H.cols()));
      const std::vector<int>& own = model_.causes()[static_cast<std::size_t>(cause)].parameters;
      Eigen::VectorXd value(static_cast<Eigen::Index>(own.size())), slope(value.size());
      Eigen::MatrixXd spread(value.size(), value.size());
      std::vector<Eigen::Index> at_index;
      for (const int p : own) at_index.push_back(std::find(r.fit.free.begin(), r.fit.free.end(), p) - r.fit.free.begin());
      for (Eigen::Index i = 0; i < value.size(); ++i) {
        const ModelParameter& parameter = model_.parameters()[static_cast<std::size_t>(own[static_cast<std::size_t>(i)])];
        value[i] = parameter.value(r.fit.u[own[static_cast<std::size_t>(i)]]);
        finding.values.push_back(value[i]);
        for (Eigen::Index j = 0; j < value.size(); ++j)
          spread(i, j) = covariance(at_index[static_cast<std::size_t>(i)], at_index[static_cast<std::size_t>(j)]);
      }
      finding.strength = value.size() == 1 ? value[0] : value.norm();
      slope = value.norm() > 0 ? Eigen::VectorXd(value / value.norm()) : Eigen::VectorXd::Unit(value.size(), 0);
      const double half = 1.96 * std::sqrt(std::max(0.0, slope.dot(spread * slope)));
      finding.low = finding.strength - half;
      finding.high = finding.strength + half;
      result_.causes.push_back(finding);
    }
    std::stable_sort(result_.causes.begin(), result_.causes.end(), [](const CauseFinding& a, const CauseFinding& b) { return a.probability > b.probability; });
  }

  /// Causes that do the same as a named one as far as these data go.
  void find_twins() {
    const GramByStructure gram = misfit_->gram(residuals(model_, result_.base.predictions), sensitivities_);
    for (const int named : result_.verdict)
      for (int other = 0; other < static_cast<int>(model_.causes().size()); ++other) {
        if (std::find(result_.verdict.begin(), result_.verdict.end(), other) != result_.verdict.end()) continue;
        const double alike = likeness(model_, gram, result_.structure, columns_, named, other);
        // Alike in every respect, or not told apart by these very data.
        const bool undecided = finding_of(other).probability > 0.15 * finding_of(named).probability;
        if (alike > inseparable_likeness || (undecided && alike > 0.5)) result_.not_separable.push_back({named, other, alike});
        if (!undecided) continue;
        if (alike > 0.5 && result_.reading == Reading::cause) result_.reading = Reading::cannot_separate;
        else if (alike <= 0.5) result_.doubtful = true;
      }
  }

  void measure_structure() {
    const Predictions left = residuals(model_, result_.base.predictions), left_after = residuals(model_, result_.extended.predictions);
    double sum = 0, count = 0;
    for (std::size_t object = 0; object < weights_.size(); ++object) {
      result_.structure_before.push_back(test_structure(model_.measurements()[object], left[object], weights_[object]));
      result_.structure_after.push_back(test_structure(model_.measurements()[object], left_after[object], weights_[object]));
      const double d = static_cast<double>(model_.measurements()[object].measured.cols());
      // Mean length of a d-dimensional Gaussian.
      const double per_sigma = std::sqrt(2.0) * std::exp(std::lgamma(0.5 * (d + 1)) - std::lgamma(0.5 * d));
      for (const double w : weights_[object])
        if (w > 0) sum += per_sigma * result_.noise[object].sigma, count += 1;
    }
    result_.noise_floor = count > 0 ? sum / count : 0;
  }

  SimulationBag& bag_;
  const ForwardModel& model_;
  DiagnosisOptions options_;
  Context& context_;
  Diagnosis result_;
  std::vector<Eigen::VectorXd> weights_;
  std::optional<MisfitOfAll> misfit_;
  std::vector<int> columns_;
  std::vector<Sensitivities> sensitivities_;
  std::vector<Hypothesis> screened_;
  std::vector<Refit> refits_;
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

Diagnosis diagnose(SimulationBag& bag, const DiagnosisOptions& options, Context& context) { return Diagnostician(bag, options, context).run(); }

HeldOutGain gain_on_unseen(SimulationBag& unseen, const ForwardModel& from, const Eigen::VectorXd& u_before, const Eigen::VectorXd& u_after, Context& context) {
  const ForwardModel& model = unseen.model();
  const auto translated = [&](const Eigen::VectorXd& u) {
    Eigen::VectorXd own = model.nominal();
    for (std::size_t p = 0; p < model.parameters().size(); ++p)
      for (std::size_t q = 0; q < from.parameters().size(); ++q)
        if (model.parameters()[p].name == from.parameters()[q].name && model.parameters()[p].role != ParameterRole::discrepancy)
          own[static_cast<Eigen::Index>(p)] = model.parameters()[p].coordinate(from.parameters()[q].value(u[static_cast<Eigen::Index>(q)]));
    return own;
  };
  const auto predictions = unseen.run(std::vector<Eigen::VectorXd>{translated(u_before), translated(u_after)}, context, "Predicting the unseen object");
  if (!predictions[0] || !predictions[1]) throw Error(ErrorCode::could_not_solve, "unseen", "The unseen object cannot be simulated with the fitted parameters: check its mould and set-up.");
  std::vector<Eigen::VectorXd> weights;
  const Predictions after = residuals(model, *predictions[1]);
  for (std::size_t object = 0; object < after.size(); ++object) weights.push_back(estimate_noise(model.measurements()[object], after[object]).weights);
  return compare_errors(model, point_errors(residuals(model, *predictions[0]), weights), point_errors(after, weights));
}

}  // namespace formwright
