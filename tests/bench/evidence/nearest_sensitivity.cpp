// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/nearest_sensitivity.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace formwright {

std::vector<std::pair<std::string, double>> nearest_sensitivities(const ForwardModel& model,
                                                                  const Explanations& tried) {
  // Row and column 0 are the residual, 1 + p parameter p. The first size of structure is none.
  const Eigen::MatrixXd G =
      tried.misfit().gram(residuals(model, tried.base().predictions), tried.sensitivities()).gram.front();
  const std::vector<int> base = model.base_parameters();
  const auto count = static_cast<Eigen::Index>(base.size());
  Eigen::MatrixXd of_base(count, count), to_base(count, G.cols());
  for (Eigen::Index i = 0; i < count; ++i) {
    to_base.row(i) = G.row(1 + base[static_cast<std::size_t>(i)]);
    for (Eigen::Index j = 0; j < count; ++j)
      of_base(i, j) = G(1 + base[static_cast<std::size_t>(i)], 1 + base[static_cast<std::size_t>(j)]);
  }
  const Eigen::MatrixXd left = G - to_base.transpose() * of_base.completeOrthogonalDecomposition().solve(to_base);
  std::vector<std::pair<std::string, double>> result;
  for (const Cause& cause : model.causes()) {
    const auto own = static_cast<Eigen::Index>(cause.parameters.size());
    Eigen::MatrixXd among(own, own);
    Eigen::VectorXd along(own);
    for (Eigen::Index i = 0; i < own; ++i) {
      const Eigen::Index row = 1 + cause.parameters[static_cast<std::size_t>(i)];
      along[i] = left(row, 0);
      for (Eigen::Index j = 0; j < own; ++j) among(i, j) = left(row, 1 + cause.parameters[static_cast<std::size_t>(j)]);
    }
    const double squared =
        along.dot(among.completeOrthogonalDecomposition().solve(along)) / std::max(left(0, 0), 1e-300);
    result.emplace_back(cause.name, std::sqrt(std::clamp(squared, 0.0, 1.0)));
  }
  std::stable_sort(result.begin(), result.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
  return result;
}

}  // namespace formwright
