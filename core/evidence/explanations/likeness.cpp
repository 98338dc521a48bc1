// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/explanations/likeness.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace formwright {

std::vector<double> likenesses(const ForwardModel& model, const GramByStructure& gram) {
  // Row and column 0 are the residual, 1 + p parameter p. The first size of structure is none.
  const Eigen::MatrixXd& G = gram.gram.front();
  const std::vector<int> base = model.base_parameters();
  const auto count = static_cast<Eigen::Index>(base.size());
  Eigen::MatrixXd of_base(count, count), to_base(count, G.cols());
  for (Eigen::Index i = 0; i < count; ++i) {
    to_base.row(i) = G.row(1 + base[static_cast<std::size_t>(i)]);
    for (Eigen::Index j = 0; j < count; ++j)
      of_base(i, j) = G(1 + base[static_cast<std::size_t>(i)], 1 + base[static_cast<std::size_t>(j)]);
  }
  const Eigen::MatrixXd left = G - to_base.transpose() * of_base.completeOrthogonalDecomposition().solve(to_base);
  std::vector<double> result;
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
    result.push_back(std::sqrt(std::clamp(squared, 0.0, 1.0)));
  }
  return result;
}

}  // namespace formwright
