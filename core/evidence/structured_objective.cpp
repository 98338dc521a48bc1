// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/structured_objective.h"

#include <Eigen/Dense>

#include "evidence/hypotheses.h"

namespace formwright {

MisfitOfAll::MisfitOfAll(const ForwardModel& model, const std::vector<Eigen::VectorXd>& weights) : sizes_(structure_sizes(model)) {
  for (std::size_t object = 0; object < weights.size(); ++object) objects_.emplace_back(model.measurements()[object], weights[object], sizes_);
}

GramByStructure MisfitOfAll::gram(const Predictions& residuals, const std::vector<Sensitivities>& sensitivities) const {
  GramByStructure sum;
  for (std::size_t object = 0; object < objects_.size(); ++object) sum += objects_[object].gram(residuals[object], sensitivities[object]);
  return sum;
}

Eigen::MatrixXd StructuredObjective::reduced(const Predictions& residuals, const std::vector<Sensitivities>& sensitivities) const {
  const auto k = static_cast<Eigen::Index>(sensitivities.empty() ? 0 : sensitivities.front().size());
  const auto d = static_cast<Eigen::Index>(liberty_parameters_.size());
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(1 + k + d, 1 + k + d);
  for (std::size_t object = 0; object < residuals.size(); ++object) {
    Sensitivities columns = sensitivities[object];
    columns.insert(columns.end(), liberties_[object].begin(), liberties_[object].end());
    all += misfit_.objects()[object].gram_at(residuals[object], columns, structure_);
  }
  if (d == 0) return all;
  Eigen::MatrixXd own = all.bottomRightCorner(d, d);
  for (Eigen::Index i = 0; i < d; ++i)
    own(i, i) += 1 / std::pow(model_.parameters()[static_cast<std::size_t>(liberty_parameters_[static_cast<std::size_t>(i)])].prior_sd, 2);
  const Eigen::MatrixXd cross = all.bottomLeftCorner(d, 1 + k);
  return all.topLeftCorner(1 + k, 1 + k) - cross.transpose() * own.llt().solve(cross);
}

std::vector<Eigen::VectorXd> weights_with_liberties(const ForwardModel& model, std::vector<Eigen::VectorXd> weights, const std::vector<int>& liberties,
                                                    const std::vector<Sensitivities>& sensitivities) {
  for (std::size_t object = 0; object < weights.size(); ++object) {
    std::vector<Eigen::MatrixXd> movements;
    for (std::size_t l = 0; l < liberties.size(); ++l)
      movements.push_back(model.parameters()[static_cast<std::size_t>(liberties[l])].prior_sd * sensitivities[object][l]);
    const Eigen::VectorXd variance = model_variance(model.measurements()[object], movements);
    for (Eigen::Index i = 0; i < variance.size(); ++i)
      if (weights[object][i] > 0) weights[object][i] = 1 / (1 / weights[object][i] + variance[i]);
  }
  return weights;
}

double StructuredObjective::value(const Predictions& residuals, const Eigen::VectorXd& u) const {
  double sum = 0.5 * reduced(residuals, std::vector<Sensitivities>(residuals.size()))(0, 0);
  for (Eigen::Index p = 0; p < u.size(); ++p) sum += 0.5 * std::pow(u[p] / model_.parameters()[static_cast<std::size_t>(p)].prior_sd, 2);
  return sum;
}

void StructuredObjective::quadratic(const Predictions& residuals, const std::vector<Sensitivities>& sensitivities, const std::vector<int>& free,
                                    const Eigen::VectorXd& u, Eigen::VectorXd& g, Eigen::MatrixXd& H) const {
  const Eigen::MatrixXd gram = reduced(residuals, sensitivities);
  const auto k = static_cast<Eigen::Index>(free.size());
  g = -gram.col(0).tail(k);
  H = gram.bottomRightCorner(k, k);
  for (Eigen::Index a = 0; a < k; ++a) {
    const Eigen::Index p = free[static_cast<std::size_t>(a)];
    const double precision = std::pow(model_.parameters()[static_cast<std::size_t>(p)].prior_sd, -2);
    g[a] += precision * u[p];
    H(a, a) += precision;
  }
}

}  // namespace formwright
