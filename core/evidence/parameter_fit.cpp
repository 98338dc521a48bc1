// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/parameter_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "evidence/stepwise_fit.h"

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

Eigen::VectorXd bounded_step(const Eigen::MatrixXd& H, const Eigen::VectorXd& g, const Eigen::VectorXd& low,
                             const Eigen::VectorXd& high) {
  const Eigen::Index k = g.size();
  Eigen::VectorXd s = Eigen::VectorXd::Zero(k).cwiseMax(low).cwiseMin(high);
  // Coordinate descent is exact in the limit, and a handful of parameters makes the limit near.
  for (int sweep = 0; sweep < 2000; ++sweep) {
    double moved = 0;
    for (Eigen::Index a = 0; a < k; ++a) {
      if (!(H(a, a) > 0)) continue;
      const double wanted = std::clamp(s[a] - (g[a] + H.row(a).dot(s)) / H(a, a), low[a], high[a]);
      moved = std::max(moved, std::abs(wanted - s[a]) * std::sqrt(H(a, a)));
      s[a] = wanted;
    }
    if (moved < 1e-9 * std::sqrt(std::max(1e-300, g.cwiseAbs().maxCoeff()))) break;
  }
  return s;
}

std::vector<Sensitivities> sensitivities_at(SimulationBag& bag, const Eigen::VectorXd& u, const Predictions& at_u,
                                            const std::vector<int>& free, Context& context, const std::string& stage) {
  const std::vector<Eigen::VectorXd> points = probe_points(bag.model(), u, free);
  return sensitivities_from(bag.model(), u, at_u, free, points, bag.run(points, context, stage));
}

ParameterFit fit_parameters(SimulationBag& bag, const FitObjective& objective, const std::vector<int>& free,
                            const Eigen::VectorXd& start, std::vector<Sensitivities> known, const FitOptions& options,
                            Context& context, const std::string& stage) {
  StepwiseFit fit(bag.model(), objective, free, {start}, std::move(known), options);
  run_side_by_side(bag, {&fit, 1}, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
                   context, stage);
  return fit.fit();
}

}  // namespace formwright
