// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/planning/measuring_plan.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "evidence/planning/marks_drawing.h"
#include "evidence/planning/point_information.h"
#include "evidence/one_cause.h"
#include "evidence/toy_model.h"

namespace formwright {
namespace {

using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;
using evidence_test::OneCause;
using evidence_test::ToyModel;

std::vector<int> all_parameters(const ForwardModel& model) {
  std::vector<int> columns(model.parameters().size());
  std::iota(columns.begin(), columns.end(), 0);
  return columns;
}

struct Toy {
  explicit Toy(int points, double sigma = 0.05) : model(points) {
    Context context;
    SimulationBag bag(model);
    const auto at = bag.run(model.nominal(), context, "");
    sensitivities = sensitivities_at(bag, model.nominal(), *at, all_parameters(model), context, "").front();
    precisions = isotropic(Eigen::VectorXd::Constant(points, 1 / (sigma * sigma)), 2);
  }
  PointInformation information(double structure) const {
    return PointInformation(model, {sensitivities}, {precisions}, structure);
  }
  ToyModel model;
  Sensitivities sensitivities;
  Precisions precisions;
};

TEST_CASE("PointInformation.IsThatOfTheWholeSetInAnyOrder") {
  const Toy toy(40);
  for (const double structure : {0.0, 0.03, 0.3}) {
    const std::vector<Eigen::Index> rows{3, 17, 5, 29, 11};
    PointInformation forward = toy.information(structure), backward = toy.information(structure);
    for (const Eigen::Index row : rows) forward.measure(row);
    for (auto row = rows.rbegin(); row != rows.rend(); ++row) backward.measure(*row);
    // The same by another formula: the posterior of the whole set at once.
    Measurement part;
    part.place = toy.model.measurements().front().place(rows, Eigen::all);
    const StructuredMisfit misfit(part, toy.precisions(rows, Eigen::all), {structure});
    std::vector<Eigen::MatrixXd> columns;
    for (const Eigen::MatrixXd& column : toy.sensitivities) columns.emplace_back(column(rows, Eigen::all));
    const Eigen::Index k = static_cast<Eigen::Index>(columns.size());
    const Eigen::MatrixXd gram = misfit.gram_at(Eigen::MatrixXd::Zero(5, 2), columns, 0).bottomRightCorner(k, k);
    CHECK_THAT(forward.total(), WithinRel(information_about_causes(toy.model, gram), 1e-9));
    CHECK_THAT(backward.total(), WithinRel(forward.total(), 1e-9));
  }
}

TEST_CASE("PointInformation.OfRepeatedMeasurementsInClosedForm") {
  // log(1 + n prior^2 / sigma^2) / 2: from n = 1 on it grows by log(n) / 2, so twice the points add log(2) / 2.
  const OneCause model(64);
  const Sensitivities ones{Eigen::MatrixXd::Ones(64, 1)};
  PointInformation information(model, {ones}, {isotropic(Eigen::VectorXd::Constant(64, 100), 1)}, 0);
  double before = 0;
  for (int n = 1; n <= 64; ++n) {
    const double gain = information.gain(n - 1);
    information.measure(n - 1);
    CHECK_THAT(information.total(), WithinAbs(0.5 * std::log(1 + n * 4 * 100.0), 1e-9));
    CHECK_THAT(information.total() - before, WithinAbs(gain, 1e-12));
    before = information.total();
  }
}

TEST_CASE("PointInformation.NothingOfAPointThatCannotBeMeasured") {
  Toy toy(10);
  toy.precisions.row(4).setZero();
  PointInformation information = toy.information(0.03);
  CHECK(information.gain(4) == 0);
  information.measure(4);
  CHECK(information.total() == 0);
}

TEST_CASE("MeasuringPlan.TakesTheMostTellingPointsOneAfterTheOther") {
  const ToyModel model(60);
  SimulationBag bag(model);
  Context context;
  MeasuringPlanOptions options;
  options.points = 6;
  const MeasuringPlan plan = plan_measuring(bag, options, context);
  REQUIRE(plan.chosen.size() == 6);
  REQUIRE(plan.causes.size() == model.causes().size());
  for (std::size_t i = 0; i < 6; ++i) {
    const double before = i == 0 ? 0 : plan.information[i - 1];
    CHECK(plan.information[i] > before);
    // Each gain is at least 99 % of the best one, and the best ones do not grow.
    if (i > 1) CHECK(0.99 * (plan.information[i] - before) <= plan.information[i - 1] - plan.information[i - 2]);
  }
  CHECK(plan.information.back() < plan.information_of_all);
  // More than any of 200 sets of as many points drawn at random.
  for (unsigned seed = 1; seed <= 200; ++seed) {
    std::mt19937 random(seed);
    std::vector<Eigen::Index> rows(60);
    std::iota(rows.begin(), rows.end(), 0);
    std::shuffle(rows.begin(), rows.end(), random);
    ToyModel other(60);
    Measurement& m = other.measurement();
    const Eigen::MatrixX2d place = m.place;
    for (Eigen::Index i = 0; i < 60; ++i) m.place.row(i) = place.row(rows[static_cast<std::size_t>(i)]);
    SimulationBag own(other);
    MeasuringPlanOptions measured;
    measured.points = 0;
    measured.measured = 6;
    CHECK(plan_measuring(own, measured, context).information_of_measured <= plan.information.back() + 1e-9);
  }
}

TEST_CASE("MeasuringPlan.ContinuesWhereSomethingIsMeasured") {
  ToyModel model(40);
  SimulationBag bag(model);
  Context context;
  MeasuringPlanOptions options;
  options.points = 5;
  const MeasuringPlan whole = plan_measuring(bag, options, context);
  // The first two of them measured: the same points follow.
  std::vector<Eigen::Index> order{whole.chosen[0], whole.chosen[1]};
  for (Eigen::Index i = 0; i < 40; ++i)
    if (i != order[0] && i != order[1]) order.push_back(i);
  const Eigen::MatrixX2d place = model.measurement().place;
  for (Eigen::Index i = 0; i < 40; ++i)
    model.measurement().place.row(i) = place.row(order[static_cast<std::size_t>(i)]);
  SimulationBag own(model);
  options.points = 3;
  options.measured = 2;
  const MeasuringPlan rest = plan_measuring(own, options, context);
  CHECK_THAT(rest.information_of_measured, WithinRel(whole.information[1], 1e-9));
  REQUIRE(rest.chosen.size() == 3);
  for (std::size_t i = 0; i < 3; ++i) CHECK(order[static_cast<std::size_t>(rest.chosen[i])] == whole.chosen[i + 2]);
  CHECK_THAT(rest.information.back(), WithinRel(whole.information.back(), 1e-9));
}

TEST_CASE("MeasuringPlan.KeepsItsDistanceAndStopsWhereNoneIsLeft") {
  const ToyModel model(80);
  SimulationBag bag(model);
  Context context;
  MeasuringPlanOptions options;
  options.points = 60;
  options.min_distance = 0.3;
  const MeasuringPlan plan = plan_measuring(bag, options, context);
  CHECK(plan.chosen.size() < 30);
  const Eigen::MatrixX2d& place = model.measurements().front().place;
  for (std::size_t i = 0; i < plan.chosen.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      CHECK((place.row(plan.chosen[i]) - place.row(plan.chosen[j])).norm() >= options.min_distance);
}

TEST_CASE("MeasuringPlan.VisibleStrengthInClosedForm") {
  // Four standard deviations of the mean of n measurements: 4 sigma / sqrt(n), of order 1/2 in n.
  Context context;
  for (const int n : {1, 4, 16, 64}) {
    const OneCause model(n);
    SimulationBag bag(model);
    MeasuringPlanOptions options;
    options.points = 0;
    options.measured = n;
    const MeasuringPlan plan = plan_measuring(bag, options, context);
    REQUIRE(plan.causes.size() == 1);
    CHECK_THAT(plan.causes.front().min_visible_strength, WithinRel(4 * 0.1 / std::sqrt(n), 1e-9));
    CHECK_THAT(plan.causes.front().best_visible_strength, WithinRel(4 * 0.1 / std::sqrt(n), 1e-9));
    CHECK(plan.causes.front().usual_strength == 2);
    CHECK(plan.causes.front().closest_cause == -1);
    CHECK_THAT(plan.information_of_measured, WithinAbs(plan.information_of_all, 1e-9));
  }
}

TEST_CASE("MarksDrawing.HasEveryMarkAtItsPlaceInMillimetres") {
  const std::string svg = marks_svg({Vec2(240, 260), Vec2(220, 240), {Vec2(-30, 50), Vec2(10, -20)}, 4});
  CHECK(svg.find("width=\"240mm\" height=\"260mm\" viewBox=\"-120 -130 240 260\"") != std::string::npos);
  CHECK(svg.find("M-33 -50h6M-30 -53v6") != std::string::npos);  // y of a drawing points down
  CHECK(svg.find(">4</text>") != std::string::npos);
  CHECK(svg.find("<text x=\"10.8\" y=\"19.2\">5</text>") != std::string::npos);
}

}  // namespace
}  // namespace formwright
