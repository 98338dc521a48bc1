// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/fit/free_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "base/statistics.h"

namespace formwright {
namespace {

constexpr int rounds = 8;
constexpr double degrees = 4;  // of Student's t

/// Residuals' squared lengths over their median.
Eigen::VectorXd normalised_squares(const Measurement& measurement, const Eigen::MatrixXd& residual) {
  Eigen::VectorXd squares = residual.rowwise().squaredNorm();
  if (measurement.sigma.maxCoeff() > 0)
    squares.array() /= measurement.sigma.array().max(0.1 * measurement.sigma.mean()).square();
  return squares / std::max(1e-300, median(std::vector<double>(squares.begin(), squares.end())));
}

}  // namespace

Predictions freely_fitted(const ForwardModel& model, const Predictions& predictions, const std::vector<int>& columns,
                          const std::vector<Sensitivities>& sensitivities) {
  const auto k = static_cast<Eigen::Index>(columns.size());
  const Predictions before = residuals(model, predictions);
  Predictions fitted = predictions;
  for (int round = 0; round < rounds; ++round) {
    const Predictions left = residuals(model, fitted);
    Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(1 + k, 1 + k);
    for (std::size_t object = 0; object < left.size(); ++object) {
      const Measurement& m = model.measurements()[object];
      const auto d = static_cast<double>(m.measured.cols());
      const Eigen::VectorXd squares = normalised_squares(m, left[object]);
      const Eigen::VectorXd lengths = left[object].rowwise().squaredNorm();
      const double variance = std::max(1e-12, median(std::vector<double>(lengths.begin(), lengths.end())) / d);
      // The median of what is left is about d, in units of the noise.
      const Eigen::VectorXd trust = (degrees + d) / (degrees + d * squares.array());
      const StructuredMisfit misfit(m, isotropic(trust / variance, m.measured.cols()), {model.known_misfit()});
      gram += misfit.gram_at(before[object], sensitivities[object], 0);
    }
    Eigen::MatrixXd A = gram.bottomRightCorner(k, k);
    for (Eigen::Index a = 0; a < k; ++a)
      A(a, a) +=
          std::pow(model.parameters()[static_cast<std::size_t>(columns[static_cast<std::size_t>(a)])].prior_sd, -2);
    const Eigen::VectorXd step = A.llt().solve(gram.col(0).tail(k));
    fitted = predictions;
    for (std::size_t object = 0; object < fitted.size(); ++object)
      for (Eigen::Index a = 0; a < k; ++a)
        fitted[object] += step[a] * sensitivities[object][static_cast<std::size_t>(a)];
  }
  return fitted;
}

}  // namespace formwright
