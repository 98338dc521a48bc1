// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Errors on data that were not used: spatial blocks left out in turn, and other objects. Neighbouring points know of
// each other, so single points left out would prove nothing (Roberts et al. 2017).
#include "evidence/fit/noise_model.h"
#include "evidence/fit/structured_objective.h"

namespace formwright {

struct ErrorWithInterval {
  double mean = 0, low = 0, high = 0;  // mean Euclidean distance without outliers; 95 % interval, blocks drawn again
};

struct HeldOutGain {
  ErrorWithInterval before, after;
  double gain_share = 0, gain_low = 0, gain_high = 0;  // 1 - after / before
  double gain_probability = 0;                         // share of the drawn blocks in which there is a gain at all
};

/// 4 x 4 blocks an object; fold of each block 0 to 3, no two blocks that share a side in the same.
inline constexpr int block_count = 16, fold_count = 4;
int block_of(const Measurement& measurement, Eigen::Index point);
int fold_of(int block);

/// Per-point errors |residual|; points of weight 0 are -1.
std::vector<Eigen::VectorXd> point_errors(const Predictions& residuals, const std::vector<Eigen::VectorXd>& weights);

/// Mean distance that noise alone gives places with a weight: the mean length of a Gaussian of as many dimensions.
double noise_floor(const ForwardModel& model, const std::vector<NoiseEstimate>& noise,
                   const std::vector<Precisions>& precisions);

/// Errors of places, in mm.
HeldOutGain compare_distances(const ForwardModel& model, const std::vector<Eigen::VectorXd>& before,
                              const std::vector<Eigen::VectorXd>& after);
/// Errors of one measurement alone, in the unit it was measured in.
HeldOutGain compare_errors_of(const ForwardModel& model, std::size_t measurement,
                              const std::vector<Eigen::VectorXd>& before, const std::vector<Eigen::VectorXd>& after);
/// Errors of all measurements, each counted by how far it may be trusted. `weights`: inverse variances.
HeldOutGain compare_weighed_errors(const ForwardModel& model, const std::vector<Eigen::VectorXd>& before,
                                   const std::vector<Eigen::VectorXd>& after,
                                   const std::vector<Eigen::VectorXd>& weights);

/// What an explanation as a whole (its parameters, nuisance parameters, structure of the size
/// sizes()[structure]) predicts of each fold from the others, linearised about the fit. Lengths of what is left, in
/// which a direction counts by how well it is known; -1 for points that are left out. No simulations.
std::vector<Eigen::VectorXd> predictive_errors(const ForwardModel& model, const ParameterFit& fit,
                                               const std::vector<Precisions>& precisions, std::size_t structure,
                                               const NuisanceParameters& nuisances);

struct HeldOut {
  std::vector<Eigen::VectorXd>
      errors;             // each object, each point, predicted by a fit that did not see it; -1 for points of weight 0
  Eigen::MatrixXd steps;  // free parameters x folds: how far the fit moves without the fold
};

/// For each fold, fits `fit`'s free parameters to the other folds (linearised about the fit) and predicts the fold by a
/// simulation of its own.
HeldOut hold_out(SimulationBag& bag, const ParameterFit& fit, const std::vector<Precisions>& precisions,
                 std::size_t structure, const NuisanceParameters& nuisances, Context& context);

}  // namespace formwright
