// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/forward_model.h"

#include <algorithm>
#include <cmath>

namespace formwright {

double ModelParameter::value(double u) const { return std::clamp(logarithmic ? nominal * std::exp(u) : nominal + u, low, high); }

double ModelParameter::coordinate(double value) const {
  // A logarithmic range may begin at zero: far enough below for nothing to change.
  return logarithmic ? std::log(std::max(value, 1e-6 * nominal) / nominal) : value - nominal;
}

std::vector<int> ForwardModel::parameters_with(ParameterRole role) const {
  std::vector<int> indices;
  for (std::size_t p = 0; p < parameters().size(); ++p)
    if (parameters()[p].role == role) indices.push_back(static_cast<int>(p));
  return indices;
}

Eigen::VectorXd within_ranges(const ForwardModel& model, Eigen::VectorXd u) {
  for (Eigen::Index p = 0; p < u.size(); ++p) {
    const ModelParameter& parameter = model.parameters()[static_cast<std::size_t>(p)];
    u[p] = std::clamp(u[p], parameter.low_u(), parameter.high_u());
  }
  return u;
}

}  // namespace formwright
