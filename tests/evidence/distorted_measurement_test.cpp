// SPDX-License-Identifier: GPL-3.0-or-later
// A scanner out of order in a way that no cause of the list has.
#include "evidence/explanations/distorted_measurement.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <algorithm>
#include <cmath>
#include <random>

#include "evidence/diagnosed.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;
using evidence_test::diagnosed;

constexpr int stretch = 0, dent = 1;

/// A dome 200 mm wide. One cause stretches it from side to side, and by up to `bend` more towards one end; the other is
/// a dent.
class ScannedDome : public ForwardModel {
 public:
  explicit ScannedDome(double bend) : bend_(bend) {
    const auto add = [&](const char* name, ParameterRole role, double sd, double probe) {
      ModelParameter p;
      p.name = p.label = name;
      p.role = role;
      p.low = -20;
      p.high = 20;
      p.prior_sd = sd;
      p.probe = probe;
      parameters_.push_back(p);
    };
    add("height_mm", ParameterRole::base, 5, 1);
    add("stretch", ParameterRole::effect, 0.012, 0.005);
    add("dent_mm", ParameterRole::effect, 2, 0.5);
    causes_ = {{"stretch", "Stretch", "", "", {1}, ""}, {"dent", "Dent", "", "", {2}, "mm"}};
    Measurement m;
    m.extent_mm = 200;
    m.place.resize(600, 2);
    std::mt19937 random(5);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (double& value : m.place.reshaped()) value = uniform(random);
    m.measured.setZero(600, 3);
    m.sigma.setConstant(600, 0.05);
    measurements_ = {m};
  }
  const std::vector<ModelParameter>& parameters() const override { return parameters_; }
  const std::vector<Cause>& causes() const override { return causes_; }
  const std::vector<Measurement>& measurements() const override { return measurements_; }
  double known_misfit() const override { return 0.03; }
  Eigen::MatrixXd predict(int, const Eigen::VectorXd& u, const Context&) const override {
    const auto place = measurements_.front().place.array();
    const Eigen::ArrayXd x = 200 * (place.col(0) - 0.5), y = 200 * (place.col(1) - 0.5);
    const Eigen::ArrayXd r_squared = (x * x + y * y) / 1e4;
    Eigen::MatrixXd points(place.rows(), 3);
    points.col(0) = x + u[1] * x * (1 + bend_ * y / 100);
    points.col(1) = y;
    points.col(2) = (40 + u[0]) * (1 - r_squared) - u[2] * (-20 * r_squared).exp();
    return points;
  }
  /// A scan of `true_points`.
  void scan(const Eigen::MatrixXd& true_points) {
    std::mt19937 random(7);
    std::normal_distribution<double> noise(0, 0.05);
    measurements_.front().measured = true_points;
    for (double& value : measurements_.front().measured.reshaped()) value += noise(random);
  }
  Eigen::MatrixXd formed(double stretched, double dent_mm) const {
    return predict(0, Eigen::Vector3d(0, stretched, dent_mm), Context());
  }

 private:
  double bend_;
  std::vector<ModelParameter> parameters_;
  std::vector<Cause> causes_;
  std::vector<Measurement> measurements_;
};

DistortedMeasurement distortion_in(const ForwardModel& model) {
  LinearModel about{{model.predict(0, model.nominal(), Context())}, {Sensitivities(3)}, model.nominal()};
  for (Eigen::Index p = 0; p < 3; ++p) {
    Eigen::VectorXd u = model.nominal();
    u[p] = 1;
    about.sensitivities[0][static_cast<std::size_t>(p)] = model.predict(0, u, Context()) - about.predictions[0];
  }
  const MisfitOfAll misfit(model, {isotropic(Eigen::VectorXd::Constant(600, 1 / (0.05 * 0.05)), 3)});
  return *distorted_measurement(model, misfit, {about}, 1);
}

TEST_CASE("DistortedMeasurement.IsLikeWhatStretchesAndUnlikeADent") {
  ScannedDome straight(0);
  straight.scan(straight.formed(0.01, 0));
  const DistortedMeasurement found = distortion_in(straight);
  REQUIRE(found.similarity.size() == 2);
  CHECK_THAT(found.similarity[stretch], WithinAbs(1, 1e-5));
  CHECK(found.similarity[dent] < 0.7);
  ScannedDome bent(1);
  bent.scan(bent.formed(0.01, 0));
  CHECK(distortion_in(bent).similarity[stretch] < 0.95);
}

TEST_CASE("DistortedMeasurement.ItsEvidenceIsThatOfTwelveNumbers") {
  ScannedDome model(0);
  const Eigen::MatrixXd formed = model.formed(0, 0);
  model.scan(formed);
  const double clean = distortion_in(model).log_evidence;
  Eigen::MatrixXd skewed = formed;
  skewed.col(0) += 0.01 * formed.col(1) + Eigen::VectorXd::Constant(600, 0.3);
  model.scan(skewed);
  // The map fits both alike: they differ by how likely its numbers are beforehand.
  CHECK_THAT(distortion_in(model).log_evidence, WithinAbs(clean, 3));
}

TEST_CASE("DistortedMeasurement.WhatIsNotMeasuredInSpaceHasNone") {
  const evidence_test::ToyModel model(50);
  const MisfitOfAll misfit(model, {isotropic(Eigen::VectorXd::Ones(50), 2)});
  CHECK_FALSE(distorted_measurement(model, misfit, {}, 1));
}

constexpr const char* another_scan =
    "A scan that is stretched, skewed or turned in some other way would look nearly the same.";

TEST_CASE("DistortedMeasurement.WhereAScannerDoesNearlyTheSameItIsADoubt") {
  ScannedDome model(0.15);
  const auto is_doubted = [&](const Eigen::MatrixXd& points) {
    model.scan(points);
    const Diagnosis d = diagnosed(model);
    REQUIRE(d.verdict == std::vector<int>{stretch});
    return std::find(d.doubts.begin(), d.doubts.end(), another_scan) != d.doubts.end();
  };
  CHECK_FALSE(is_doubted(model.formed(0.012, 0)));
  // A scan that is stretched alike everywhere.
  Eigen::MatrixXd stretched = model.formed(0, 0);
  stretched.col(0) *= 1.012;
  CHECK(is_doubted(stretched));
}

}  // namespace
}  // namespace formwright
