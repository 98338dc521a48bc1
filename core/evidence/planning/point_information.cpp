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

PointInformation::PointInformation(const ForwardModel& model, const std::vector<Sensitivities>& sensitivities,
                                   const std::vector<Precisions>& precisions, double structure) {
  std::vector<std::size_t> used;
  Eigen::Index columns = 0, coefficients = 0;
  const auto count = static_cast<Eigen::Index>(model.parameters().size());
  for (std::size_t m = 0; m < model.measurements().size(); ++m) {
    const Measurement& own = model.measurements()[m];
    if (m > 0 && own.places_index != 0) continue;
    used.push_back(m);
    columns += own.measured.size();
    coefficients += own.measured.cols() * structure_mode_count;
  }
  effects_.setZero(count + coefficients, columns);
  Eigen::VectorXd prior = Eigen::VectorXd::Ones(effects_.rows());
  for (Eigen::Index p = 0; p < count; ++p) {
    const ModelParameter& parameter = model.parameters()[static_cast<std::size_t>(p)];
    prior[p] = parameter.prior_sd * parameter.prior_sd;
    if (parameter.role == ParameterRole::effect) causes_.push_back(p);
  }
  Eigen::Index first_of_structure = count;
  for (const std::size_t m : used) {
    const Measurement& own = model.measurements()[m];
    add(own, sensitivities[m], precisions[m], structure, first_of_structure);
    first_of_structure += own.measured.cols() * structure_mode_count;
  }
  covariances_ = prior.asDiagonal() * effects_;
  cause_covariance_ = Eigen::VectorXd(prior(causes_)).asDiagonal();
  cause_factor_.compute(cause_covariance_);
}

void PointInformation::add(const Measurement& measurement, const Sensitivities& sensitivities,
                           const Precisions& precisions, double structure, Eigen::Index first_of_structure) {
  const Eigen::MatrixXd modes = structure_modes(measurement.place);
  const Eigen::Index d = measurement.measured.cols();
  for (Eigen::Index i = 0; i < modes.rows(); ++i) {
    Point own{points_.empty() ? 0 : points_.back().column + points_.back().d, d, {}};
    for (Eigen::Index c = 0; c < d; ++c) {
      for (std::size_t p = 0; p < sensitivities.size(); ++p)
        effects_(static_cast<Eigen::Index>(p), own.column + c) = sensitivities[p](i, c);
      effects_.block(first_of_structure + c * modes.cols(), own.column + c, modes.cols(), 1) =
          structure * modes.row(i).transpose();
    }
    if (precisions(i, 0) > 0) own.noise = Eigen::MatrixXd(precisions.row(i).reshaped(d, d)).inverse();
    points_.push_back(std::move(own));
  }
}

PointInformation::Seen PointInformation::seen(Eigen::Index row) const {
  const auto own = covariances_.middleCols(point(row).column, point(row).d);
  const Eigen::MatrixXd spread = effects_.middleCols(point(row).column, point(row).d).transpose() * own;
  return {own(causes_, Eigen::all), 0.5 * (spread + spread.transpose()) + point(row).noise};
}

double PointInformation::gain(Eigen::Index row) const {
  if (point(row).noise.size() == 0 || causes_.empty()) return 0;
  const auto [causes, spread] = seen(row);
  // det(C - B S^-1 B^T) = det C det(S - B^T C^-1 B) / det S: the spread of the point where the causes are known,
  // against that where they are not.
  const Eigen::MatrixXd known = spread - causes.transpose() * cause_factor_.solve(causes);
  const double gain = 0.5 * (log_determinant(spread) - log_determinant(known));
  return std::isfinite(gain) ? std::max(0.0, gain) : 0;
}

void PointInformation::measure(Eigen::Index row) {
  if (point(row).noise.size() == 0) return;
  total_ += gain(row);
  const auto [causes, spread] = seen(row);
  const Eigen::LLT<Eigen::MatrixXd> factor(spread);
  const Eigen::MatrixXd own = covariances_.middleCols(point(row).column, point(row).d);
  const Eigen::MatrixXd with_all = own.transpose() * effects_;  // covariances of the point with all points
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
