// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/fit/forward_model.h"

#include <algorithm>
#include <cmath>

namespace formwright {

double ModelParameter::value(double u) const {
  return std::clamp(logarithmic ? nominal * std::exp(u) : nominal + u, low, high);
}

double ModelParameter::coordinate(double value) const {
  // A logarithmic range may begin at zero: far enough below for nothing to change.
  return logarithmic ? std::log(std::max(value, 1e-6 * nominal) / nominal) : value - nominal;
}

double ForwardModel::strength(int cause, const Eigen::VectorXd& u) const {
  double squares = 0;
  for (const int p : causes()[static_cast<std::size_t>(cause)].parameters)
    squares += std::pow(parameters()[static_cast<std::size_t>(p)].value(u[p]), 2);
  return std::sqrt(squares);
}

bool ForwardModel::is_of(int parameter, const std::vector<int>& causes) const {
  return std::any_of(causes.begin(), causes.end(), [&](int cause) {
    const std::vector<int>& own = this->causes()[static_cast<std::size_t>(cause)].parameters;
    return std::find(own.begin(), own.end(), parameter) != own.end();
  });
}

bool ForwardModel::has_one_sign(const std::vector<int>& causes) const {
  for (std::size_t p = 0; p < parameters().size(); ++p)
    if (parameters()[p].one_sided() && is_of(static_cast<int>(p), causes)) return true;
  return false;
}

std::vector<int> ForwardModel::parameters_with(ParameterRole role) const {
  std::vector<int> indices;
  for (std::size_t p = 0; p < parameters().size(); ++p)
    if (parameters()[p].role == role) indices.push_back(static_cast<int>(p));
  return indices;
}

std::vector<int> ForwardModel::base_and(const std::vector<int>& causes_at_work) const {
  std::vector<int> list = base_parameters();
  for (const int cause : causes_at_work) {
    const std::vector<int>& own = causes()[static_cast<std::size_t>(cause)].parameters;
    list.insert(list.end(), own.begin(), own.end());
  }
  return list;
}

Eigen::VectorXd within_ranges(const ForwardModel& model, Eigen::VectorXd u) {
  for (Eigen::Index p = 0; p < u.size(); ++p) {
    const ModelParameter& parameter = model.parameters()[static_cast<std::size_t>(p)];
    u[p] = std::clamp(u[p], parameter.low_u(), parameter.high_u());
  }
  return u;
}

}  // namespace formwright
