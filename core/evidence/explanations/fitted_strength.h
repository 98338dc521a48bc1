// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How strong a fitted cause is, and how well that is known. For diagnosis.cpp.
#include <Eigen/Core>
#include <vector>

#include "evidence/explanations/explanations.h"

namespace formwright {

inline constexpr double normal_quantile = 1.96;  // 95 % of a Gaussian lie within as many standard deviations

/// Of the parameters of `cause` at u.
std::vector<double> values_at(const ForwardModel& model, int cause, const Eigen::VectorXd& u);
/// The Euclidean norm of `values`; of one parameter its value, with its sign.
double strength_of(const std::vector<double>& values);

struct FittedStrength {
  std::vector<double> values;  // of the cause's parameters
  double strength = 0;         // strength_of() these
  double deviation = 0;        // standard deviation of the strength, with structure of the size that was found
  double noise_deviation = 0;  // the same by measuring noise alone
};

/// Of `cause`, as fitted together with `causes` (refitted). `structure`: what that explanation leaves, in the
/// measurement's unit.
FittedStrength fitted_strength(const ForwardModel& model, const Explanations& tried, const std::vector<int>& causes,
                               int cause, double structure);

/// Standard deviation of the strength, by how far the fit moves without each fold: `steps` (HeldOut). `values`: of the
/// cause's parameters.
double jackknife_deviation(const ForwardModel& model, const ParameterFit& fit, const Eigen::MatrixXd& steps, int cause,
                           const std::vector<double>& values);

/// The variance of an estimate whose standard deviation is `deviation`, beyond what noise alone makes: that is in the
/// posterior already. Where few points are measured, noise is most of what a jackknife sees.
double beyond_noise(double deviation, double noise_deviation);

}  // namespace formwright
