// SPDX-License-Identifier: GPL-3.0-or-later
// Fitting a model's parameters, and the calibration that a diagnosis begins with.
#include "evidence/fit/parameter_fit.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <Eigen/Dense>
#include <atomic>

#include "base/error.h"
#include "evidence/calibration.h"
#include "evidence/toy_model.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

using evidence_test::ToyModel;

TEST_CASE("BoundedStep.IsThatOfTheLinearSystemInsideAndClampsOutside") {
  Eigen::Matrix3d H;
  H << 4, 1, 0.5, 1, 3, 0.2, 0.5, 0.2, 2;
  const Eigen::Vector3d g(1, -2, 0.5), wide = Eigen::Vector3d::Constant(10);
  CHECK((bounded_step(H, g, -wide, wide) + H.ldlt().solve(g)).norm() < 1e-8);
  const Eigen::Vector3d low(-0.1, -0.1, -0.1), high(0.1, 0.1, 0.1);
  const Eigen::Vector3d s = bounded_step(H, g, low, high);
  // Karush, Kuhn and Tucker: the gradient points out of the box where the step is at its side.
  const Eigen::Vector3d gradient = H * s + g;
  for (int i = 0; i < 3; ++i) {
    CHECK(std::abs(s[i]) <= 0.1 + 1e-12);
    const bool inside = s[i] > -0.1 + 1e-9 && s[i] < 0.1 - 1e-9;
    CHECK((inside ? std::abs(gradient[i]) : gradient[i] * s[i]) <= 1e-6);
  }
}

TEST_CASE("ParameterFit.RecoversBaseParametersDespiteOutliers") {
  ToyModel model(600);
  Eigen::VectorXd truth = model.nominal();
  truth[0] = 0.4;
  truth[1] = -0.7;
  model.measure(truth, 0.02, 7, 0.05);
  SimulationBag bag(model);
  Context context;
  const ParameterFit fit = fit_parameters(
      bag, {mean_distance_objective(model, 0.02), model.base_parameters(), {model.nominal()}}, context, "");
  CHECK_THAT(fit.u[0], WithinAbs(0.4, 0.01));
  CHECK_THAT(fit.u[1], WithinAbs(-0.7, 0.01));
  CHECK(bag.simulations() < 40);
}

TEST_CASE("ParameterFit.StaysWithinRanges") {
  ToyModel model(200);
  Eigen::VectorXd truth = model.nominal();
  truth[1] = 5;
  model.measure(truth, 0.01, 1);
  model.measurement().measured.col(0) += 3 * model.measurements().front().place.col(1);  // as of a tilt of 8
  SimulationBag bag(model);
  Context context;
  FitOptions options;
  options.max_iterations = 60;
  const ParameterFit fit = fit_parameters(
      bag, {mean_distance_objective(model, 0.01), model.base_parameters(), {model.nominal()}, {}, options}, context,
      "");
  CHECK_THAT(fit.u[1], WithinAbs(5, 1e-6));
}

/// Base parameters of a toy that was measured at (0.4, -0.7), from `start` of both.
FitProblem toy_problem(const ToyModel& model, double start) {
  Eigen::VectorXd u = model.nominal();
  u.head(2).setConstant(start);
  return {mean_distance_objective(model, 0.02), model.base_parameters(), {u}};
}

ToyModel measured_toy() {
  ToyModel model(300);
  Eigen::VectorXd truth = model.nominal();
  truth.head(2) << 0.4, -0.7;
  model.measure(truth, 0.02, 7, 0.05);
  return model;
}

TEST_CASE("ParameterFit.IsTheSameInCompany") {
  const ToyModel model = measured_toy();
  Context context;
  SimulationBag together(model);
  std::vector<FitInProgress> fits;
  for (const double start : {0.0, 1.0, -0.5}) fits.emplace_back(model, toy_problem(model, start));
  run_fits({&together}, fits, context, "");
  for (std::size_t i = 0; i < fits.size(); ++i) {
    SimulationBag bag(model);
    const ParameterFit alone = fit_parameters(bag, toy_problem(model, std::vector{0.0, 1.0, -0.5}[i]), context, "");
    CHECK(fits[i].fit().u == alone.u);
    CHECK(fits[i].fit().value == alone.value);
    CHECK(fits[i].fit().sensitivities.front() == alone.sensitivities.front());
    CHECK_THAT(alone.u[0], WithinAbs(0.4, 0.01));
  }
}

TEST_CASE("ParameterFit.WhatIsHopelessStopsWhereItStands") {
  const ToyModel model = measured_toy();
  Context context;
  SimulationBag bag(model);
  std::vector<FitInProgress> fits;
  for (const double start : {0.4, -1.0}) fits.emplace_back(model, toy_problem(model, start));
  run_fits({&bag}, fits, context, "",
           [&](const FitInProgress& fit) { return &fit == &fits[1] && fit.iterations() > 1; });
  CHECK_THAT(fits[0].fit().u[0], WithinAbs(0.4, 0.01));
  CHECK(fits[1].iterations() == 2);
  const double at_start = mean_distance_objective(model, 0.02)
                              ->value(residuals(model, *bag.run(toy_problem(model, -1).starts.front(), context, "")),
                                      toy_problem(model, -1).starts.front());
  CHECK(fits[1].fit().value < at_start);
  CHECK(fits[1].fit().value > 2 * fits[0].fit().value);
}

ToyModel tilted_toy() {
  ToyModel model(300);
  Eigen::VectorXd truth = model.nominal();
  truth[1] = 0.5;
  model.measure(truth, 0.02, 3);
  return model;
}

/// A straight line has no more to it than its slope: one step, and one that finds nothing.
TEST_CASE("ParameterFit.GoesStraightToTheEndOfALine") {
  const ToyModel model = tilted_toy();
  SimulationBag bag(model);
  Context context;
  const std::vector<Sensitivities> slope =
      sensitivities_at(bag, model.nominal(), *bag.run(model.nominal(), context, ""), {1}, context, "");
  const int before = bag.simulations();
  FitProblem problem{mean_distance_objective(model, 0.02), {1}, {model.nominal()}, slope, quick_fit};
  const ParameterFit fit = fit_parameters(bag, problem, context, "");
  CHECK_THAT(fit.u[1], WithinAbs(0.5, 0.01));
  CHECK(bag.simulations() <= before + 3);
}

TEST_CASE("ParameterFit.TakesWrongSensitivitiesAfreshIfItMay") {
  const ToyModel model = tilted_toy();
  SimulationBag bag(model);
  Context context;
  std::vector<Sensitivities> wrong =
      sensitivities_at(bag, model.nominal(), *bag.run(model.nominal(), context, ""), {1}, context, "");
  wrong.front().front() *= -1;
  FitProblem problem{mean_distance_objective(model, 0.02), {1}, {model.nominal()}, wrong, {8, 0.01, true}};
  CHECK_THAT(fit_parameters(bag, problem, context, "").u[1], WithinAbs(0.5, 0.01));
}

TEST_CASE("ParameterFit.WithNothingFreeStaysWhereItIs") {
  const ToyModel model = measured_toy();
  SimulationBag bag(model);
  Context context;
  FitProblem problem = toy_problem(model, 0.3);
  problem.free.clear();
  const ParameterFit fit = fit_parameters(bag, problem, context, "");
  CHECK(fit.u == problem.starts.front());
  CHECK(fit.predictions.size() == 1);
  CHECK(fit.value > 0);
}

/// Has answers below a tilt of `max_tilt` only.
class ToyWithAnEdge : public ToyModel {
 public:
  explicit ToyWithAnEdge(double max_tilt) : ToyModel(300), max_tilt_(max_tilt) {}
  Eigen::MatrixXd predict(int object, const Eigen::VectorXd& u, const Context& context) const override {
    if (u[1] > max_tilt_) throw Error(ErrorCode::could_not_solve, "", "Too steep.");
    return ToyModel::predict(object, u, context);
  }

 private:
  double max_tilt_;
};

TEST_CASE("ParameterFit.BeginsWhereThereIsAnAnswerOrSaysThatThereIsNone") {
  ToyWithAnEdge model(0.5);
  Eigen::VectorXd truth = model.nominal();
  truth.head(2) << 0.2, -0.3;
  model.measure(truth, 0.02, 5);
  SimulationBag bag(model);
  Context context;
  FitProblem problem = toy_problem(model, 1);
  CHECK_THROWS_AS(fit_parameters(bag, problem, context, ""), Error);
  problem.starts.push_back(model.nominal());
  CHECK_THAT(fit_parameters(bag, problem, context, "").u[1], WithinAbs(-0.3, 0.01));
}

/// One that has an answer at its start and none beside it ends, and leaves the others alone.
TEST_CASE("ParameterFit.OneThatCannotGoOnLeavesTheOthers") {
  class OnePlace : public ToyModel {
   public:
    OnePlace() : ToyModel(300) {}
    Eigen::MatrixXd predict(int object, const Eigen::VectorXd& u, const Context& context) const override {
      if (u[1] != 0) throw Error(ErrorCode::could_not_solve, "", "Too steep.");
      return ToyModel::predict(object, u, context);
    }
  };
  const ToyModel whole = measured_toy();
  const OnePlace one;
  SimulationBag whole_bag(whole), one_bag(one);
  Context context;
  std::vector<FitInProgress> fits;
  fits.emplace_back(one, toy_problem(one, 0));
  fits.emplace_back(whole, toy_problem(whole, 0));
  run_fits({&one_bag, &whole_bag}, fits, context, "");
  CHECK_FALSE(fits[0].has_answer());
  CHECK(fits[0].why_not().has_value());
  CHECK_THAT(fits[1].fit().u[0], WithinAbs(0.4, 0.01));
}

TEST_CASE("ParameterFit.ProbingSaysHowFarSecantsMiss") {
  ToyModel model(50);
  SimulationBag bag(model);
  Context context;
  const std::vector<int> columns{0, 1, 3};
  const Probing probing =
      probe_around(bag, model.nominal(), *bag.run(model.nominal(), context, ""), columns, context, "");
  REQUIRE(probing.bends.front().size() == 2u);  // the ripple goes one way only
  for (Eigen::Index i = 0; i < 50; ++i) {
    const auto place = model.measurements().front().place.row(i);
    // Height is e^u: half of e^h + e^-h - 2.
    CHECK_THAT(probing.bends.front()[0](i, 0),
               WithinAbs((std::cosh(0.1) - 1) * std::sin(std::numbers::pi * place[0]), 1e-12));
    CHECK_THAT(probing.bends.front()[0](i, 1), WithinAbs((std::cosh(0.1) - 1) * place[0] * place[1] / 2, 1e-12));
    CHECK_THAT(probing.sensitivities.front()[0](i, 0),
               WithinAbs(std::sinh(0.1) / 0.1 * std::sin(std::numbers::pi * place[0]), 1e-12));
  }
  CHECK(probing.bends.front()[1].cwiseAbs().maxCoeff() < 1e-12);  // the tilt is straight
}

TEST_CASE("SimulationBag.AsksForNothingTwiceAndStopsAtOnce") {
  ToyModel model(50);
  SimulationBag bag(model);
  Context context;
  const Eigen::VectorXd u = model.nominal();
  bag.run({u, u, u}, context, "");
  CHECK(bag.simulations() == 1);
  bag.run(u, context, "");
  CHECK(bag.simulations() == 1);
  Context cancelled(Host{{}, [] { return true; }});
  Eigen::VectorXd other = u;
  other[0] = 0.1;
  CHECK_THROWS_AS(bag.run(other, cancelled, ""), Error);
  CHECK(bag.run(other, context, "").has_value());
}

TEST_CASE("Calibration.IntervalsHoldTheTruthAndSayWhatIsNotDistinguishable") {
  int inside = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    ToyModel model(300, seed);
    Eigen::VectorXd truth = model.nominal();
    truth[0] = 0.2;
    truth[1] = 0.5;
    model.measure(truth, 0.1, 100 + seed);
    SimulationBag bag(model);
    Context context;
    const Calibration c = calibrate(bag, context);
    REQUIRE(c.profiles.size() == 2u);
    CHECK(c.error < c.error_nominal);
    CHECK(c.profiles[1].identified);
    inside += c.profiles[1].low <= 0.5 && 0.5 <= c.profiles[1].high;
  }
  CHECK(inside >= 16);  // of 20 at 95 %; the structure term only widens
  // All points at z = 0: nothing is known of the tilt.
  ToyModel blind(300);
  blind.measurement().place.col(1).setZero();
  blind.measure(blind.nominal(), 0.05, 4);
  SimulationBag bag(blind);
  Context context;
  const Calibration c = calibrate(bag, context);
  CHECK_FALSE(c.profiles[1].identified);
}

TEST_CASE("Calibration.FitIsNoWorseThanTheGrid") {
  ToyModel model(300);
  Eigen::VectorXd truth = model.nominal();
  truth[0] = 0.33;
  truth[1] = 0.41;
  model.measure(truth, 0.05, 9, 0.02);
  SimulationBag bag(model), grid_bag(model);
  Context context;
  const Calibration fit = calibrate(bag, context);
  const Calibration grid = grid_search(grid_bag, {{0, 5, 20}, {1, -2, 2}}, 5, {}, 0, context);
  CHECK(grid.simulations == 26);  // 25 of the grid and the nominal one, which is none of them
  CHECK(fit.error <= grid.error + 1e-9);
}

TEST_CASE("SimulationBag.WhatIsMadeAheadCountsOnceItIsAskedFor") {
  const ToyModel model(50);
  SimulationBag bag(model);
  Context context;
  const Eigen::VectorXd wanted = model.nominal(), later = Eigen::VectorXd::Constant(wanted.size(), 0.1);
  SimulationBag::run_together({&bag}, {{wanted}}, context, "", {{later}});
  CHECK(bag.simulations() == 1);
  CHECK(bag.run(later, context, "")->front() == model.predict(0, later, context));
  CHECK(bag.simulations() == 2);
  bag.run(later, context, "");
  CHECK(bag.simulations() == 2);
}

}  // namespace
}  // namespace formwright
