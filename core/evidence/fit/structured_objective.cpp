// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/fit/structured_objective.h"

#include <Eigen/Dense>

#include "evidence/fit/hypotheses.h"

namespace formwright {
namespace {

/// a_i^T b_j.
Eigen::MatrixXd inner_products(std::span<const Eigen::MatrixXd> a, std::span<const Eigen::MatrixXd> b) {
  Eigen::MatrixXd products(static_cast<Eigen::Index>(a.size()), static_cast<Eigen::Index>(b.size()));
  for (Eigen::Index i = 0; i < products.rows(); ++i)
    for (Eigen::Index j = 0; j < products.cols(); ++j)
      products(i, j) = a[static_cast<std::size_t>(i)].cwiseProduct(b[static_cast<std::size_t>(j)]).sum();
  return products;
}

}  // namespace

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

StructuredObjective::StructuredObjective(const ForwardModel& model, const MisfitOfAll& misfit, std::size_t structure,
                                         const NuisanceParameters& nuisances)
    : model_(model), misfit_(misfit), structure_(structure) {
  const auto d = static_cast<Eigen::Index>(nuisances.parameters.size());
  Eigen::MatrixXd own = Eigen::MatrixXd::Zero(d, d);
  for (Eigen::Index i = 0; i < d; ++i) {
    const auto p = static_cast<std::size_t>(nuisances.parameters[static_cast<std::size_t>(i)]);
    own(i, i) = 1 / std::pow(model.parameters()[p].sd_without_cause(), 2);
  }
  for (std::size_t object = 0; object < misfit.objects().size(); ++object) {
    const Sensitivities& columns = nuisances.sensitivities[object];
    weighed_nuisances_.push_back(misfit.objects()[object].weighed(columns, structure));
    own += inner_products(weighed_nuisances_.back(), columns);
  }
  nuisance_factor_.compute(own);
}

Eigen::MatrixXd StructuredObjective::reduced(const Predictions& residuals,
                                             const std::vector<Sensitivities>& sensitivities) const {
  const auto k = static_cast<Eigen::Index>(sensitivities.front().size());
  const Eigen::Index d = nuisance_factor_.rows();
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(1 + k, 1 + k), cross = Eigen::MatrixXd::Zero(d, 1 + k);
  for (std::size_t object = 0; object < residuals.size(); ++object) {
    gram += misfit_.objects()[object].gram_at(residuals[object], sensitivities[object], structure_);
    cross.col(0) += inner_products(weighed_nuisances_[object], {&residuals[object], 1});
    cross.rightCols(k) += inner_products(weighed_nuisances_[object], sensitivities[object]);
  }
  if (d == 0) return gram;
  return gram - cross.transpose() * nuisance_factor_.solve(cross);
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
