// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/models/thermoform/good_part.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include "base/error.h"
#include "evidence/calibration.h"
#include "evidence/diagnosis/diagnosis.h"
#include "evidence/virtual_lab.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

using namespace virtual_lab;

constexpr int few_triangles = 1200;

/// Plastic and simulation that the diagnosis's own is wrong about.
HiddenWorld other_plastic() {
  HiddenWorld world;
  world.young_factor = 1.6;
  world.yield_strain = 0.16;
  world.triangles = 3000;
  return world;
}

FormedObject measured(const std::string& name, unsigned seed, const std::vector<HiddenEffect>& effects) {
  std::mt19937 random(seed);
  Observation observation;
  observation.points = 500;
  FormedObject object = make_object(Mould::pyramid, other_plastic(), effects, observation, random);
  object.name = name;
  return object;
}

ThermoformModelOptions beside(const std::vector<FormedObject>& parts) {
  ThermoformModelOptions options;
  options.triangles = few_triangles;
  options.good_parts = std::make_shared<const std::vector<FormedObject>>(parts);
  return options;
}

/// Median, which outliers leave alone.
double median_length(const Eigen::MatrixXd& rows) {
  std::vector<double> lengths;
  for (Eigen::Index i = 0; i < rows.rows(); ++i) lengths.push_back(rows.row(i).norm());
  std::nth_element(lengths.begin(), lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2), lengths.end());
  return lengths[lengths.size() / 2];
}

double error_of(const ThermoformModel& model) {
  Context context;
  return median_length(residuals(model, {model.predict(0, model.nominal(), context)}).front());
}

TEST_CASE("GoodPart.what_the_simulation_misses_of_it_is_not_missed_again") {
  const FormedObject good = measured("June", 1, {}), today = measured("today", 2, {});
  ThermoformModelOptions alone;
  alone.triangles = few_triangles;
  const double before = error_of(ThermoformModel({today}, alone));
  const double after = error_of(ThermoformModel({today}, beside({good})));
  CAPTURE(before, after);
  CHECK(after < 0.75 * before);
  CHECK(after < 0.15);  // noise of 0.05 mm in each direction alone: 0.08
  // Of itself nothing is missed but what is smoothed: its noise.
  CHECK(error_of(ThermoformModel({good}, beside({good}))) < after);
}

TEST_CASE("GoodPart.another_simulation_misses_something_else_of_it") {
  const FormedObject good = measured("June", 1, {}), today = measured("today", 2, {});
  const ThermoformModel model({today}, beside({good}));
  ThermoformModelOptions without = beside({good});
  without.good_parts.reset();
  const ThermoformModel alone({today}, without);
  Context context;
  Eigen::VectorXd other = model.nominal();
  other[model.parameters_with(ParameterRole::discrepancy).front()] = 1;
  const auto moves = [&](const ThermoformModel& m) {
    return median_length(m.predict(0, other, context) - m.predict(0, m.nominal(), context));
  };
  CHECK(moves(model) < 0.5 * moves(alone));
}

TEST_CASE("GoodPart.thickness_that_it_misses_is_not_missed_again_but_a_rim_is_its_own") {
  FormedObject good = measured("June", 1, {}), today = measured("today", 2, {});
  const auto o = read_parameters<ThermoformOptions>(today.setup.parameters);
  const Vec2 rim(0.5 * o.clamp_opening_x_mm + 5, 0);
  good.thickness = {{Vec2(0, 0), 0.5, 0.01}, {Vec2(30, 0), 0.4, 0.01}, {rim, 1.2, 0.01}};
  today.thickness = {{Vec2(0, 0), 0.5, 0.01}, {Vec2(30, 0), 0.4, 0.01}, {rim, 1.0, 0.01}};
  const ThermoformModel model({today}, beside({good}));
  REQUIRE(model.measurements().size() == 3);
  Context context;
  const auto read = [&](int measurement) {
    const Measurement& m = model.measurements()[static_cast<std::size_t>(measurement)];
    return Eigen::VectorXd(model.predict(measurement, model.nominal(), context) / m.scale);
  };
  CHECK_THAT(read(1)[0], WithinAbs(0.5, 0.02));
  CHECK_THAT(read(1)[1], WithinAbs(0.4, 0.02));
  CHECK_THAT(read(2)[0], WithinAbs(o.sheet_thickness_mm, 1e-9));
}

TEST_CASE("GoodPart.its_material_is_kept_near_and_half_the_misfit_is_known") {
  ThermoformModelOptions options = beside({measured("June", 1, {})});
  options.profile.parameters["young_modulus_pa"] = 3e6;
  const FormedObject today = measured("today", 2, {});
  const ThermoformModel model({today}, options);
  options.good_parts.reset();
  const ThermoformModel alone({today}, options);
  const auto modulus = [](const ThermoformModel& m) {
    return *std::find_if(m.parameters().begin(), m.parameters().end(),
                         [](const ModelParameter& p) { return p.name == "young_modulus_pa"; });
  };
  CHECK(modulus(model).was_measured);
  CHECK_FALSE(modulus(alone).was_measured);
  CHECK_THAT(modulus(model).prior_sd, WithinAbs(0.5 * modulus(alone).prior_sd, 1e-12));
  CHECK_THAT(modulus(model).low_u(), WithinAbs(-4 * modulus(model).prior_sd, 1e-12));
  CHECK_THAT(modulus(model).high_u(), WithinAbs(4 * modulus(model).prior_sd, 1e-12));
  CHECK(modulus(alone).high_u() > 3 * modulus(model).high_u());
  CHECK(model.known_misfit() == 0.5 * alone.known_misfit());
  CHECK(model.max_misfit_left() == alone.max_misfit_left());
}

TEST_CASE("GoodPart.it_must_be_of_the_same_mould") {
  const FormedObject object = measured("today", 2, {});
  FormedObject other = measured("June", 1, {});
  CHECK_NOTHROW(check_good_parts({other}, {object}));
  // Written by another program, with other triangles: the same mould.
  other.key = "another file";
  TriangleMesh mesh = object.mould->mesh;
  mesh.F = mesh.F.colwise().reverse().eval();
  other.mould = std::make_shared<const MouldShape>(mesh);
  CHECK(same_mould(other, object));
  CHECK_NOTHROW(check_good_parts({other}, {object}));
  // A millimetre beside: marks come to lie elsewhere on it.
  mesh.V.col(0).array() += 1;
  other.mould = std::make_shared<const MouldShape>(mesh);
  CHECK_FALSE(same_mould(other, object));
  try {
    check_good_parts({other}, {object});
    FAIL_CHECK("not refused");
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::invalid_input);
    CHECK(error.where() == "good");
    CHECK(std::string(error.what()).find("June: this good part was formed over another mould") == 0);
  }
  // Of another mould it changes nothing.
  ThermoformModelOptions alone;
  alone.triangles = few_triangles;
  CHECK(error_of(ThermoformModel({object}, beside({other}))) == error_of(ThermoformModel({object}, alone)));
}

TEST_CASE("GoodPart.what_has_changed_since_is_found") {
  const HiddenEffect effect{"print_scale", {{"print_scale", 0.01}}};
  const FormedObject good = measured("June", 1, {}), today = measured("today", 2, {effect});
  ThermoformModelOptions options;
  options.triangles = few_triangles / 2;
  Context context;
  const MachineInOrder in_order = machine_in_order({good}, options, context);
  CHECK(in_order.profile.from == std::vector<std::string>{"June"});
  CHECK(in_order.error_mm < 0.6);  // 600 triangles, and outliers
  options.profile = in_order.profile;
  options.good_parts = std::make_shared<const std::vector<FormedObject>>(std::vector{good});
  const ThermoformModel model({today}, options);
  SimulationBag bag(model);
  DiagnosisOptions quick;
  quick.pairs = false;
  const Diagnosis diagnosis = diagnose(bag, quick, context);
  REQUIRE(diagnosis.verdict.size() == 1);
  CHECK(model.causes()[static_cast<std::size_t>(diagnosis.verdict.front())].name == "print_scale");
  CHECK(diagnosis.doubts.empty());
}

}  // namespace
}  // namespace formwright
