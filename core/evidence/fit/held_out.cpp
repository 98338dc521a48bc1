// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/fit/held_out.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numeric>

#include "base/random.h"

namespace formwright {

int block_of(const Measurement& measurement, Eigen::Index point) {
  const auto cell = [](double t) { return std::clamp(static_cast<int>(4 * t), 0, 3); };
  return 4 * cell(measurement.place(point, 0)) + cell(measurement.place(point, 1));
}

int fold_of(int block) { return (block / 4 + 2 * (block % 4)) % fold_count; }

std::vector<Eigen::VectorXd> point_errors(const Predictions& residuals, const std::vector<Eigen::VectorXd>& weights) {
  std::vector<Eigen::VectorXd> errors;
  for (std::size_t object = 0; object < residuals.size(); ++object)
    errors.push_back((weights[object].array() > 0).select(residuals[object].rowwise().norm(), -1.0));
  return errors;
}

namespace {

/// `measurements`: which are compared.
HeldOutGain compare(const ForwardModel& model, const std::vector<std::size_t>& measurements,
                    const std::vector<Eigen::VectorXd>& before, const std::vector<Eigen::VectorXd>& after,
                    const std::vector<Eigen::VectorXd>& weights) {
  struct Block {
    double before = 0, after = 0, count = 0;
  };
  std::vector<Block> blocks;
  for (const std::size_t m : measurements) {
    const double scale = weights.empty() ? model.measurements()[m].scale : 1;
    std::array<Block, block_count> own{};
    for (Eigen::Index i = 0; i < before[m].size(); ++i) {
      if (before[m][i] < 0 || after[m][i] < 0) continue;
      Block& block = own[static_cast<std::size_t>(block_of(model.measurements()[m], i))];
      const double weight = weights.empty() ? 1 : std::sqrt(weights[m][i]);
      block.before += weight * before[m][i] / scale;
      block.after += weight * after[m][i] / scale;
      block.count += weight;
    }
    for (const Block& block : own)
      if (block.count > 0) blocks.push_back(block);
  }
  HeldOutGain gain;
  if (blocks.empty()) return gain;
  const auto sum = [](const std::vector<Block>& list) {
    Block total;
    for (const Block& block : list)
      total.before += block.before, total.after += block.after, total.count += block.count;
    return total;
  };
  const Block all = sum(blocks);
  constexpr int draws = 800;
  std::array<std::vector<double>, 3> drawn;
  Random random(1);
  for (int k = 0; k < draws; ++k) {
    std::vector<Block> sample;
    for (std::size_t i = 0; i < blocks.size(); ++i) sample.push_back(blocks[random.below(blocks.size())]);
    const Block total = sum(sample);
    drawn[0].push_back(total.before / total.count);
    drawn[1].push_back(total.after / total.count);
    drawn[2].push_back(1 - total.after / std::max(total.before, 1e-12));
  }
  for (auto& list : drawn) std::sort(list.begin(), list.end());
  const auto low = [&](std::size_t i) { return drawn[i][static_cast<std::size_t>(draws / 40)]; };
  const auto high = [&](std::size_t i) { return drawn[i][static_cast<std::size_t>(draws - 1 - draws / 40)]; };
  gain.before = {all.before / all.count, low(0), high(0)};
  gain.after = {all.after / all.count, low(1), high(1)};
  gain.gain_share = 1 - gain.after.mean / std::max(gain.before.mean, 1e-12);
  gain.gain_probability =
      static_cast<double>(std::count_if(drawn[2].begin(), drawn[2].end(), [](double g) { return g > 0; })) / draws;
  gain.gain_low = low(2);
  gain.gain_high = high(2);
  return gain;
}

}  // namespace

double noise_floor(const ForwardModel& model, const std::vector<NoiseEstimate>& noise,
                   const std::vector<Precisions>& precisions) {
  double sum = 0, count = 0;
  for (std::size_t m = 0; m < precisions.size(); ++m) {
    if (!model.measurements()[m].is_place()) continue;
    const double d = static_cast<double>(model.measurements()[m].measured.cols());
    const double per_sigma = std::sqrt(2.0) * std::exp(std::lgamma(0.5 * (d + 1)) - std::lgamma(0.5 * d));
    const auto counted = static_cast<double>((mean_weights(precisions[m]).array() > 0).count());
    sum += counted * per_sigma * noise[m].sigma;
    count += counted;
  }
  return count > 0 ? sum / count : 0;
}

HeldOutGain compare_distances(const ForwardModel& model, const std::vector<Eigen::VectorXd>& before,
                              const std::vector<Eigen::VectorXd>& after) {
  std::vector<std::size_t> places;
  for (std::size_t m = 0; m < before.size(); ++m)
    if (model.measurements()[m].is_place()) places.push_back(m);
  return compare(model, places, before, after, {});
}

HeldOutGain compare_errors_of(const ForwardModel& model, std::size_t measurement,
                              const std::vector<Eigen::VectorXd>& before, const std::vector<Eigen::VectorXd>& after) {
  return compare(model, {measurement}, before, after, {});
}

HeldOutGain compare_weighed_errors(const ForwardModel& model, const std::vector<Eigen::VectorXd>& before,
                                   const std::vector<Eigen::VectorXd>& after,
                                   const std::vector<Eigen::VectorXd>& weights) {
  std::vector<std::size_t> all(before.size());
  std::iota(all.begin(), all.end(), 0);
  return compare(model, all, before, after, weights);
}

namespace {

/// `precisions` without the points of a fold (-1: with all).
std::vector<Precisions> without_fold(const ForwardModel& model, std::vector<Precisions> precisions, int left_out) {
  for (std::size_t object = 0; object < precisions.size(); ++object)
    for (Eigen::Index i = 0; i < precisions[object].rows(); ++i)
      if (fold_of(block_of(model.measurements()[object], i)) == left_out) precisions[object].row(i).setZero();
  return precisions;
}

/// Errors at the points that count.
std::vector<Eigen::VectorXd> counted_errors(const Predictions& residuals, const std::vector<Precisions>& precisions) {
  std::vector<Eigen::VectorXd> counts;
  for (const Precisions& p : precisions) counts.push_back(p.col(0));
  return point_errors(residuals, counts);
}

/// The same, each direction weighed as the point's precisions have it: sqrt(r^T W r / w), with w their mean weight.
std::vector<Eigen::VectorXd> weighed_errors(const Predictions& residuals, const std::vector<Precisions>& precisions) {
  std::vector<Eigen::VectorXd> errors = counted_errors(residuals, precisions);
  for (std::size_t object = 0; object < residuals.size(); ++object) {
    const Eigen::MatrixXd& r = residuals[object];
    const Eigen::VectorXd weights = mean_weights(precisions[object]);
    for (Eigen::Index i = 0; i < r.rows(); ++i)
      if (weights[i] > 0) {
        const Eigen::MatrixXd W = precisions[object].row(i).reshaped(r.cols(), r.cols());
        errors[object][i] = std::sqrt(r.row(i).dot(W * r.row(i).transpose()) / weights[i]);
      }
  }
  return errors;
}

/// Takes over `own` where a point is of the fold.
void take_fold(const ForwardModel& model, const std::vector<Eigen::VectorXd>& own, int fold,
               std::vector<Eigen::VectorXd>& errors) {
  for (std::size_t object = 0; object < own.size(); ++object)
    for (Eigen::Index i = 0; i < own[object].size(); ++i)
      if (fold_of(block_of(model.measurements()[object], i)) == fold) errors[object][i] = own[object][i];
}

}  // namespace

std::vector<Eigen::VectorXd> predictive_errors(const ForwardModel& model, const ParameterFit& fit,
                                               const std::vector<Precisions>& precisions, std::size_t structure,
                                               const NuisanceParameters& nuisances) {
  const std::vector<int> columns = joined(fit.free, nuisances.parameters);
  const std::vector<Sensitivities> sensitivities = side_by_side(fit.sensitivities, nuisances.sensitivities);
  const Predictions left = residuals(model, fit.predictions);
  const auto k = static_cast<Eigen::Index>(columns.size());
  std::vector<Eigen::VectorXd> errors = weighed_errors(left, precisions);
  for (int fold = 0; fold < fold_count; ++fold) {
    const MisfitOfAll misfit(model, without_fold(model, precisions, fold));
    Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(1 + k, 1 + k);
    for (std::size_t object = 0; object < left.size(); ++object)
      gram += misfit.objects()[object].gram_at(left[object], sensitivities[object], structure);
    Eigen::MatrixXd A = gram.bottomRightCorner(k, k);
    Eigen::VectorXd b = gram.col(0).tail(k);
    for (Eigen::Index a = 0; a < k; ++a) {
      const int p = columns[static_cast<std::size_t>(a)];
      const ModelParameter& parameter = model.parameters()[static_cast<std::size_t>(p)];
      const bool fitted = static_cast<std::size_t>(a) < fit.free.size();
      const double precision = std::pow(fitted ? parameter.prior_sd : parameter.sd_without_cause(), -2);
      A(a, a) += precision;
      b[a] -= precision * fit.u[p];
    }
    const Eigen::VectorXd step = A.llt().solve(b);
    Predictions rest = left;
    for (std::size_t object = 0; object < rest.size(); ++object) {
      for (Eigen::Index a = 0; a < k; ++a) rest[object] -= step[a] * sensitivities[object][static_cast<std::size_t>(a)];
      rest[object] -= misfit.objects()[object].smooth(rest[object], structure);
    }
    take_fold(model, weighed_errors(rest, precisions), fold, errors);
  }
  return errors;
}

HeldOut hold_out(SimulationBag& bag, const ParameterFit& fit, const std::vector<Precisions>& precisions,
                 std::size_t structure, const NuisanceParameters& nuisances, Context& context) {
  const ForwardModel& model = bag.model();
  const Predictions at_fit = residuals(model, fit.predictions);
  const auto k = static_cast<Eigen::Index>(fit.free.size());
  struct Fold {
    std::unique_ptr<MisfitOfAll> misfit;
    std::unique_ptr<StructuredObjective> objective;
    double value = 0;  // at the fit to all data
    Eigen::VectorXd step;
  };
  // The step from the fit to where it would be without `left_out` (none: -1).
  const auto without = [&](int left_out) {
    Fold fold;
    fold.misfit = std::make_unique<MisfitOfAll>(model, without_fold(model, precisions, left_out));
    fold.objective = std::make_unique<StructuredObjective>(model, *fold.misfit, structure, nuisances);
    fold.value = fold.objective->value(at_fit, fit.u);
    Eigen::VectorXd g, low(k), high(k);
    Eigen::MatrixXd H;
    fold.objective->quadratic(at_fit, fit.sensitivities, fit.free, fit.u, g, H);
    for (Eigen::Index a = 0; a < k; ++a) {
      const ModelParameter& p = model.parameters()[static_cast<std::size_t>(fit.free[static_cast<std::size_t>(a)])];
      const double u = fit.u[fit.free[static_cast<std::size_t>(a)]];
      low[a] = std::max(p.low_u() - u, -2 * p.probe);
      high[a] = std::min(p.high_u() - u, 2 * p.probe);
    }
    fold.step = bounded_step(H, g, low, high);
    return fold;
  };
  // The fit is not at rest to the last digit, so its own step is taken off: what counts is the difference that the fold
  // makes.
  const Eigen::VectorXd at_rest = without(-1).step;
  HeldOut result{counted_errors(at_fit, precisions), Eigen::MatrixXd::Zero(k, fold_count)};
  std::vector<Fold> folds;
  std::vector<int> open;
  for (int f = 0; f < fold_count; ++f) {
    folds.push_back(without(f));
    folds.back().step -= at_rest;
    open.push_back(f);
  }
  // Where the straight line misses, so that the other folds are served worse than before, a quarter of the way is gone.
  constexpr double shorter = 0.25;
  for (const bool last : {false, true}) {
    if (open.empty()) break;
    std::vector<Eigen::VectorXd> points;
    for (const int f : open) {
      points.push_back(fit.u);
      for (Eigen::Index a = 0; a < k; ++a)
        points.back()[fit.free[static_cast<std::size_t>(a)]] += folds[static_cast<std::size_t>(f)].step[a];
      points.back() = within_ranges(model, points.back());
    }
    const auto predictions = bag.run(points, context, "Predicting the held-out data");
    std::vector<int> still_open;
    for (std::size_t i = 0; i < open.size(); ++i) {
      const int f = open[i];
      Fold& fold = folds[static_cast<std::size_t>(f)];
      const bool worse =
          !predictions[i] || fold.objective->value(residuals(model, *predictions[i]), points[i]) > fold.value;
      if (worse && !last) {
        fold.step *= shorter;
        still_open.push_back(f);
        continue;
      }
      if (!predictions[i]) continue;  // the fit to all data stands in for it
      result.steps.col(f) = fold.step;
      take_fold(model, counted_errors(residuals(model, *predictions[i]), precisions), f, result.errors);
    }
    open = std::move(still_open);
  }
  return result;
}

}  // namespace formwright
