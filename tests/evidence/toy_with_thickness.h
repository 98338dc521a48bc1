// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <random>

#include "evidence/toy_model.h"

namespace formwright::evidence_test {

/// The toy, and its drift measured once more at places of its own.
class ToyWithThickness : public ToyModel {
 public:
  ToyWithThickness(int points, int readings, unsigned seed = 1) : ToyModel(points, seed) {
    Measurement m = ToyModel::measurements().front();
    m.name = "toy, thickness";
    m.places_index = 0;
    m.scale = 4;
    m.place.conservativeResize(readings, 2);
    m.measured.setZero(readings, 1);
    m.sigma.setConstant(readings, 4 * 0.01);
    measurements_ = {ToyModel::measurements().front(), m};
  }
  const std::vector<Measurement>& measurements() const override { return measurements_; }
  Eigen::MatrixXd predict(int m, const Eigen::VectorXd& u, const Context& context) const override {
    if (m == 0) return ToyModel::predict(0, u, context);
    const Measurement& own = measurements_[1];
    return own.scale * (1 - 0.1 * u[4] * own.place.col(0).array() + 0.02 * u[0] * own.place.col(1).array()).matrix();
  }
  /// `sigma`: of the points; readings of the thickness have 0.01.
  void measure_all(const Eigen::VectorXd& u, double sigma, unsigned seed) {
    measure(u, sigma, seed);
    measurements_[0] = ToyModel::measurements().front();
    std::mt19937 random(seed + 100);
    std::normal_distribution<double> noise(0, 1);
    measurements_[1].measured = predict(1, u, Context());
    for (double& value : measurements_[1].measured.reshaped()) value += 0.04 * noise(random);
  }

 private:
  std::vector<Measurement> measurements_;
};

}  // namespace formwright::evidence_test
