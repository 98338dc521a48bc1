// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/fit/structured_objective.h"

#include <Eigen/Dense>

#include "evidence/fit/hypotheses.h"

namespace formwright {

MisfitOfAll::MisfitOfAll(const ForwardModel& model, const std::vector<Precisions>& precisions)
    : sizes_(structure_sizes(model)) {
  for (std::size_t object = 0; object < precisions.size(); ++object)
    objects_.emplace_back(model.measurements()[object], precisions[object], sizes_);
}

GramByStructure MisfitOfAll::gram(const Predictions& residuals, const std::vector<Sensitivities>& sensitivities) const {
  GramByStructure sum;
  for (std::size_t object = 0; object < objects_.size(); ++object)
    sum += objects_[object].gram(residuals[object], sensitivities[object]);
  return sum;
}

Eigen::MatrixXd StructuredObjective::reduced(const Predictions& residuals,
                                             const std::vector<Sensitivities>& sensitivities) const {
  const auto k = static_cast<Eigen::Index>(sensitivities.empty() ? 0 : sensitivities.front().size());
  const auto d = static_cast<Eigen::Index>(nuisances_.parameters.size());
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(1 + k + d, 1 + k + d);
  for (std::size_t object = 0; object < residuals.size(); ++object) {
    Sensitivities columns = sensitivities[object];
    columns.insert(columns.end(), nuisances_.sensitivities[object].begin(), nuisances_.sensitivities[object].end());
    all += misfit_.objects()[object].gram_at(residuals[object], columns, structure_);
  }
  if (d == 0) return all;
  Eigen::MatrixXd own = all.bottomRightCorner(d, d);
  for (Eigen::Index i = 0; i < d; ++i)
    own(i, i) +=
        1 / std::pow(model_.parameters()[static_cast<std::size_t>(nuisances_.parameters[static_cast<std::size_t>(i)])]
                         .sd_without_cause(),
                     2);
  const Eigen::MatrixXd cross = all.bottomLeftCorner(d, 1 + k);
  return all.topLeftCorner(1 + k, 1 + k) - cross.transpose() * own.llt().solve(cross);
}

std::vector<std::vector<Eigen::MatrixXd>> movements_of(const ForwardModel& model, const std::vector<int>& discrepancies,
                                                       const std::vector<Sensitivities>& sensitivities) {
  std::vector<std::vector<Eigen::MatrixXd>> movements(sensitivities.size());
  for (std::size_t object = 0; object < sensitivities.size(); ++object)
    for (std::size_t l = 0; l < discrepancies.size(); ++l)
      movements[object].push_back(model.parameters()[static_cast<std::size_t>(discrepancies[l])].prior_sd *
                                  sensitivities[object][l]);
  return movements;
}

std::vector<Precisions> precisions_of(const ForwardModel& model, const std::vector<Eigen::VectorXd>& weights,
                                      const std::vector<std::vector<Eigen::MatrixXd>>& movements) {
  std::vector<Precisions> result;
  for (std::size_t object = 0; object < weights.size(); ++object) {
    const Measurement& m = model.measurements()[object];
    const Eigen::Index d = m.measured.cols();
    const Eigen::MatrixXd covariance = model_covariance(m, movements[object]);
    result.push_back(Precisions::Zero(covariance.rows(), d * d));
    for (Eigen::Index i = 0; i < covariance.rows(); ++i) {
      if (!(weights[object][i] > 0)) continue;
      Eigen::MatrixXd C = covariance.row(i).reshaped(d, d);
      C.diagonal().array() += 1 / weights[object][i];
      result.back().row(i) = C.inverse().reshaped(1, d * d);
    }
  }
  return result;
}

double StructuredObjective::value(const Predictions& residuals, const Eigen::VectorXd& u) const {
  double sum = 0.5 * reduced(residuals, std::vector<Sensitivities>(residuals.size()))(0, 0);
  for (Eigen::Index p = 0; p < u.size(); ++p)
    sum += 0.5 * std::pow(u[p] / model_.parameters()[static_cast<std::size_t>(p)].prior_sd, 2);
  return sum;
}

void StructuredObjective::quadratic(const Predictions& residuals, const std::vector<Sensitivities>& sensitivities,
                                    const std::vector<int>& free, const Eigen::VectorXd& u, Eigen::VectorXd& g,
                                    Eigen::MatrixXd& H) const {
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
