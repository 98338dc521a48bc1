// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/explanations/fitted_strength.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "evidence/fit/held_out.h"

namespace formwright {
namespace {

Eigen::Map<const Eigen::VectorXd> as_vector(const std::vector<double>& values) {
  return {values.data(), static_cast<Eigen::Index>(values.size())};
}

/// Where the cause's parameters are among those that were fitted.
std::vector<Eigen::Index> places_of(const ForwardModel& model, const ParameterFit& fit, int cause) {
  std::vector<Eigen::Index> places;
  for (const int p : model.causes()[static_cast<std::size_t>(cause)].parameters)
    places.push_back(std::find(fit.free.begin(), fit.free.end(), p) - fit.free.begin());
  return places;
}

/// The direction in which the strength grows.
Eigen::VectorXd growing(const std::vector<double>& values) {
  const auto vector = as_vector(values);
  if (values.size() == 1) return Eigen::VectorXd::Ones(1);
  return vector.norm() > 0 ? Eigen::VectorXd(vector / vector.norm()) : Eigen::VectorXd::Unit(vector.size(), 0);
}

}  // namespace

std::vector<double> values_at(const ForwardModel& model, int cause, const Eigen::VectorXd& u) {
  std::vector<double> values;
  for (const int p : model.causes()[static_cast<std::size_t>(cause)].parameters)
    values.push_back(model.parameters()[static_cast<std::size_t>(p)].value(u[p]));
  return values;
}

double strength_of(const std::vector<double>& values) {
  return values.size() == 1 ? values.front() : as_vector(values).norm();
}

FittedStrength fitted_strength(const ForwardModel& model, const Explanations& tried, const std::vector<int>& causes,
                               int cause, double structure) {
  const ParameterFit& fit = tried.refit_of(causes).fit;
  FittedStrength result;
  result.values = values_at(model, cause, fit.u);
  result.strength = strength_of(result.values);
  const std::vector<Eigen::Index> places = places_of(model, fit, cause);
  const Eigen::VectorXd along = growing(result.values);
  const auto deviation = [&](std::size_t structure_size) {
    const StructuredObjective objective(model, tried.misfit(), structure_size, tried.nuisances(causes));
    Eigen::VectorXd g;
    Eigen::MatrixXd H;
    objective.quadratic(residuals(model, fit.predictions), fit.sensitivities, fit.free, fit.u, g, H);
    const Eigen::MatrixXd covariance = H.llt().solve(Eigen::MatrixXd::Identity(H.rows(), H.cols()));
    return std::sqrt(std::max(0.0, along.dot(covariance(places, places) * along)));
  };
  result.deviation = deviation(tried.nearest_size(structure));
  constexpr std::size_t no_structure = 0;  // structure_sizes() begins with it
  result.noise_deviation = deviation(no_structure);
  return result;
}

double jackknife_deviation(const ForwardModel& model, const ParameterFit& fit, const Eigen::MatrixXd& steps, int cause,
                           const std::vector<double>& values) {
  const std::vector<Eigen::Index> places = places_of(model, fit, cause);
  const Eigen::VectorXd moved = steps(places, Eigen::all).transpose() * growing(values);
  return std::sqrt(moved.squaredNorm() * (fold_count - 1.0) / fold_count);
}

double beyond_noise(double deviation, double noise_deviation) {
  return std::max(0.0, deviation * deviation - noise_deviation * noise_deviation);
}

}  // namespace formwright
