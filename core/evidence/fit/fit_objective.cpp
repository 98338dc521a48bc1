// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/fit/fit_objective.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace formwright {
namespace {

class MeanDistance : public FitObjective {
 public:
  MeanDistance(const ForwardModel& model, double soft) : model_(model), soft_(std::max(soft, 1e-9)) {
    for (const Measurement& measurement : model.measurements())
      count_ += static_cast<double>(measurement.measured.rows());
  }

  double value(const Predictions& residuals, const Eigen::VectorXd& u) const override {
    double sum = 0;
    for (const Eigen::MatrixXd& r : residuals)
      sum += ((r.rowwise().squaredNorm().array() + soft_ * soft_).sqrt() - soft_).sum();
    sum /= count_;
    for (Eigen::Index p = 0; p < u.size(); ++p) sum += 0.5 * pull(p) * u[p] * u[p];
    return sum;
  }

  void quadratic(const Predictions& residuals, const std::vector<Sensitivities>& sensitivities,
                 const std::vector<int>& free, const Eigen::VectorXd& u, Eigen::VectorXd& g,
                 Eigen::MatrixXd& H) const override {
    const auto k = static_cast<Eigen::Index>(free.size());
    g = Eigen::VectorXd::Zero(k);
    H = Eigen::MatrixXd::Zero(k, k);
    for (std::size_t object = 0; object < residuals.size(); ++object) {
      const Eigen::VectorXd w =
          (residuals[object].rowwise().squaredNorm().array() + soft_ * soft_).sqrt().inverse() / count_;
      for (Eigen::Index a = 0; a < k; ++a) {
        const Eigen::MatrixXd weighted = w.asDiagonal() * sensitivities[object][static_cast<std::size_t>(a)];
        g[a] -= weighted.cwiseProduct(residuals[object]).sum();
        for (Eigen::Index b = 0; b <= a; ++b)
          H(a, b) += weighted.cwiseProduct(sensitivities[object][static_cast<std::size_t>(b)]).sum();
      }
    }
    H.triangularView<Eigen::StrictlyUpper>() = H.transpose();
    for (Eigen::Index a = 0; a < k; ++a) {
      const double weight = pull(free[static_cast<std::size_t>(a)]);
      g[a] += weight * u[free[static_cast<std::size_t>(a)]];
      H(a, a) += weight;
    }
  }

 private:
  /// As many points as neighbours that know nothing of each other, about a hundred, would weigh against the prior:
  /// little against any data, yet enough to leave near its nominal value what they do not tell.
  double pull(Eigen::Index p) const {
    return 1e-2 * soft_ / std::pow(model_.parameters()[static_cast<std::size_t>(p)].prior_sd, 2);
  }

  const ForwardModel& model_;
  double soft_, count_ = 0;
};

}  // namespace

std::unique_ptr<FitObjective> mean_distance_objective(const ForwardModel& model, double soft) {
  return std::make_unique<MeanDistance>(model, soft);
}

Predictions residuals(const ForwardModel& model, const Predictions& predictions) {
  Predictions result;
  for (std::size_t object = 0; object < predictions.size(); ++object)
    result.push_back(model.measurements()[object].measured - predictions[object]);
  return result;
}

}  // namespace formwright
