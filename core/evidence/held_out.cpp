// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/held_out.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

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

HeldOutGain compare_errors(const ForwardModel& model, const std::vector<Eigen::VectorXd>& before, const std::vector<Eigen::VectorXd>& after) {
  struct Block {
    double before = 0, after = 0, count = 0;
  };
  std::vector<Block> blocks;
  for (std::size_t object = 0; object < before.size(); ++object) {
    std::array<Block, block_count> own{};
    for (Eigen::Index i = 0; i < before[object].size(); ++i) {
      if (before[object][i] < 0 || after[object][i] < 0) continue;
      Block& block = own[static_cast<std::size_t>(block_of(model.measurements()[object], i))];
      block.before += before[object][i];
      block.after += after[object][i];
      block.count += 1;
    }
    for (const Block& block : own)
      if (block.count > 0) blocks.push_back(block);
  }
  HeldOutGain gain;
  if (blocks.empty()) return gain;
  const auto sum = [](const std::vector<Block>& list) {
    Block total;
    for (const Block& block : list) total.before += block.before, total.after += block.after, total.count += block.count;
    return total;
  };
  const Block all = sum(blocks);
  constexpr int draws = 800;
  std::array<std::vector<double>, 3> drawn;
  std::uint64_t state = 0x2545f4914f6cdd1dull;
  for (int k = 0; k < draws; ++k) {
    std::vector<Block> sample;
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      state = state * 6364136223846793005ull + 1442695040888963407ull;
      sample.push_back(blocks[static_cast<std::size_t>((state >> 33) % blocks.size())]);
    }
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
  gain.gain_low = low(2);
  gain.gain_high = high(2);
  return gain;
}

std::vector<Eigen::VectorXd> held_out_errors(SimulationBag& bag, const ParameterFit& fit, const std::vector<Eigen::VectorXd>& weights, std::size_t structure,
                                             const std::vector<int>& liberty_parameters, const std::vector<Sensitivities>& liberties, Context& context) {
  const ForwardModel& model = bag.model();
  const Predictions at_fit = residuals(model, fit.predictions);
  // The step from the fit to where it would be without `left_out` (none: -1). The fit is not at rest to the last digit, so its own step is
  // taken off: what counts is the difference that the fold makes.
  const auto k = static_cast<Eigen::Index>(fit.free.size());
  const auto step_without = [&](int left_out) {
    std::vector<Eigen::VectorXd> others = weights;
    for (std::size_t object = 0; object < weights.size(); ++object)
      for (Eigen::Index i = 0; i < weights[object].size(); ++i)
        if (fold_of(block_of(model.measurements()[object], i)) == left_out) others[object][i] = 0;
    const MisfitOfAll misfit(model, others);
    const StructuredObjective objective(model, misfit, structure, liberty_parameters, liberties);
    Eigen::VectorXd g, low(k), high(k);
    Eigen::MatrixXd H;
    objective.quadratic(at_fit, fit.sensitivities, fit.free, fit.u, g, H);
    for (Eigen::Index a = 0; a < k; ++a) {
      const ModelParameter& p = model.parameters()[static_cast<std::size_t>(fit.free[static_cast<std::size_t>(a)])];
      const double u = fit.u[fit.free[static_cast<std::size_t>(a)]];
      low[a] = std::max(p.low_u() - u, -2 * p.probe);
      high[a] = std::min(p.high_u() - u, 2 * p.probe);
    }
    return bounded_step(H, g, low, high);
  };
  const Eigen::VectorXd at_rest = step_without(-1);
  std::vector<Eigen::VectorXd> points;
  for (int fold = 0; fold < fold_count; ++fold) {
    const Eigen::VectorXd step = step_without(fold) - at_rest;
    points.push_back(fit.u);
    for (Eigen::Index a = 0; a < k; ++a) points.back()[fit.free[static_cast<std::size_t>(a)]] += step[a];
    points.back() = within_ranges(model, points.back());
  }
  const auto predictions = bag.run(points, context, "Predicting what was held out");
  std::vector<Eigen::VectorXd> errors = point_errors(at_fit, weights);
  for (int fold = 0; fold < fold_count; ++fold) {
    if (!predictions[static_cast<std::size_t>(fold)]) continue;  // the fit to all data stands in for it
    const auto own = point_errors(residuals(model, *predictions[static_cast<std::size_t>(fold)]), weights);
    for (std::size_t object = 0; object < own.size(); ++object)
      for (Eigen::Index i = 0; i < own[object].size(); ++i)
        if (fold_of(block_of(model.measurements()[object], i)) == fold) errors[object][i] = own[object][i];
  }
  return errors;
}

}  // namespace formwright
