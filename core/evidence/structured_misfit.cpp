// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/structured_misfit.h"

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

namespace formwright {
namespace {

constexpr int modes_per_side = 9;
constexpr double correlation_length = 0.12;  // of the object's side: about 25 mm of a sheet

/// n x 81 cosine modes with the square roots of the spectrum.
Eigen::MatrixXd cosine_modes(const Eigen::MatrixX2d& place) {
  Eigen::MatrixXd modes(place.rows(), modes_per_side * modes_per_side);
  double total = 0;
  for (int a = 0; a < modes_per_side; ++a)
    for (int b = 0; b < modes_per_side; ++b) {
      const double k_squared = std::numbers::pi * std::numbers::pi * (a * a + b * b);
      const double spectrum = std::pow(1 + correlation_length * correlation_length * k_squared / 3, -2.5);  // Matern 3/2 in the plane
      const double mean_square = (a > 0 ? 0.5 : 1.0) * (b > 0 ? 0.5 : 1.0);
      total += spectrum;
      const double scale = std::sqrt(spectrum / mean_square);
      modes.col(a * modes_per_side + b) = scale * (std::numbers::pi * a * place.col(0).array()).cos() * (std::numbers::pi * b * place.col(1).array()).cos();
    }
  return modes / std::sqrt(total);
}

}  // namespace

GramByStructure& GramByStructure::operator+=(const GramByStructure& other) {
  if (gram.empty()) return *this = other;
  for (std::size_t t = 0; t < gram.size(); ++t) {
    gram[t] += other.gram[t];
    log_determinant[t] += other.log_determinant[t];
  }
  return *this;
}

StructuredMisfit::StructuredMisfit(const Measurement& measurement, Eigen::VectorXd weights, std::vector<double> tau)
    : weights_(std::move(weights)), tau_(std::move(tau)), modes_(cosine_modes(measurement.place)) {
  const Eigen::MatrixXd normal = modes_.transpose() * weights_.asDiagonal() * modes_;
  for (const double size : tau_) {
    factor_.emplace_back();
    if (size <= 0) continue;
    Eigen::MatrixXd shifted = normal;
    shifted.diagonal().array() += 1 / (size * size);
    factor_.back() = Eigen::LLT<Eigen::MatrixXd>(shifted).matrixL();
  }
}

/// Calls use(plain, projected): columns^T W columns and Phi^T W columns, for each of the d numbers of a point.
template <class Use>
void StructuredMisfit::for_each_number(const Eigen::MatrixXd& residual, std::span<const Eigen::MatrixXd> sensitivities, Use&& use) const {
  const auto k = static_cast<Eigen::Index>(sensitivities.size());
  Eigen::MatrixXd columns(residual.rows(), 1 + k);
  for (Eigen::Index c = 0; c < residual.cols(); ++c) {
    columns.col(0) = residual.col(c);
    for (Eigen::Index j = 0; j < k; ++j) columns.col(1 + j) = sensitivities[static_cast<std::size_t>(j)].col(c);
    const Eigen::MatrixXd weighted = weights_.asDiagonal() * columns;
    use(Eigen::MatrixXd(columns.transpose() * weighted), Eigen::MatrixXd(modes_.transpose() * weighted));
  }
}

GramByStructure StructuredMisfit::gram(const Eigen::MatrixXd& residual, std::span<const Eigen::MatrixXd> sensitivities) const {
  const auto k = static_cast<Eigen::Index>(sensitivities.size());
  GramByStructure result;
  result.gram.assign(tau_.size(), Eigen::MatrixXd::Zero(1 + k, 1 + k));
  result.log_determinant.assign(tau_.size(), 0);
  double log_weights = 0;
  for (const double w : weights_)
    if (w > 0) log_weights += std::log(w);
  for_each_number(residual, sensitivities, [&](const Eigen::MatrixXd& plain, const Eigen::MatrixXd& projected) {
    for (std::size_t t = 0; t < tau_.size(); ++t) {
      result.gram[t] += plain;
      result.log_determinant[t] -= log_weights;
      if (tau_[t] <= 0) continue;
      // Woodbury: C^-1 = W - W Phi (I / tau^2 + Phi^T W Phi)^-1 Phi^T W.
      const Eigen::MatrixXd half = factor_[t].triangularView<Eigen::Lower>().solve(projected);
      result.gram[t].noalias() -= half.transpose() * half;
      result.log_determinant[t] += 2 * factor_[t].diagonal().array().log().sum() + 2 * static_cast<double>(modes_.cols()) * std::log(tau_[t]);
    }
  });
  return result;
}

Eigen::MatrixXd StructuredMisfit::gram_at(const Eigen::MatrixXd& residual, std::span<const Eigen::MatrixXd> sensitivities, std::size_t index) const {
  const auto k = static_cast<Eigen::Index>(sensitivities.size());
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(1 + k, 1 + k);
  for_each_number(residual, sensitivities, [&](const Eigen::MatrixXd& plain, const Eigen::MatrixXd& projected) {
    result += plain;
    if (tau_[index] <= 0) return;
    const Eigen::MatrixXd half = factor_[index].triangularView<Eigen::Lower>().solve(projected);
    result.noalias() -= half.transpose() * half;
  });
  return result;
}

Eigen::MatrixXd StructuredMisfit::smooth(const Eigen::MatrixXd& residual, std::size_t index) const {
  if (tau_[index] <= 0) return Eigen::MatrixXd::Zero(residual.rows(), residual.cols());
  Eigen::MatrixXd coefficients = modes_.transpose() * (weights_.asDiagonal() * residual);
  factor_[index].triangularView<Eigen::Lower>().solveInPlace(coefficients);
  factor_[index].transpose().triangularView<Eigen::Upper>().solveInPlace(coefficients);
  return modes_ * coefficients;
}

Eigen::VectorXd StructuredMisfit::leverage(std::size_t index) const {
  if (tau_[index] <= 0) return Eigen::VectorXd::Zero(weights_.size());
  const Eigen::MatrixXd half = factor_[index].triangularView<Eigen::Lower>().solve(modes_.transpose());
  return (half.colwise().squaredNorm().transpose().array() * weights_.array()).matrix();
}

}  // namespace formwright
