// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/fit/structured_misfit.h"

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

namespace formwright {
namespace {

constexpr int modes_per_side = 9;
static_assert(modes_per_side * modes_per_side == structure_mode_count);
constexpr double correlation_length = 0.12;  // of the object's side: about 25 mm of a sheet

}  // namespace

Eigen::MatrixXd structure_modes(const Eigen::MatrixX2d& place) {
  Eigen::MatrixXd modes(place.rows(), modes_per_side * modes_per_side);
  double total = 0;
  for (int a = 0; a < modes_per_side; ++a)
    for (int b = 0; b < modes_per_side; ++b) {
      const double k_squared = std::numbers::pi * std::numbers::pi * (a * a + b * b);
      const double spectrum =
          std::pow(1 + correlation_length * correlation_length * k_squared / 3, -2.5);  // Matern 3/2 in the plane
      const double mean_square = (a > 0 ? 0.5 : 1.0) * (b > 0 ? 0.5 : 1.0);
      total += spectrum;
      const double scale = std::sqrt(spectrum / mean_square);
      modes.col(a * modes_per_side + b) = scale * (std::numbers::pi * a * place.col(0).array()).cos() *
                                          (std::numbers::pi * b * place.col(1).array()).cos();
    }
  return modes / std::sqrt(total);
}

GramByStructure& GramByStructure::operator+=(const GramByStructure& other) {
  if (gram.empty()) return *this = other;
  for (std::size_t t = 0; t < gram.size(); ++t) {
    gram[t] += other.gram[t];
    log_determinant[t] += other.log_determinant[t];
  }
  return *this;
}

Precisions isotropic(const Eigen::VectorXd& weights, Eigen::Index d) {
  Precisions precisions = Precisions::Zero(weights.size(), d * d);
  for (Eigen::Index c = 0; c < d; ++c) precisions.col(c * d + c) = weights;
  return precisions;
}

Eigen::VectorXd mean_weights(const Precisions& precisions) {
  const auto d = static_cast<Eigen::Index>(std::lround(std::sqrt(static_cast<double>(precisions.cols()))));
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(precisions.rows());
  for (Eigen::Index i = 0; i < weights.size(); ++i)
    if (precisions(i, 0) > 0)
      weights[i] = static_cast<double>(d) / Eigen::MatrixXd(precisions.row(i).reshaped(d, d)).inverse().trace();
  return weights;
}

StructuredMisfit::StructuredMisfit(const Measurement& measurement, Precisions precisions, std::vector<double> tau)
    : precisions_(std::move(precisions)),
      d_(static_cast<Eigen::Index>(std::lround(std::sqrt(static_cast<double>(precisions_.cols()))))),
      tau_(std::move(tau)),
      modes_(structure_modes(measurement.place)) {
  for (Eigen::Index i = 0; i < precisions_.rows(); ++i)
    if (precisions_(i, 0) > 0)
      log_noise_ -= std::log(Eigen::MatrixXd(precisions_.row(i).reshaped(d_, d_)).determinant());
  const Eigen::Index m = modes_.cols();
  Eigen::MatrixXd normal(d_ * m, d_ * m);
  for (Eigen::Index p = 0; p < d_; ++p)
    for (Eigen::Index q = 0; q <= p; ++q) {
      normal.block(p * m, q * m, m, m).noalias() = modes_.transpose() * (weight(p, q) * modes_);
      if (q < p) normal.block(q * m, p * m, m, m) = normal.block(p * m, q * m, m, m).transpose();
    }
  for (const double size : tau_) {
    factor_.emplace_back();
    if (size <= 0) continue;
    Eigen::MatrixXd shifted = normal;
    shifted.diagonal().array() += 1 / (size * size);
    factor_.back() = Eigen::LLT<Eigen::MatrixXd>(shifted).matrixL();
  }
}

StructuredMisfit::Products StructuredMisfit::products(const Eigen::MatrixXd& residual,
                                                      std::span<const Eigen::MatrixXd> sensitivities) const {
  const auto k = static_cast<Eigen::Index>(sensitivities.size());
  std::vector<Eigen::MatrixXd> columns(static_cast<std::size_t>(d_), Eigen::MatrixXd(residual.rows(), 1 + k));
  for (Eigen::Index c = 0; c < d_; ++c) {
    Eigen::MatrixXd& own = columns[static_cast<std::size_t>(c)];
    own.col(0) = residual.col(c);
    for (Eigen::Index j = 0; j < k; ++j) own.col(1 + j) = sensitivities[static_cast<std::size_t>(j)].col(c);
  }
  const Eigen::Index m = modes_.cols();
  Products result{Eigen::MatrixXd::Zero(1 + k, 1 + k), Eigen::MatrixXd(d_ * m, 1 + k)};
  for (Eigen::Index p = 0; p < d_; ++p) {
    Eigen::MatrixXd weighted = weight(p, 0) * columns[0];
    for (Eigen::Index q = 1; q < d_; ++q) weighted += weight(p, q) * columns[static_cast<std::size_t>(q)];
    result.plain.noalias() += columns[static_cast<std::size_t>(p)].transpose() * weighted;
    result.projected.middleRows(p * m, m).noalias() = modes_.transpose() * weighted;
  }
  return result;
}

GramByStructure StructuredMisfit::gram(const Eigen::MatrixXd& residual,
                                       std::span<const Eigen::MatrixXd> sensitivities) const {
  const Products own = products(residual, sensitivities);
  GramByStructure result;
  for (std::size_t t = 0; t < tau_.size(); ++t) {
    result.gram.push_back(own.plain);
    result.log_determinant.push_back(log_noise_);
    if (tau_[t] <= 0) continue;
    // Woodbury: C^-1 = W - W Phi (I / tau^2 + Phi^T W Phi)^-1 Phi^T W.
    const Eigen::MatrixXd half = factor_[t].triangularView<Eigen::Lower>().solve(own.projected);
    result.gram[t].noalias() -= half.transpose() * half;
    result.log_determinant[t] +=
        2 * factor_[t].diagonal().array().log().sum() + 2 * static_cast<double>(d_ * modes_.cols()) * std::log(tau_[t]);
  }
  return result;
}

Eigen::MatrixXd StructuredMisfit::gram_at(const Eigen::MatrixXd& residual,
                                          std::span<const Eigen::MatrixXd> sensitivities, std::size_t index) const {
  Products own = products(residual, sensitivities);
  if (tau_[index] <= 0) return std::move(own.plain);
  factor_[index].triangularView<Eigen::Lower>().solveInPlace(own.projected);
  return own.plain - own.projected.transpose() * own.projected;
}

std::vector<Eigen::MatrixXd> StructuredMisfit::weighed(std::span<const Eigen::MatrixXd> columns,
                                                       std::size_t index) const {
  std::vector<Eigen::MatrixXd> result;
  for (const Eigen::MatrixXd& column : columns) {
    const Eigen::MatrixXd left = tau_[index] > 0 ? Eigen::MatrixXd(column - smooth(column, index)) : column;
    Eigen::MatrixXd weighted = Eigen::MatrixXd::Zero(left.rows(), d_);
    for (Eigen::Index p = 0; p < d_; ++p)
      for (Eigen::Index q = 0; q < d_; ++q) weighted.col(p) += precisions_.col(p * d_ + q).cwiseProduct(left.col(q));
    result.push_back(std::move(weighted));
  }
  return result;
}

Eigen::MatrixXd StructuredMisfit::smooth(const Eigen::MatrixXd& residual, std::size_t index) const {
  Eigen::MatrixXd field = Eigen::MatrixXd::Zero(residual.rows(), residual.cols());
  if (tau_[index] <= 0) return field;
  Eigen::VectorXd coefficients = products(residual, {}).projected.col(0);
  factor_[index].triangularView<Eigen::Lower>().solveInPlace(coefficients);
  factor_[index].transpose().triangularView<Eigen::Upper>().solveInPlace(coefficients);
  for (Eigen::Index c = 0; c < d_; ++c) field.col(c) = modes_ * coefficients.segment(c * modes_.cols(), modes_.cols());
  return field;
}

Eigen::VectorXd StructuredMisfit::leverage(std::size_t index) const {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(precisions_.rows());
  if (tau_[index] <= 0) return sum;
  std::vector<Eigen::MatrixXd> half;
  for (Eigen::Index c = 0; c < d_; ++c) {
    half.push_back(Eigen::MatrixXd::Zero(d_ * modes_.cols(), modes_.rows()));
    half.back().middleRows(c * modes_.cols(), modes_.cols()) = modes_.transpose();
    factor_[index].triangularView<Eigen::Lower>().solveInPlace(half.back());
  }
  for (Eigen::Index p = 0; p < d_; ++p)
    for (Eigen::Index q = 0; q < d_; ++q)
      sum += precisions_.col(p * d_ + q)
                 .cwiseProduct(half[static_cast<std::size_t>(p)]
                                   .cwiseProduct(half[static_cast<std::size_t>(q)])
                                   .colwise()
                                   .sum()
                                   .transpose());
  return sum / static_cast<double>(d_);
}

}  // namespace formwright
