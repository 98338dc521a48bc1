// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How much a measured point may be trusted: its stated standard deviation, checked against the data, and less where it
// is an outlier.
#include <Eigen/Core>
#include <vector>

#include "evidence/fit/forward_model.h"

namespace formwright {

struct NoiseEstimate {
  Eigen::VectorXd weights;  // n: inverse variances; 0 for outliers
  double sigma = 0;         // of one number of a good point, RMS, as found in the data (measurement's unit)
  double stated_sigma = 0;  // the same as the file says; 0 where it does not
  double scale = 1;         // found / stated
  int outliers = 0;
};

/// Of the measurements of places, the largest NoiseEstimate::sigma: distances below it are rounded off.
double largest_noise(const ForwardModel& model, const std::vector<NoiseEstimate>& noise);

/// With fewer points, nothing but the stated standard deviations says how large the noise is: what is left of ten
/// points can be smooth as well.
inline constexpr int min_points_to_find_noise = 30;

/// Fewer points than min_points_to_find_noise are taken as stated, none of them as an outlier.
/// `residual` n x d of some model near the truth. What is smooth over the object is not noise, so it is taken off
/// first, robustly.
NoiseEstimate estimate_noise(const Measurement& measurement, const Eigen::MatrixXd& residual);

/// Where equally good simulations disagree, a point is no evidence in that direction: covariance of its d numbers (n
/// rows of d x d) from what `movements` (n x d each, one standard deviation of a discrepancy parameter) do at it
/// and around it. Thin necks of a sheet move by many millimetres with the mesh, along the wall of the mould; across it
/// they do not.
Eigen::MatrixXd model_covariance(const Measurement& measurement, const std::vector<Eigen::MatrixXd>& movements);

/// Correlation of residuals between neighbours: is there structure beyond noise?
struct StructureTest {
  double neighbour_correlation = 0;  // 0 for noise, near 1 for a smooth field
  double p_value = 1;                // of as much correlation by chance, by permutation
  double correlation_length_mm = 0;  // distance at which the correlation has fallen to 1/e
};

/// `residual` n x d; points of weight 0 are left out.
StructureTest test_structure(const Measurement& measurement, const Eigen::MatrixXd& residual,
                             const Eigen::VectorXd& weights);

}  // namespace formwright
