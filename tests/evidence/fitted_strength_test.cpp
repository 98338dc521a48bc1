// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/explanations/fitted_strength.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "evidence/diagnosis/diagnosis.h"
#include "evidence/toy_with_thickness.h"

namespace formwright {
namespace {

using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;
using evidence_test::ToyModel;
using evidence_test::ToyWithThickness;

constexpr int drift = 2;

ToyModel few_points(int points, double strength, unsigned seed) {
  ToyModel model(points, seed);
  Eigen::VectorXd u = model.nominal();
  u[4] = strength;
  model.measure(u, 0.05, seed);
  return model;
}

TEST_CASE("FittedStrength.NoiseIsCountedOnce") {
  CHECK(beyond_noise(0.5, 0.5) == 0);
  CHECK(beyond_noise(0.3, 0.5) == 0);
  CHECK_THAT(beyond_noise(0.5, 0.3), WithinAbs(0.16, 1e-12));
  CHECK_THAT(beyond_noise(0.5, 0), WithinAbs(0.25, 1e-12));
}

TEST_CASE("FittedStrength.NoiseAloneIsThePosteriorOfTheLinearModel") {
  const ToyModel model = few_points(20, 1, 1);
  SimulationBag bag(model);
  Context context;
  Explanations tried(bag, false, context);
  tried.calibrate();
  tried.screen();
  tried.refit();
  const FittedStrength found = fitted_strength(model, tried, {drift}, drift, 0.03);
  const ParameterFit& fit = tried.refit_of({drift}).fit;
  const auto k = static_cast<Eigen::Index>(fit.free.size());
  Eigen::MatrixXd H(k, k);
  for (Eigen::Index a = 0; a < k; ++a)
    for (Eigen::Index b = 0; b < k; ++b) {
      const Eigen::MatrixXd &x = fit.sensitivities[0][static_cast<std::size_t>(a)],
                            &y = fit.sensitivities[0][static_cast<std::size_t>(b)];
      H(a, b) =
          a == b ? std::pow(
                       model.parameters()[static_cast<std::size_t>(fit.free[static_cast<std::size_t>(a)])].prior_sd, -2)
                 : 0.0;
      for (Eigen::Index i = 0; i < x.rows(); ++i)
        H(a, b) += x.row(i) * tried.precisions()[0].row(i).reshaped(2, 2) * y.row(i).transpose();
    }
  Eigen::VectorXd along = Eigen::VectorXd::Zero(k);
  for (Eigen::Index a = 0; a < k; ++a)
    for (int i = 0; i < 2; ++i)
      if (fit.free[static_cast<std::size_t>(a)] == 4 + i)
        along[a] = found.values[static_cast<std::size_t>(i)] / found.strength;
  CHECK_THAT(found.noise_deviation, WithinRel(std::sqrt(along.dot(H.llt().solve(along))), 1e-6));
  CHECK(found.deviation > found.noise_deviation);
  CHECK_THAT(found.strength, WithinAbs(1, 4 * found.deviation));
}

/// Of 40 objects with the drift at `strength`: named, intervals that hold, wrong names without doubt.
struct Count {
  int named = 0, held = 0, wrong = 0;
};
template <class Make>
Count count(double strength, Make&& make) {
  Count result;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    const auto model = make(seed);
    SimulationBag bag(model);
    Context context;
    const Diagnosis d = diagnose(bag, {}, context);
    if (d.reading != Reading::cause && d.reading != Reading::cannot_separate) continue;
    const bool right = std::find(d.verdict.begin(), d.verdict.end(), drift) != d.verdict.end();
    result.named += right;
    result.wrong += !right && !d.doubtful();
    for (const CauseFinding& finding : d.causes)
      if (right && finding.cause == drift) result.held += finding.low <= strength && strength <= finding.high;
  }
  return result;
}

TEST_CASE("FittedStrength.FewPointsNameWhatTheyShowAndTheirIntervalsHold") {
  const Count points = count(0.6, [](unsigned seed) { return few_points(14, 0.6, seed); });
  INFO("points: named " << points.named << ", intervals that hold " << points.held << ", wrong " << points.wrong);
  CHECK(points.named >= 34);
  CHECK(points.held >= static_cast<int>(0.9 * points.named));
  CHECK(points.wrong == 0);
  // Eight readings of another quantity show what the points, which are measured worse, do not.
  const Count readings = count(0.7, [](unsigned seed) {
    ToyWithThickness model(14, 8, seed);
    Eigen::VectorXd u = model.nominal();
    u[4] = 0.7;
    model.measure_all(u, 0.4, seed);
    return model;
  });
  INFO("readings: named " << readings.named << ", intervals that hold " << readings.held << ", wrong "
                          << readings.wrong);
  CHECK(readings.named >= 14);
  CHECK(readings.held >= static_cast<int>(0.9 * readings.named));
  CHECK(readings.wrong == 0);
}

}  // namespace
}  // namespace formwright
