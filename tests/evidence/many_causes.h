// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Eight causes in closed form, each a smooth field over the unit square, beside two base parameters. Linear, unless
// `bend` lets the first cause carry the fields of the others along with it.
#include <cmath>
#include <numbers>
#include <random>

#include "evidence/forward_model.h"

namespace formwright::evidence_test {

class ManyCauses : public ForwardModel {
 public:
  static constexpr int cause_count = 8;

  ManyCauses(int points, unsigned seed, double bend = 0) : bend_(bend) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (int p = 0; p < 2 + cause_count; ++p) {
      ModelParameter parameter;
      parameter.name = parameter.label = "p" + std::to_string(p);
      parameter.role = p < 2 ? ParameterRole::base : ParameterRole::effect;
      parameter.low = -5;
      parameter.high = 5;
      parameter.probe = 0.2;
      parameters_.push_back(parameter);
      if (p >= 2) causes_.push_back({parameter.name, parameter.name, "", "", {p}, "mm"});
      wave_.push_back({3 * uniform(random), 3 * uniform(random), 2 * std::numbers::pi * uniform(random)});
    }
    Measurement m;
    m.name = "many";
    m.extent_mm = 100;
    m.place.resize(points, 2);
    for (Eigen::Index i = 0; i < points; ++i) m.place.row(i) << uniform(random), uniform(random);
    m.measured.setZero(points, 1);
    m.sigma.setConstant(points, 0.05);
    measurements_ = {m};
  }

  const std::vector<ModelParameter>& parameters() const override { return parameters_; }
  const std::vector<Cause>& causes() const override { return causes_; }
  const std::vector<Measurement>& measurements() const override { return measurements_; }
  double known_misfit() const override { return 0.03; }
  Eigen::MatrixXd predict(int, const Eigen::VectorXd& u, const Context&) const override {
    const Eigen::MatrixX2d& place = measurements_.front().place;
    Eigen::MatrixXd y = Eigen::MatrixXd::Zero(place.rows(), 1);
    for (Eigen::Index p = 0; p < u.size(); ++p) {
      const Wave& w = wave_[static_cast<std::size_t>(p)];
      const double phase = w.phase + (p > 2 ? bend_ * u[2] : 0);
      for (Eigen::Index i = 0; i < y.rows(); ++i)
        y(i, 0) += u[p] * std::cos(std::numbers::pi * (w.x * place(i, 0) + w.z * place(i, 1)) + phase);
    }
    return y;
  }

  /// Measures the model itself at u, with noise of 0.05.
  void measure(const Eigen::VectorXd& u, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(0, 0.05);
    Measurement& m = measurements_.front();
    m.measured = predict(0, u, Context());
    for (Eigen::Index i = 0; i < m.measured.rows(); ++i) m.measured(i, 0) += noise(random);
  }

 private:
  struct Wave {
    double x, z, phase;
  };
  double bend_;
  std::vector<ModelParameter> parameters_;
  std::vector<Cause> causes_;
  std::vector<Measurement> measurements_;
  std::vector<Wave> wave_;
};

}  // namespace formwright::evidence_test
