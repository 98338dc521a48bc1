// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "evidence/fit/forward_model.h"

namespace formwright::evidence_test {

/// y = u + noise, measured at one place of which nothing else is known.
class OneCause : public ForwardModel {
 public:
  explicit OneCause(int points, double sigma = 0.1) {
    ModelParameter p;
    p.name = "shift";
    p.role = ParameterRole::effect;
    p.low = -10;
    p.high = 10;
    p.prior_sd = 2;
    parameters_ = {p};
    causes_ = {{"shift", "Shift", "", "", {0}, "mm"}};
    Measurement m;
    m.place = Eigen::MatrixX2d::Constant(points, 2, 0.5);
    m.measured.setZero(points, 1);
    m.sigma.setConstant(points, sigma);
    measurements_ = {m};
  }
  const std::vector<ModelParameter>& parameters() const override { return parameters_; }
  const std::vector<Cause>& causes() const override { return causes_; }
  const std::vector<Measurement>& measurements() const override { return measurements_; }
  double known_misfit() const override { return 0; }
  Eigen::MatrixXd predict(int, const Eigen::VectorXd& u, const Context&) const override {
    return Eigen::MatrixXd::Constant(measurements_.front().place.rows(), 1, u[0]);
  }

 protected:
  std::vector<Measurement> measurements_;

 private:
  std::vector<ModelParameter> parameters_;
  std::vector<Cause> causes_;
};

}  // namespace formwright::evidence_test
