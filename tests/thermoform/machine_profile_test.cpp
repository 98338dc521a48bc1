// SPDX-License-Identifier: GPL-3.0-or-later
// What a scan would show, and what a machine profile keeps.
#include "thermoform/machine_profile.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include "base/error.h"
#include "thermoform/measured/measured_object.h"
#include "thermoform/sheet/sheet_mesh.h"
#include "thermoform/sheet/thermoform_options.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

/// A sheet raised to z = 0.1 x + 20, as a plane that any interpolation has exactly.
FormedSheet slope() {
  const SheetMesh mesh = make_sheet_mesh(Vec2(100, 100), 200);
  FormedSheet sheet;
  sheet.sheet_mm = mesh.flat_mm;
  sheet.mesh.F = mesh.F;
  sheet.mesh.V.resize(mesh.flat_mm.rows(), 3);
  sheet.mesh.V << mesh.flat_mm, (0.1 * mesh.flat_mm.col(0).array() + 20).matrix();
  sheet.thickness_mm = Eigen::VectorXd::Constant(mesh.flat_mm.rows(), 1);
  return sheet;
}

TEST_CASE("PredictMeasured.scales_turns_and_shifts_are_those_of_their_declaration") {
  TextureCoordinates places(3, 2);
  places << 10, -20, 0, 0, 60, 0;  // the last one lies in the clamp
  MeasurementEffects effects;
  effects.print_scale = 0.02;
  effects.print_stretch_x = 0.05;
  effects.print_stretch_y = -0.1;
  effects.scan_scale = -0.01;
  effects.scan_shift_x_mm = 1;
  effects.scan_shift_z_mm = -2;
  const Positions predicted = predict_measured(slope(), places, MeasuredSurface::mid, 5, 1, effects, 3);
  const auto scanned = [](double x, double y, double z) {
    return Vec3(0.99 * x + 1, 0.99 * y, 3 + 0.99 * (z - 3) - 2);
  };
  CHECK((predicted.row(0).transpose() - scanned(10.71, -18.36, 21.071)).norm() < 1e-9);
  CHECK((predicted.row(1).transpose() - scanned(0, 0, 20)).norm() < 1e-9);
  CHECK((predicted.row(2).transpose() - scanned(64.26, 0, 5)).norm() < 1e-9);
  // Stretched before it is turned, each about the plate's middle; counter-clockwise seen from where the axis points to.
  MeasurementEffects along;
  along.scan_stretch_x = 0.1;
  along.scan_stretch_y = -0.2;
  along.scan_stretch_z = 0.5;
  const auto places_with = [&] {
    return Positions(predict_measured(slope(), places, MeasuredSurface::mid, 5, 1, along, 3).rowwise() -
                     Eigen::RowVector3d(0, 0, 3));
  };
  const Positions stretched = places_with();
  CHECK((stretched.row(2) - Eigen::RowVector3d(66, 0, 3)).norm() < 1e-9);
  CHECK((stretched.row(0) - Eigen::RowVector3d(11, -16, 27)).norm() < 1e-9);
  along.scan_turn_x_deg = 90;
  CHECK((places_with().row(0) - Eigen::RowVector3d(11, -27, -16)).norm() < 1e-9);
  along.scan_turn_x_deg = 0;
  along.scan_turn_y_deg = 90;
  CHECK((places_with().row(0) - Eigen::RowVector3d(27, -16, -11)).norm() < 1e-9);
  along.scan_turn_y_deg = 0;
  along.scan_turn_z_deg = 90;
  along.scan_shift_x_mm = 2;
  CHECK((places_with().row(0) - Eigen::RowVector3d(18, 11, 27)).norm() < 1e-9);
  // Half a thickness outwards, of a sheet in the clamp straight up.
  const Positions outer = predict_measured(slope(), places, MeasuredSurface::outer, 5, 1, {}, 3);
  CHECK_THAT((outer.row(1).transpose() - Vec3(0, 0, 20)).norm(), WithinAbs(0.5, 1e-9));
  CHECK((outer.row(2).transpose() - Vec3(60, 0, 5.5)).norm() < 1e-12);
}

TEST_CASE("PredictMeasured.comparison_with_its_own_prediction_finds_no_error") {
  TextureCoordinates places(4, 2);
  places << 10, -20, 0, 0, 60, 0, -31, 17;
  MeasurementEffects effects;
  effects.print_scale = 0.03;
  effects.scan_scale = 0.02;
  effects.scan_shift_y_mm = 1;
  const Positions predicted = predict_measured(slope(), places, MeasuredSurface::outer, 5, 1, effects, 3);
  std::vector<MeasuredPoint> points;
  for (Eigen::Index i = 0; i < 4; ++i) points.push_back({places.row(i).transpose(), predicted.row(i).transpose(), 0});
  Context context;
  CHECK(compare(slope(), points, MeasuredSurface::outer, 5, 1, effects, 3, context).maximum_mm < 1e-12);
  CHECK(compare(slope(), points, MeasuredSurface::outer, 5, 1, {}, 3, context).mean_mm > 1);
}

MachineProfile some_profile() {
  MachineProfile profile;
  profile.name = "Formech in the cellar";
  profile.parameters = {
      {"yield_strain", 0.07}, {"heating_gradient_x", 0.25}, {"vacuum_kpa", 70}, {"vacuum_ramp_s", 0.4}};
  profile.measurement.scan_scale = 0.0125;
  profile.from = {"pyramid 1"};
  profile.notes = {"The left heater is weak."};
  return profile;
}

TEST_CASE("MachineProfile.is_read_as_it_was_written") {
  const MachineProfile written = some_profile(), read = read_machine_profile(as_bytes(write_machine_profile(written)));
  CHECK(read.name == written.name);
  CHECK(read.parameters == written.parameters);
  CHECK(write_parameters(read.measurement) == write_parameters(written.measurement));
  CHECK(read.from == written.from);
  CHECK(read.notes == written.notes);
}

TEST_CASE("MachineProfile.wins_over_the_set_up_where_it_knows_better") {
  const Json setup = {{"yield_strain", 0.1}, {"vacuum_kpa", 80}, {"vacuum_ramp_s", 0.2}, {"sheet_thickness_mm", 2}};
  const Json merged = with_profile(setup, some_profile());
  CHECK(merged["yield_strain"] == 0.07);
  CHECK(merged["heating_gradient_x"] == 0.25);
  CHECK(merged["vacuum_ramp_s"] == 0.4);
  CHECK(merged["vacuum_kpa"] == 80);  // what the machine was told
  CHECK(merged["sheet_thickness_mm"] == 2);
  CHECK(with_profile(Json::object(), some_profile())["vacuum_kpa"] == 70);
}

TEST_CASE("MachineProfile.refuses_what_it_cannot_use_in_words") {
  const auto refused = [](const Json& json, const std::string& words) {
    const std::string text = json.dump();
    try {
      read_machine_profile(as_bytes(text));
      FAIL("not refused: " << words);
    } catch (const Error& error) {
      CHECK(error.code() == ErrorCode::invalid_input);
      CHECK(error.where() == "profile");
      INFO(error.what());
      CHECK(std::string(error.what()).find(words) != std::string::npos);
    }
  };
  Json profile = Json::parse(write_machine_profile(some_profile()));
  const auto with = [&](const char* key, Json value) {
    Json changed = profile;
    changed[key] = std::move(value);
    return changed;
  };
  refused({1, 2}, "formwright-machine-profile");
  refused(with("format", "something else"), "formwright-machine-profile");
  refused(with("version", 2), "version 1");
  refused(with("parameters", {{"size_mm", 100}}), "places a model");
  refused(with("parameters", {{"yield_strain", -1}}), "yield_strain");
  refused(with("parameters", {{"no_such_thing", 1}}), "no_such_thing");
  refused(with("measurement", {{"scan_scale", 7}}), "scan_scale");
  refused(with("from", 3), "list of texts");
  refused(with("surprise", 3), "surprise");
  MachineProfile placed = some_profile();
  placed.parameters["turn_deg"] = 3;
  CHECK_THROWS_AS(write_machine_profile(placed), Error);
}

}  // namespace
}  // namespace formwright
