// SPDX-License-Identifier: GPL-3.0-or-later
#include "thermoform/measured/measured_thickness.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <cmath>
#include <string>

#include "base/error.h"
#include "thermoform/forming.h"
#include "thermoform/measured/measured_object.h"
#include "thermoform/sheet/sheet_mesh.h"

namespace formwright {
namespace {

using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;

std::string refusal(const std::string& csv) {
  try {
    read_measured_thickness(as_bytes(csv));
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::invalid_input);
    CHECK(error.where() == "measured");
    return error.what();
  }
  return "not refused";
}

/// A flat sheet of 40 x 40 mm with a thickness of its own at each vertex.
template <class Thickness>
FormedSheet flat_sheet(Thickness&& thickness_mm, int triangles = 800) {
  const SheetMesh flat = make_sheet_mesh(Vec2(40, 40), triangles);
  FormedSheet sheet;
  sheet.sheet_mm = flat.flat_mm;
  sheet.mesh.F = flat.F;
  sheet.mesh.V.setZero(flat.flat_mm.rows(), 3);
  sheet.mesh.V.leftCols<2>() = flat.flat_mm;
  sheet.thickness_mm.resize(flat.flat_mm.rows());
  for (Eigen::Index v = 0; v < sheet.thickness_mm.size(); ++v)
    sheet.thickness_mm[v] = thickness_mm(Vec2(flat.flat_mm.row(v).transpose()));
  return sheet;
}

ThermoformOptions small_options() {
  ThermoformOptions o;
  o.sheet_x_mm = o.sheet_y_mm = 60;
  o.clamp_opening_x_mm = o.clamp_opening_y_mm = 40;
  o.sheet_thickness_mm = 0.8;
  return o;
}

TEST_CASE("MeasuredThickness.IsReadBesidePointsAndWithoutThem") {
  const std::string csv =
      "sheet_x_mm,sheet_y_mm,x_mm,y_mm,z_mm,sigma_mm,thickness_mm,thickness_sigma_mm\n"
      "10,20,10,20,1,0.3,0.9,0.02\n"
      "-10,20,-10,20,1,0.3,,\n"
      "-55,0,,,,,1.02,0\n"
      "-56,0,,,,,,\n";
  const auto readings = read_measured_thickness(as_bytes(csv));
  REQUIRE(readings.size() == 2);
  CHECK(readings[0].sheet_mm == Vec2(10, 20));
  CHECK(readings[0].thickness_mm == 0.9);
  CHECK(readings[0].sigma_mm == 0.02);
  CHECK(readings[1].sheet_mm == Vec2(-55, 0));
  CHECK(readings[1].sigma_mm == usual_thickness_sigma_mm);
  CHECK(read_measured_points(as_bytes(csv)).size() == 2);
  CHECK(read_measured_thickness(as_bytes(std::string("sheet_x_mm,sheet_y_mm,x_mm,y_mm,z_mm\n0,0,0,0,1\n"))).empty());
}

TEST_CASE("MeasuredThickness.WhatIsWrongIsSaid") {
  const std::string header = "sheet_x_mm,sheet_y_mm,thickness_mm,thickness_sigma_mm\n";
  CHECK(refusal(header + "0,0,1,0\n0,0,0,0\n").find("thickness 2: “thickness_mm” must be above zero") !=
        std::string::npos);
  CHECK(refusal(header + "0,0,1,-1\n").find("“thickness_sigma_mm” is negative") != std::string::npos);
  CHECK(refusal(header + "0,0,thin,0\n").find("line 2: “thickness_mm” is not a number") != std::string::npos);
}

TEST_CASE("MeasuredThickness.IsWrittenAsItIsRead") {
  const std::vector<MeasuredPoint> points{{Vec2(1, 2), Vec3(3, 4, 5), 0.1}, {Vec2(-1, 2), Vec3(-3, 4, 5), 0}};
  const std::vector<MeasuredThickness> readings{{Vec2(7.5, -8), 0.654, 0.03}, {Vec2(0, 0), 1.1, 0.05}};
  const std::string points_alone = write_measured_points(points);
  CHECK(add_measured_thickness(points_alone, {}) == points_alone);
  const std::string csv = add_measured_thickness(points_alone, readings);
  const auto points_again = read_measured_points(as_bytes(csv));
  REQUIRE(points_again.size() == 2);
  CHECK(points_again[1].place_mm == Vec3(-3, 4, 5));
  const auto again = read_measured_thickness(as_bytes(csv));
  REQUIRE(again.size() == 2);
  CHECK(again[0].sheet_mm == Vec2(7.5, -8));
  CHECK(again[0].thickness_mm == 0.654);
  CHECK(again[1].sigma_mm == 0.05);
}

TEST_CASE("MeasuredThickness.OfALinearFieldIsExactAndOfASmoothOneOfSecondOrder") {
  TextureCoordinates places(3, 2);
  places << 3.3, -7.1, -11.2, 0.4, 15.9, 16.3;
  const auto linear = [](const Vec2& p) { return 1 + 0.01 * p.x() - 0.005 * p.y(); };
  const Eigen::VectorXd exact = predict_thickness(flat_sheet(linear), places, small_options(), {});
  for (Eigen::Index i = 0; i < 3; ++i) CHECK_THAT(exact[i], WithinAbs(linear(places.row(i).transpose()), 1e-12));
  // A print that is 5 % too large: the sheet's true coordinates are 1.05 times those that are read.
  MeasurementEffects larger;
  larger.print_scale = 0.05;
  const Eigen::VectorXd scaled = predict_thickness(flat_sheet(linear), places, small_options(), larger);
  for (Eigen::Index i = 0; i < 3; ++i)
    CHECK_THAT(scaled[i], WithinAbs(linear(1.05 * places.row(i).transpose()), 1e-12));

  const auto smooth = [](const Vec2& p) { return 1 + 0.2 * std::sin(0.15 * p.x()) * std::cos(0.1 * p.y()); };
  TextureCoordinates many(400, 2);
  for (Eigen::Index i = 0; i < many.rows(); ++i)
    many.row(i) << 36 * (std::fmod(0.618034 * static_cast<double>(i), 1.0) - 0.5),
        36 * (static_cast<double>(i) / 400 - 0.5);
  const auto error = [&](int triangles) {
    const Eigen::VectorXd found = predict_thickness(flat_sheet(smooth, triangles), many, small_options(), {});
    double squares = 0;
    for (Eigen::Index i = 0; i < many.rows(); ++i) squares += std::pow(found[i] - smooth(many.row(i).transpose()), 2);
    return std::sqrt(squares / 400);
  };
  const double order = std::log(error(800) / error(12800)) / std::log(4.0);  // a quarter of the edge length
  CHECK(order > 1.8);
  CHECK(order < 2.3);
}

TEST_CASE("MeasuredThickness.TheRimIsAsItWasDelivered") {
  ThermoformOptions o = small_options();
  TextureCoordinates rim(2, 2);
  rim << 25, 0, 0, -25;
  const FormedSheet sheet = flat_sheet([](const Vec2&) { return 0.4; });
  CHECK(predict_thickness(sheet, rim, o, {})[0] == 0.8);
  o.thickness_wedge_x = 0.2;
  o.thickness_wedge_y = 0.1;
  const Eigen::VectorXd wedge = predict_thickness(sheet, rim, o, {});
  CHECK_THAT(wedge[0], WithinRel(0.8 * (1 + 0.2 * 1.25), 1e-12));
  CHECK_THAT(wedge[1], WithinRel(0.8 * (1 - 0.1 * 1.25), 1e-12));
}

}  // namespace
}  // namespace formwright
