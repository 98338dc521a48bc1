// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/models/thermoform/thermoform_model.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <mutex>
#include <random>
#include <string>

#include "base/error.h"
#include "evidence/calibration.h"
#include "evidence/diagnosis/diagnosis.h"
#include "evidence/virtual_lab.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

using namespace virtual_lab;

/// A small object of few points, quick to simulate.
FormedObject small_object(unsigned seed, const std::vector<HiddenEffect>& effects, double sigma_mm = 0.05,
                          Mould mould = Mould::pyramid) {
  std::mt19937 random(seed);
  HiddenWorld world;
  world.triangles = 3000;
  Observation observation;
  observation.points = 500;
  observation.sigma_mm = sigma_mm;
  return make_object(mould, world, effects, observation, random);
}

ThermoformModelOptions coarse(int triangles = 1200) {
  ThermoformModelOptions options;
  options.triangles = triangles;
  return options;
}

void expect_refused(const FormedObject& object, const std::string& words) {
  try {
    check_measured_object(object);
    FAIL_CHECK("not refused; expected: " << words);
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::invalid_input);
    INFO(error.what());
    CHECK(std::string(error.what()).find(words) != std::string::npos);
  }
}

TEST_CASE("ThermoformModel.WrongDataGetAClearSentence") {
  const FormedObject good = small_object(1, {});
  CHECK_NOTHROW(check_measured_object(good));
  const auto changed = [&](auto&& change) {
    FormedObject object = good;
    for (MeasuredPoint& p : object.points) change(p);
    return object;
  };
  expect_refused(changed([](MeasuredPoint& p) { p.place_mm *= 1e-3; }), "metres");
  expect_refused(changed([](MeasuredPoint& p) { p.place_mm /= 25.4; }), "inches");
  expect_refused(changed([](MeasuredPoint& p) { p.place_mm *= 1e-3, p.sheet_mm *= 1e-3; }), "metres");
  expect_refused(changed([](MeasuredPoint& p) { p.place_mm += Vec3(300, 0, 0); }), "machine's coordinates");
  expect_refused(changed([](MeasuredPoint& p) { p.sheet_mm += Vec2(500, 0); }), "beyond the sheet");
  FormedObject tiny = good;
  tiny.points.resize(5);
  expect_refused(tiny, "at least 6");
  FormedObject few = good;
  few.points.resize(20);
  for (MeasuredPoint& p : few.points) p.sigma_mm = 0.3;
  few.points.back().sigma_mm = 0;
  expect_refused(few, "give sigma_mm for each point");
}

TEST_CASE("ThermoformModel.ATurnedSheetIsReadAsItLay") {
  const FormedObject straight = small_object(1, {});
  FormedObject turned = straight;
  for (MeasuredPoint& p : turned.points) p.sheet_mm = -p.sheet_mm;
  expect_refused(turned, "\"sheet_turned\": true");
  turned.setup.sheet_turned = true;
  CHECK_NOTHROW(check_measured_object(turned));
  Context context;
  const ThermoformModel one({straight}, coarse()), other({turned}, coarse());
  CHECK((one.predict(0, one.nominal(), context) - other.predict(0, other.nominal(), context)).norm() < 1e-9);
  FormedObject said_so = straight;
  said_so.setup.sheet_turned = true;
  expect_refused(said_so, "not turned");
}

TEST_CASE("ThermoformModel.AMouldInAnotherUnitIsRefused") {
  FormedObject object = small_object(1, {});
  CHECK_NOTHROW(check_mould_of(object));
  const TriangleMesh mould = object.mould->mesh;
  for (const auto& [factor, unit] : {std::pair{1e-3, "metres"}, std::pair{1 / 25.4, "inches"}}) {
    TriangleMesh scaled = mould;
    scaled.V *= factor;
    object.mould = std::make_shared<const MouldShape>(scaled);
    try {
      check_mould_of(object);
      FAIL_CHECK(unit);
    } catch (const Error& error) {
      INFO(error.what());
      CHECK(std::string(error.what()).find(unit) != std::string::npos);
    }
  }
}

TEST_CASE("ThermoformModel.ARimThatIsNotWhereTheSetUpHasItIsNoted") {
  FormedObject object = small_object(1, {});
  const auto o = read_parameters<ThermoformOptions>(object.setup.parameters);
  const double z =
      o.clamp_height_mm + (object.setup.measured_surface == MeasuredSurface::outer ? 0.5 * o.sheet_thickness_mm : 0.0);
  object.points.clear();
  for (int i = 0; i < 20; ++i) {
    const Vec2 place(0.5 * o.clamp_opening_x_mm + 2, 3.0 * i - 30);
    object.points.push_back({place, Vec3(place.x(), place.y(), z), 0.05});
  }
  CHECK(rim_note(object) == "");
  for (MeasuredPoint& p : object.points) p.place_mm.z() -= 1.75;
  INFO(rim_note(object));
  CHECK(rim_note(object).find("1.75 mm below") != std::string::npos);
}

TEST_CASE("ThermoformModel.WhatASetUpSaysOfItsOwnObjectStays") {
  const FormedObject first = small_object(1, {});
  FormedObject second = first;
  second.setup.parameters["mould_shift_x_mm"] = 2.0;
  const ThermoformModel both({first, second}, coarse()), alone({second}, coarse());
  Context context;
  const Eigen::MatrixXd expected = alone.predict(0, alone.nominal(), context);
  CHECK((both.predict(1, both.nominal(), context) - expected).norm() < 1e-9);
  CHECK((both.predict(0, both.nominal(), context) - expected).norm() > 1);
}

TEST_CASE("ThermoformModel.AProfileSaysWithWhichLawItWasFitted") {
  FormedObject object = small_object(5, {});
  object.setup.parameters["elastic_law"] = "stable_neo_hookean";
  object.setup.parameters["vacuum_ramp_s"] = 0.6;
  const ThermoformModel model({object}, coarse());
  const MachineProfile profile = model.profile_at(model.nominal());
  CHECK(profile.parameters["elastic_law"] == "stable_neo_hookean");
  CHECK(profile.parameters["vacuum_ramp_s"] == 0.6);
  CHECK(profile.notes.empty());
  FormedObject other = object;
  other.setup.parameters["vacuum_ramp_s"] = 0.2;
  const ThermoformModel two({object, other}, coarse());
  REQUIRE(two.profile_at(two.nominal()).notes.size() == 1u);
  CHECK(two.profile_at(two.nominal()).notes[0].find("vacuum_ramp_s") != std::string::npos);
}

TEST_CASE("ThermoformModel.PredictsWhatTheComparisonDoes") {
  const FormedObject object = small_object(2, {});
  const ThermoformModel model({object}, coarse());
  Context context;
  const Eigen::MatrixXd predicted = model.predict(0, model.nominal(), context);
  ThermoformOptions o = model.simulation_options(0, model.nominal());
  const FormedResult formed = form_sheet(object.mould, Placement{}, o, context);
  const Comparison compared = compare(formed.sheet, object.points, object.setup.measured_surface, o.clamp_height_mm,
                                      o.sheet_thickness_mm, MeasurementEffects{}, 0, context);
  for (std::size_t i = 0; i < object.points.size(); ++i)
    CHECK((predicted.row(static_cast<Eigen::Index>(i)).transpose() - compared.points[i].simulated_mm).norm() < 1e-4);
}

TEST_CASE("ThermoformModel.MeasurementEffectsNeedNoSimulationOfTheirOwn") {
  const FormedObject object = small_object(3, {});
  const ThermoformModel model({object}, coarse());
  int kept = 0;
  Context context(Host{{}, {}, {}, {}, [&](const std::string&, const Bytes&) { ++kept; }});
  Eigen::VectorXd u = model.nominal();
  const Eigen::MatrixXd before = model.predict(0, u, context);
  for (std::size_t p = 0; p < model.parameters().size(); ++p)
    if (model.parameters()[p].name == "scan_shift_x_mm") u[static_cast<Eigen::Index>(p)] = 0.5;
  const Eigen::MatrixXd after = model.predict(0, u, context);
  CHECK(kept == 1);
  CHECK_THAT((after - before).col(0).mean(), WithinAbs(0.5, 1e-9));
  CHECK((after - before).rightCols(2).cwiseAbs().maxCoeff() < 1e-9);
}

TEST_CASE("ThermoformModel.AnInterruptedRunGoesOnFromWhatIsKept") {
  const FormedObject object = small_object(4, {});
  std::map<std::string, Bytes> store;
  std::mutex mutex;
  int kept = 0;
  bool stop = false;
  const auto host = [&] {
    Host h;
    h.cancel_requested = [&] { return stop; };
    h.find_result = [&](const std::string& key) -> std::optional<Bytes> {
      const std::scoped_lock lock(mutex);
      const auto at = store.find(key);
      return at == store.end() ? std::nullopt : std::optional(at->second);
    };
    h.keep_result = [&](const std::string& key, const Bytes& bytes) {
      const std::scoped_lock lock(mutex);
      store[key] = bytes;
      stop = ++kept == 6;
    };
    return h;
  };
  const ThermoformModel model({object}, coarse(800));
  std::vector<Eigen::VectorXd> points;
  for (int i = 0; i < 10; ++i) {
    points.push_back(model.nominal());
    points.back()[0] = 0.02 * i;
  }
  {
    SimulationBag bag(model);
    Context context(host());
    CHECK_THROWS_AS(bag.run(points, context, ""), Error);
  }
  CHECK(kept >= 6);
  const int before = kept;
  stop = false;
  // A new process: nothing but the store is left.
  const ThermoformModel again({object}, coarse(800));
  SimulationBag bag(again);
  Context context(host());
  const auto resumed = bag.run(points, context, "");
  CHECK(kept == 10);
  CHECK(before < 10);
  // What was kept is, to the bit, what a run of its own gives.
  const ThermoformModel alone({object}, coarse(800));
  Context quiet;
  CHECK((*resumed[0])[0] == alone.predict(0, points[0], quiet));
}

TEST_CASE("ThermoformModel.ProfileHoldsWhatWasFittedAndStartsTheNextRun") {
  const FormedObject object = small_object(5, {});
  const ThermoformModel model({object}, coarse());
  Eigen::VectorXd u = model.nominal();
  u[0] = 0.3;
  for (std::size_t p = 0; p < model.parameters().size(); ++p) {
    if (model.parameters()[p].name == "heating_gradient_x") u[static_cast<Eigen::Index>(p)] = 0.25;
    if (model.parameters()[p].name == "print_scale") u[static_cast<Eigen::Index>(p)] = 0.01;
  }
  const MachineProfile profile = read_machine_profile(as_bytes(write_machine_profile(model.profile_at(u))));
  ThermoformModelOptions options = coarse();
  options.profile = profile;
  const ThermoformModel next({object}, options);
  Context context;
  CHECK((next.predict(0, next.nominal(), context) - model.predict(0, u, context)).cwiseAbs().maxCoeff() < 1e-4);
}

TEST_CASE("ThermoformModel.CalibrationRecoversTheMaterialOrSaysItCannot") {
  // Made by the model itself on the same mesh: what is off afterwards is the fit's own.
  FormedObject object = small_object(6, {});
  ThermoformModelOptions options = coarse();
  options.fit_mould_place = true;
  ThermoformModel truth({object}, options);
  Eigen::VectorXd u = truth.nominal();
  u[0] = 0.35;
  u[2] = -0.03;
  for (std::size_t p = 0; p < truth.parameters().size(); ++p)
    if (truth.parameters()[p].name == "mould_shift_x_mm") u[static_cast<Eigen::Index>(p)] = 0.8;
  Context context;
  const Eigen::MatrixXd places = truth.predict(0, u, context);
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0, 0.03);
  for (std::size_t i = 0; i < object.points.size(); ++i)
    for (int k = 0; k < 3; ++k) object.points[i].place_mm[k] = places(static_cast<Eigen::Index>(i), k) + noise(random);
  const ThermoformModel model({object}, options);
  SimulationBag bag(model);
  const Calibration c = calibrate(bag, context);
  CHECK(c.error < 1.15 * 0.03 * 1.596);  // the mean length of the noise
  for (const ParameterProfile& profile : c.profiles) {
    const ModelParameter& p = model.parameters()[static_cast<std::size_t>(profile.parameter)];
    const double right = p.value(u[profile.parameter]);
    {
      INFO(p.name << " " << right << " not in " << profile.low << " to " << profile.high);
      CHECK((!profile.identified || (right >= profile.low - 0.1 * std::abs(right) - 1e-12 &&
                                     right <= profile.high + 0.1 * std::abs(right) + 1e-12)));
    }
    if (p.name == "yield_strain") {
      CHECK(profile.identified);
    }
  }
}

/// One cause drawn afresh at every run, twice as large as what the table calls strong; the whole table is
/// tests/bench/evidence/confusion_table.
TEST_CASE("ThermoformModel.ADrawnCauseIsNamedOrDoubted") {
  const char* again = std::getenv("FORMWRIGHT_SEED");
  const unsigned seed = again != nullptr ? static_cast<unsigned>(std::stoul(again)) : std::random_device{}();
  std::printf("seed %u (FORMWRIGHT_SEED draws it again)\n", seed);
  std::mt19937 random(seed);
  // Those that a pyramid shows plainly, even to so coarse a simulation.
  const std::vector<std::string> plain{"mould_scale", "print_scale", "scan_scale", "scan_shift"};
  const std::string cause = plain[random() % plain.size()];
  const HiddenEffect hidden = draw_effect(cause, 2, random);
  const ThermoformModel model({small_object(static_cast<unsigned>(random()), {hidden})}, coarse());
  SimulationBag bag(model);
  Context context;
  DiagnosisOptions options;
  options.pairs = false;
  const Diagnosis d = diagnose(bag, options, context);
  INFO(cause + " " + hidden.values.dump() + " seed " + std::to_string(seed));
  for (const CauseFinding& finding : d.causes) {
    if (model.causes()[static_cast<std::size_t>(finding.cause)].name != cause) continue;
    double size_squared = 0;
    for (const auto& [name, value] : hidden.values.items()) size_squared += std::pow(value.get<double>(), 2);
    // Nothing may be found where the diagnosis itself says that it could not see as much; a margin, since it knows that
    // only linearly.
    if (std::sqrt(size_squared) > 1.25 * finding.min_visible_strength) {
      INFO("visible from " << finding.min_visible_strength);
      CHECK(d.reading != Reading::none);
    }
  }
  if (d.reading != Reading::none && d.reading != Reading::unknown && !d.doubtful() &&
      d.reading != Reading::cannot_separate) {
    CHECK(model.causes()[static_cast<std::size_t>(d.verdict.front())].name == cause);
  }
  if (!d.verdict.empty()) {
    CHECK(d.held_out.after.mean < d.held_out.before.mean);
  }
}

}  // namespace
}  // namespace formwright
