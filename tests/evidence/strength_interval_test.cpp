// SPDX-License-Identifier: GPL-3.0-or-later
// Strengths on wide secants, and what equally good simulations make of their intervals.
#include "evidence/diagnosis/strength_interval.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <Eigen/Dense>
#include <bit>
#include <cmath>
#include <cstdint>
#include <random>

#include "evidence/diagnosed.h"
#include "evidence/explanations/wide_secants.h"
#include "evidence/toy_model.h"

namespace formwright {
namespace {

using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;
using evidence_test::diagnosed;
using evidence_test::ToyModel;

constexpr int the_bump = 0, bump_parameter = 2;
const std::vector<int> bump_alone{the_bump};

/// A sheet that sticks and snaps: with the least change of the bump every number leaps by up to `leap_mm`.
class LeapingToy : public ToyModel {
 public:
  LeapingToy(double leap_mm, unsigned seed) : ToyModel(1000), leap_mm_(leap_mm), seed_(seed) {}
  Eigen::MatrixXd predict(int object, const Eigen::VectorXd& u, const Context& context) const override {
    Eigen::MatrixXd y = ToyModel::predict(object, u, context);
    std::mt19937_64 random(std::bit_cast<std::uint64_t>(u[bump_parameter]) + seed_);
    for (double& value : y.reshaped())
      value += leap_mm_ * std::ldexp(static_cast<double>(random() >> 10) - 0x1p53, -53);
    return y;
  }

 private:
  double leap_mm_;
  unsigned seed_;
};

LeapingToy measured_with_a_bump(double leap_mm, unsigned seed) {
  LeapingToy model(leap_mm, seed);
  ToyModel smooth(1000);
  Eigen::VectorXd truth = smooth.nominal();
  truth[bump_parameter] = 1;
  smooth.measure(truth, 0.05, seed);
  model.measurement() = smooth.measurement();
  return model;
}

/// Means over some sheets.
struct BumpFound {
  double by_the_fit = 0, by_one_step = 0, by_a_diagnosis = 0;
};

BumpFound bump_found(double leap_mm) {
  constexpr unsigned sheets = 3;
  BumpFound mean;
  for (unsigned seed = 1; seed <= sheets; ++seed) {
    const LeapingToy model = measured_with_a_bump(leap_mm, seed);
    SimulationBag bag(model);
    Context context;
    Explanations tried(bag, false, context);
    tried.calibrate();
    tried.screen();
    tried.refit();
    mean.by_the_fit += tried.refit_of(bump_alone).fit.u[bump_parameter] / sheets;
    mean.by_one_step += (*step_on_wide_secants(bag, tried, bump_alone, {}, context))[bump_parameter] / sheets;
    DiagnosisOptions options;
    options.pairs = false;
    const Diagnosis d = diagnose(bag, options, context);
    REQUIRE(d.verdict == bump_alone);
    CHECK(d.causes.front().strength == d.extended.u[bump_parameter]);
    mean.by_a_diagnosis += d.causes.front().strength / sheets;
  }
  return mean;
}

TEST_CASE("WideSecants.AStepFromAFitThatIsRightIsNone") {
  const BumpFound found = bump_found(0);
  CHECK_THAT(found.by_the_fit, WithinAbs(1, 0.02));
  CHECK_THAT(found.by_one_step, WithinAbs(1, 0.01));
  CHECK_THAT(found.by_a_diagnosis, WithinAbs(1, 0.01));
}

TEST_CASE("WideSecants.WhereASheetLeapsTheStepGoesOnWhereAFitHasStopped") {
  const BumpFound found = bump_found(0.05);
  CAPTURE(found.by_the_fit, found.by_one_step, found.by_a_diagnosis);
  CHECK(found.by_the_fit < 0.85);
  for (const double refined : {found.by_one_step, found.by_a_diagnosis}) {
    CHECK(refined < 1.02);
    CHECK(1 - refined < 0.75 * (1 - found.by_the_fit));
  }
}

TEST_CASE("StrengthInterval.AFactorIsAlongTheCauseAndLimited") {
  const ToyModel model(10);
  constexpr int drift = 2;
  Eigen::VectorXd from = model.nominal(), u = from;
  CHECK(strength_factor(model, drift, from, u) == 1);
  from.tail(2) << 0.3, 0.4;
  u.tail(2) << 0.6, 0.8;
  CHECK_THAT(strength_factor(model, drift, from, u), WithinRel(2, 1e-12));
  u.tail(2) << 0.3 - 0.4, 0.4 + 0.3;  // what is across it does not count
  CHECK_THAT(strength_factor(model, drift, from, u), WithinRel(1, 1e-12));
  CHECK(strength_factor(model, drift, from, -from) == 0.1);
  CHECK(strength_factor(model, drift, from, 100 * from) == 10);
}

TEST_CASE("StrengthInterval.HoldsNothingImpossible") {
  const ToyModel model(10);
  CauseFinding finding;
  const auto kept = [&](int cause, std::vector<double> values, double strength) {
    finding.cause = cause;
    finding.values = std::move(values);
    finding.strength = strength;
    set_half_width(finding, 10);
    keep_in_range(model, finding);
    return std::pair(finding.low, finding.high);
  };
  CHECK(kept(0, {1}, 1) == std::pair(-3.0, 3.0));            // the bump's range
  CHECK(kept(1, {0.4}, 0.4) == std::pair(0.0, 3.0));         // a ripple is never negative
  CHECK(kept(2, {0.3, -0.4}, 0.5) == std::pair(0.0, 10.5));  // a length of two
  set_half_width(finding, 0.1);
  keep_in_range(model, finding);
  CHECK(finding.low == 0.4);
  CHECK(finding.high == 0.6);
}

/// One that an equally good simulation moves more with, by this share.
class BumpTwoWays : public ForwardModel {
 public:
  explicit BumpTwoWays(double more) : toy_(500), parameters_(toy_.parameters()), more_(more) {
    ModelParameter p;
    p.name = p.label = "other law";
    p.role = ParameterRole::discrepancy;
    p.high = p.probe = p.prior_sd = 1;
    parameters_.push_back(p);
  }
  const std::vector<ModelParameter>& parameters() const override { return parameters_; }
  const std::vector<Cause>& causes() const override { return toy_.causes(); }
  const std::vector<Measurement>& measurements() const override { return toy_.measurements(); }
  double known_misfit() const override { return toy_.known_misfit(); }
  double max_misfit_left() const override { return toy_.max_misfit_left(); }
  Eigen::MatrixXd predict(int object, const Eigen::VectorXd& u, const Context& context) const override {
    Eigen::VectorXd own = u.head(u.size() - 1);
    own[bump_parameter] *= 1 + more_ * u[u.size() - 1];
    return toy_.predict(object, own, context);
  }
  void measure(double strength) {
    Eigen::VectorXd truth = toy_.nominal();
    truth[bump_parameter] = strength;
    toy_.measure(truth, 0.05, 4);
  }

 private:
  ToyModel toy_;
  std::vector<ModelParameter> parameters_;
  double more_;
};

TEST_CASE("StrengthInterval.ReachesWhatAnEquallyGoodSimulationFinds") {
  for (const double strength : {1.0, -1.0}) {
    BumpTwoWays model(0.25);
    model.measure(strength);
    const Diagnosis d = diagnosed(model);
    REQUIRE(d.verdict == bump_alone);
    const CauseFinding& found = d.causes.front();
    CHECK_THAT(found.strength, WithinAbs(strength, 0.02));
    const double factor = std::exp(1.96 * std::log(1.25));
    const double nearer = strength > 0 ? found.low : found.high, farther = strength > 0 ? found.high : found.low;
    CHECK_THAT(farther, WithinAbs(strength * factor, 0.05));
    CHECK_THAT(nearer, WithinAbs(strength / factor, 0.05));
  }
}

TEST_CASE("StrengthInterval.BeyondTwiceTheStrengthItIsADoubt") {
  for (const double strength : {1.0, -1.0})
    for (const double more : {0.25, 0.5}) {
      BumpTwoWays model(more);
      model.measure(strength);
      const Diagnosis d = diagnosed(model);
      REQUIRE(d.verdict == bump_alone);
      CHECK(d.doubtful() == (std::pow(1 + more, 1.96) > 2));
    }
}

}  // namespace
}  // namespace formwright
