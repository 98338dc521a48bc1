// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/planning/point_information.h"

#include <Eigen/Dense>
#include <cmath>

namespace formwright {
namespace {

double log_determinant(const Eigen::MatrixXd& M) {
  return 2 * Eigen::MatrixXd(M.llt().matrixL()).diagonal().array().log().sum();
}

}  // namespace

PointInformation::PointInformation(const ForwardModel& model, const Sensitivities& sensitivities,
                                   const Precisions& precisions, double structure) {
  const Measurement& m = model.measurements().front();
  const Eigen::MatrixXd modes = structure_modes(m.place);
  const Eigen::Index n = m.place.rows(), count = static_cast<Eigen::Index>(sensitivities.size()),
                     unknowns_of_structure = modes.cols();
  d_ = m.measured.cols();
  const Eigen::Index unknowns = count + d_ * unknowns_of_structure;
  Eigen::VectorXd prior = Eigen::VectorXd::Ones(unknowns);
  for (Eigen::Index p = 0; p < count; ++p) {
    const ModelParameter& parameter = model.parameters()[static_cast<std::size_t>(p)];
    prior[p] = parameter.prior_sd * parameter.prior_sd;
    if (parameter.role == ParameterRole::effect) causes_.push_back(p);
  }
  effects_.setZero(unknowns, n * d_);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index c = 0; c < d_; ++c) {
      for (Eigen::Index p = 0; p < count; ++p)
        effects_(p, i * d_ + c) = sensitivities[static_cast<std::size_t>(p)](i, c);
      effects_.block(count + c * unknowns_of_structure, i * d_ + c, unknowns_of_structure, 1) =
          structure * modes.row(i).transpose();
    }
  covariances_ = prior.asDiagonal() * effects_;
  cause_covariance_ = Eigen::VectorXd(prior(causes_)).asDiagonal();
  cause_factor_.compute(cause_covariance_);
  for (Eigen::Index i = 0; i < n; ++i) {
    noise_.emplace_back();
    if (precisions(i, 0) > 0) noise_.back() = Eigen::MatrixXd(precisions.row(i).reshaped(d_, d_)).inverse();
  }
}

PointInformation::Seen PointInformation::seen(Eigen::Index row) const {
  const auto own = covariances_.middleCols(row * d_, d_);
  const Eigen::MatrixXd spread = effects_.middleCols(row * d_, d_).transpose() * own;
  return {own(causes_, Eigen::all), 0.5 * (spread + spread.transpose()) + noise_[static_cast<std::size_t>(row)]};
}

double PointInformation::gain(Eigen::Index row) const {
  if (noise_[static_cast<std::size_t>(row)].size() == 0 || causes_.empty()) return 0;
  const auto [causes, spread] = seen(row);
  // det(C - B S^-1 B^T) = det C det(S - B^T C^-1 B) / det S: the spread of the point where the causes are known,
  // against that where they are not.
  const Eigen::MatrixXd known = spread - causes.transpose() * cause_factor_.solve(causes);
  const double gain = 0.5 * (log_determinant(spread) - log_determinant(known));
  return std::isfinite(gain) ? std::max(0.0, gain) : 0;
}

void PointInformation::measure(Eigen::Index row) {
  if (noise_[static_cast<std::size_t>(row)].size() == 0) return;
  total_ += gain(row);
  const auto [causes, spread] = seen(row);
  const Eigen::LLT<Eigen::MatrixXd> factor(spread);
  const Eigen::MatrixXd own = covariances_.middleCols(row * d_, d_);
  const Eigen::MatrixXd with_all = own.transpose() * effects_;  // d x n d: covariances of the point with all points
  covariances_ -= own * factor.solve(with_all);
  cause_covariance_ -= causes * factor.solve(causes.transpose());
  cause_covariance_ = (0.5 * (cause_covariance_ + cause_covariance_.transpose())).eval();
  cause_factor_.compute(cause_covariance_);
}

double information_about_causes(const ForwardModel& model, const Eigen::MatrixXd& gram) {
  Eigen::MatrixXd precision = gram;
  std::vector<Eigen::Index> causes;
  double prior = 0;
  for (Eigen::Index p = 0; p < gram.rows(); ++p) {
    const ModelParameter& parameter = model.parameters()[static_cast<std::size_t>(p)];
    precision(p, p) += 1 / (parameter.prior_sd * parameter.prior_sd);
    if (parameter.role != ParameterRole::effect) continue;
    causes.push_back(p);
    prior += 2 * std::log(parameter.prior_sd);
  }
  if (causes.empty()) return 0;
  const Eigen::MatrixXd covariance =
      precision.llt().solve(Eigen::MatrixXd::Identity(precision.rows(), precision.cols()));
  return 0.5 * (prior - log_determinant(covariance(causes, causes)));
}

}  // namespace formwright
