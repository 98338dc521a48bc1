// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A forward model in closed form: fields over the unit square, linear in most parameters, on which every answer is
// known.
#include <cmath>
#include <numbers>
#include <random>

#include "evidence/fit/forward_model.h"

namespace formwright::evidence_test {

/// Base: height (logarithmic) and tilt. Causes: bump, ripple (one-sided), drift (two parameters), and `twin`, which
/// does nearly what bump does.
class ToyModel : public ForwardModel {
 public:
  explicit ToyModel(int points = 500, unsigned seed = 1, bool with_twin = false) {
    const auto add = [&](const char* name, ParameterRole role, double nominal, double low, double high,
                         bool logarithmic, double sd, double probe) {
      ModelParameter p;
      p.name = p.label = name;
      p.role = role;
      p.nominal = nominal;
      p.low = low;
      p.high = high;
      p.logarithmic = logarithmic;
      p.prior_sd = sd;
      p.probe = probe;
      parameters_.push_back(p);
    };
    add("height", ParameterRole::base, 10, 1, 100, true, 0.5, 0.1);
    add("tilt", ParameterRole::base, 0, -5, 5, false, 1, 0.2);
    add("bump", ParameterRole::effect, 0, -3, 3, false, 1, 0.3);
    add("ripple", ParameterRole::effect, 0, 0, 3, false, 1, 0.3);
    add("drift_x", ParameterRole::effect, 0, -3, 3, false, 1, 0.3);
    add("drift_y", ParameterRole::effect, 0, -3, 3, false, 1, 0.3);
    causes_ = {{"bump", "Bump", "", "", {2}, "mm"},
               {"ripple", "Ripple", "", "", {3}, "mm"},
               {"drift", "Drift", "", "", {4, 5}, "mm"}};
    if (with_twin) {
      add("twin", ParameterRole::effect, 0, -3, 3, false, 1, 0.3);
      causes_.push_back({"twin", "Twin", "", "", {6}, "mm"});
    }
    Measurement m;
    m.name = "toy";
    m.extent_mm = 100;
    m.place.resize(points, 2);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (Eigen::Index i = 0; i < points; ++i) m.place.row(i) << uniform(random), uniform(random);
    m.measured.setZero(points, 2);
    m.sigma.setConstant(points, 0.05);
    measurements_ = {m};
  }

  const std::vector<ModelParameter>& parameters() const override { return parameters_; }
  const std::vector<Cause>& causes() const override { return causes_; }
  const std::vector<Measurement>& measurements() const override { return measurements_; }
  double known_misfit() const override { return 0.03; }
  double max_misfit_left() const override { return max_misfit_left_; }
  Eigen::MatrixXd predict(int, const Eigen::VectorXd& u, const Context&) const override {
    const Measurement& m = measurements_.front();
    Eigen::MatrixXd y(m.place.rows(), 2);
    const double height = parameters_[0].value(u[0]);
    for (Eigen::Index i = 0; i < y.rows(); ++i) {
      const double x = m.place(i, 0), z = m.place(i, 1);
      const double bump = std::exp(-20 * ((x - 0.5) * (x - 0.5) + (z - 0.5) * (z - 0.5)));
      y(i, 0) = height * std::sin(std::numbers::pi * x) / 10 + u[1] * z + u[2] * bump + u[4] * x * x;
      y(i, 1) = height * x * z / 20 + u[3] * std::cos(3 * std::numbers::pi * z) + u[5] * z * z;
      if (u.size() > 6) y(i, 0) += u[6] * (bump + 0.02 * x);
    }
    return y;
  }

  /// Measures the model itself at u, with noise.
  void measure(const Eigen::VectorXd& u, double sigma, unsigned seed, double outlier_share = 0) {
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(0, 1);
    std::uniform_real_distribution<double> uniform(0, 1);
    Measurement& m = measurements_.front();
    m.measured = predict(0, u, Context());
    m.sigma.setConstant(sigma);
    for (Eigen::Index i = 0; i < m.measured.rows(); ++i) {
      const bool outlier = uniform(random) < outlier_share;
      for (int k = 0; k < 2; ++k) m.measured(i, k) += (outlier ? 3.0 : sigma) * noise(random);
    }
  }
  Measurement& measurement() { return measurements_.front(); }
  /// So much of every effect there may be though nothing is wrong.
  void set_usual_sd(double usual_sd) {
    for (ModelParameter& p : parameters_)
      if (p.role == ParameterRole::effect) p.usual_sd = usual_sd;
  }
  void set_max_misfit_left(double max_misfit_left) { max_misfit_left_ = max_misfit_left; }
  /// The height was measured before.
  void set_measured_height(double prior_sd) {
    parameters_.front().prior_sd = prior_sd;
    parameters_.front().was_measured = true;
  }
  void set_gain_error(double share) {
    for (Cause& cause : causes_) cause.gain_error = share;
  }

 private:
  double max_misfit_left_ = 0.018;
  std::vector<ModelParameter> parameters_;
  std::vector<Cause> causes_;
  std::vector<Measurement> measurements_;
};

}  // namespace formwright::evidence_test
