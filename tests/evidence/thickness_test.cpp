// SPDX-License-Identifier: GPL-3.0-or-later
// A second quantity measured on the same object: thickness beside places.
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <atomic>
#include <cmath>
#include <random>

#include "base/error.h"
#include "evidence/diagnosis/diagnosis.h"
#include "evidence/diagnosis/diagnosis_report.h"
#include "evidence/fit/held_out.h"
#include "evidence/models/thermoform/rim_thickness.h"
#include "evidence/models/thermoform/thermoform_model.h"
#include "evidence/planning/measuring_plan.h"
#include "evidence/planning/point_information.h"
#include "evidence/one_cause.h"
#include "evidence/toy_with_thickness.h"
#include "evidence/virtual_lab.h"

namespace formwright {
namespace {

using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;
using evidence_test::ToyModel;
using evidence_test::ToyWithThickness;

/// The same cause, measured n times by one gauge and k times, tenfold, by another gauge.
class TwoGauges : public evidence_test::OneCause {
 public:
  TwoGauges(int n, double sigma, int k, double other_sigma) : OneCause(n, sigma) {
    Measurement m = OneCause(k, 10 * other_sigma).measurements().front();
    m.scale = 10;
    m.places_index = 0;
    measurements_.push_back(m);
  }
  Eigen::MatrixXd predict(int m, const Eigen::VectorXd& u, const Context&) const override {
    const Measurement& own = measurements_[static_cast<std::size_t>(m)];
    // The other quantity is asked for right after the place, on the same thread.
    static thread_local const double* last = nullptr;
    if (!own.is_place() && last != u.data()) ++misplaced;
    last = u.data();
    return Eigen::MatrixXd::Constant(own.place.rows(), 1, own.scale * u[0]);
  }
  bool claim(int m, const Eigen::VectorXd&, const Context&) const override {
    if (m != 0) ++misplaced;
    return true;
  }
  mutable std::atomic<int> misplaced =
      0;  // questions about the other quantity that were not asked right after the place
};

TEST_CASE("Thickness.OneSimulationAnswersForAllThatIsMeasuredOfAnObject") {
  const TwoGauges model(5, 0.1, 3, 0.2);
  SimulationBag bag(model);
  Context context;
  std::vector<Eigen::VectorXd> points;
  for (int i = 0; i < 40; ++i) points.push_back(Eigen::VectorXd::Constant(1, 0.1 * i));
  const auto predictions = bag.run(points, context, "");
  CHECK(bag.simulations() == 40);
  CHECK(model.misplaced == 0);
  for (int i = 0; i < 40; ++i) {
    REQUIRE(predictions[static_cast<std::size_t>(i)]);
    REQUIRE(predictions[static_cast<std::size_t>(i)]->size() == 2);
    CHECK_THAT((*predictions[static_cast<std::size_t>(i)])[1](2, 0), WithinAbs(i, 1e-12));
  }
}

TEST_CASE("Thickness.TellsAsMuchAsItsPrecision") {
  // Independent measurements of one number: their precisions add up, whatever unit each is scaled to.
  Context context;
  for (const int k : {1, 4, 16}) {
    const TwoGauges model(9, 0.3, k, 0.5);
    const double precision = 9 / (0.3 * 0.3) + k / (0.5 * 0.5);
    SimulationBag bag(model);
    MeasuringPlanOptions options;
    options.points = 0;
    options.measured = 9;
    const MeasuringPlan plan = plan_measuring(bag, options, context);
    REQUIRE(plan.causes.size() == 1);
    CHECK_THAT(plan.causes.front().min_visible_strength, WithinRel(4 / std::sqrt(precision), 1e-9));
    CHECK_THAT(plan.information_of_measured, WithinRel(0.5 * std::log(1 + 4 * 9 / (0.3 * 0.3)), 1e-9));
    options.measured_others = k;
    CHECK_THAT(plan_measuring(bag, options, context).information_of_measured,
               WithinRel(0.5 * std::log(1 + 4 * precision), 1e-9));
    CHECK_THAT(plan.information_of_all, WithinRel(0.5 * std::log(1 + 4 * precision), 1e-9));
  }
}

TEST_CASE("Thickness.DoesNotSetTheDistanceThatIsRoundedOff") {
  const TwoGauges model(9, 0.3, 4, 0.5);
  std::vector<NoiseEstimate> noise(2);
  noise[0].sigma = 0.3;
  noise[1].sigma = 5;
  CHECK(largest_noise(model, noise) == 0.3);
}

TEST_CASE("Thickness.IsEvidenceButNoDistance") {
  ToyWithThickness model(300, 40);
  Eigen::VectorXd u = model.nominal();
  u[4] = 1.2;
  model.measure_all(u, 0.05, 3);
  SimulationBag bag(model);
  Context context;
  const Diagnosis d = diagnose(bag, {}, context);
  REQUIRE(d.reading == Reading::cause);
  CHECK(d.verdict == std::vector<int>{2});
  REQUIRE(d.held_out_others.size() == 1);
  // In its own unit: noise of 0.01 whose mean length is sqrt(2 / pi) times as much.
  CHECK(d.held_out_others[0].after.mean < 0.012);
  CHECK(d.held_out_others[0].after.mean > 0.005);
  CHECK(d.held_out_others[0].before.mean > 2 * d.held_out_others[0].after.mean);
  CHECK_THAT(d.noise[1].sigma / 4, WithinRel(0.01, 0.3));
  // Distances are those of places alone: the same as where nothing else was measured.
  ToyModel alone(300);
  alone.measure(u, 0.05, 3);
  SimulationBag other_bag(alone);
  const Diagnosis other = diagnose(other_bag, {}, context);
  CHECK_THAT(d.noise_floor, WithinRel(other.noise_floor, 0.02));
  CHECK_THAT(d.held_out.after.mean, WithinRel(other.held_out.after.mean, 0.05));
  const Json json = diagnosis_json({model, d, {}, std::nullopt, {}, {}});
  CHECK(json["other_quantities"][0]["object"] == "toy, thickness");
  CHECK(json["other_quantities"][0]["readings"] == 40);
  const std::string page = diagnosis_page({model, d, {}, std::nullopt, {}, {}});
  CHECK(page.find("<h2>toy, thickness</h2>") != std::string::npos);
  CHECK(page.find("Diagnosis of toy</title>") != std::string::npos);
}

using namespace virtual_lab;

FormedObject plain_object() {
  std::mt19937 random(5);
  HiddenWorld world;
  world.triangles = 2000;
  Observation observation;
  observation.points = 300;
  return make_object(Mould::pyramid, world, {}, observation, random);
}

TEST_CASE("Thickness.ASheetThatIsThickerOnOneSideShowsAtItsRim") {
  FormedObject object = plain_object();
  const auto o = read_parameters<ThermoformOptions>(object.setup.parameters);
  const std::vector<RimPlace> rim = rim_places(o);
  REQUIRE(rim.size() == 4);
  for (const RimPlace& place : rim) {
    const bool beyond = std::abs(place.sheet_mm.x()) > 0.5 * o.clamp_opening_x_mm ||
                        std::abs(place.sheet_mm.y()) > 0.5 * o.clamp_opening_y_mm;
    CHECK(beyond);
    CHECK(std::abs(place.sheet_mm.x()) < 0.5 * o.sheet_x_mm);
    CHECK(std::abs(place.sheet_mm.y()) < 0.5 * o.sheet_y_mm);
    object.thickness.push_back({place.sheet_mm, o.sheet_thickness_mm, 0.05});
  }
  ThermoformModelOptions options;
  options.triangles = 1200;
  for (const bool turned : {false, true}) {
    object.setup.sheet_turned = turned;
    const ThermoformModel model({object}, options);
    REQUIRE(model.measurements().size() == 2);
    CHECK(model.measurements()[1].places_index == 0);
    CHECK(model.measurements()[1].name == object.name + ", thickness of the rim");
    Eigen::VectorXd u = model.nominal();
    for (std::size_t p = 0; p < model.parameters().size(); ++p)
      if (model.parameters()[p].name == "thickness_wedge_x") u[static_cast<Eigen::Index>(p)] = 0.1;
    const Eigen::VectorXd thickness = model.predict(1, u, Context()) / model.measurements()[1].scale;
    // Sheet coordinates count from the sheet's own edges, however it lay in the clamp.
    const double at_rim = 0.1 * 2 * rim[1].sheet_mm.x() / o.clamp_opening_x_mm;
    CHECK_THAT(thickness[0], WithinRel(o.sheet_thickness_mm * (1 - at_rim), 1e-9));
    CHECK_THAT(thickness[1], WithinRel(o.sheet_thickness_mm * (1 + at_rim), 1e-9));
    CHECK_THAT(thickness[2], WithinRel(o.sheet_thickness_mm, 1e-9));
  }
}

TEST_CASE("Thickness.WithinTheOpeningIsThatOfTheSimulatedSheet") {
  FormedObject object = plain_object();
  const auto o = read_parameters<ThermoformOptions>(object.setup.parameters);
  object.thickness.push_back({rim_places(o).front().sheet_mm, 0.9, 0.05});
  for (int i = -3; i <= 3; ++i) object.thickness.push_back({Vec2(9 * i, 5 * i), 0.7, 0.05});
  ThermoformModelOptions options;
  options.triangles = 1200;
  const ThermoformModel model({object}, options);
  const Eigen::VectorXd thickness = model.predict(1, model.nominal(), Context()) / model.measurements()[1].scale;
  const auto sheet = model.formed(0, model.nominal(), Context());
  for (Eigen::Index i = 0; i < thickness.size(); ++i) {
    CHECK(thickness[i] >= sheet->thickness_mm.minCoeff());
    CHECK(thickness[i] <= sheet->thickness_mm.maxCoeff());
  }
  CHECK(thickness.minCoeff() < 0.9 * thickness.maxCoeff());
  // The rim is a measurement of its own, known three times as well.
  REQUIRE(model.measurements().size() == 3);
  CHECK(thickness.size() == 7);
  CHECK(model.thickness_readings(2).size() == 1);
  CHECK_THAT(model.measurements()[2].scale, WithinRel(3 * model.measurements()[1].scale, 1e-9));
  CHECK_THAT(model.measurements()[2].measured(0, 0) / model.measurements()[2].scale, WithinRel(0.9, 1e-12));
}

TEST_CASE("Thickness.WrongReadingsGetAClearSentence") {
  const FormedObject good = plain_object();
  const auto refusal = [&](const MeasuredThickness& reading) -> std::string {
    FormedObject object = good;
    object.thickness = {{Vec2(0, 0), 0.8, 0.05}, reading};
    try {
      check_measured_object(object);
    } catch (const Error& error) {
      CHECK(error.code() == ErrorCode::invalid_input);
      return error.what();
    }
    return "";
  };
  CHECK(refusal({Vec2(10, 10), 0.5, 0.05}).empty());
  CHECK(refusal({Vec2(10, 10), 500, 0.05}).find("thickness 2: “thickness_mm” is 500") != std::string::npos);
  CHECK(refusal({Vec2(10, 10), 0.0005, 0.05}).find("give it in millimetres") != std::string::npos);
  CHECK(refusal({Vec2(900, 10), 0.5, 0.05}).find("beyond the sheet") != std::string::npos);
}

TEST_CASE("Thickness.ASheetThatIsNotAsThickAsItsSetUpIsNoted") {
  FormedObject object = plain_object();
  const auto o = read_parameters<ThermoformOptions>(object.setup.parameters);
  CHECK(thickness_note(object).empty());
  const auto with = [&](double left, double right, double front, double back) {
    object.thickness.clear();
    const double readings[] = {left, right, front, back};
    for (std::size_t i = 0; i < 4; ++i)
      object.thickness.push_back({rim_places(o)[i].sheet_mm, readings[i] * o.sheet_thickness_mm, 0.02});
    return thickness_note(object);
  };
  CHECK(with(1, 1, 1, 1).empty());
  CHECK(with(0.8, 1.2, 1, 1).empty());  // a wedge
  CHECK(with(0.9, 0.9, 0.9, 0.9).find("correct its sheet_thickness_mm") != std::string::npos);
  object.thickness.resize(1);  // one side alone says nothing of the whole sheet
  CHECK(thickness_note(object).empty());
}

}  // namespace
}  // namespace formwright
