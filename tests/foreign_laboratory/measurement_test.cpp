// SPDX-License-Identifier: GPL-3.0-or-later
#include "foreign_laboratory/measurement.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

namespace formwright::foreign_laboratory {
namespace {

using Catch::Matchers::WithinAbs, Catch::Matchers::WithinRel;
using Eigen::Vector2d, Eigen::Vector3d;

/// A sheet that was only stretched along x by a tenth and lies at z = 7, 0.8 mm thick.
FormedSheet plane() {
  FormedSheet sheet;
  sheet.grid = {8, 8, 220, 240};
  const int count = sheet.grid.node_count();
  sheet.place_mm = sheet.outward = Points::Zero(3, count);
  for (int node = 0; node < count; ++node)
    sheet.place_mm.col(node) << 1.1 * sheet.grid.flat_mm(node).x(), sheet.grid.flat_mm(node).y(), 7;
  sheet.outward.row(2).setOnes();
  sheet.thickness_mm = Eigen::VectorXd::Constant(count, 0.8);
  return sheet;
}

}  // namespace

TEST_CASE("Measurement.MarksAreOnTheOuterFaceWherePrintAndScanHaveThem") {
  const std::vector<Vector2d> marks = {{0, 0}, {50, -70}, {-101.5, 33}};
  Faults faults;
  faults.print_scale = 0.01, faults.print_stretch_x = -0.04, faults.print_stretch_y = 0.02;
  faults.scan_scale = -0.03, faults.scan_stretch_x = 0.05;
  faults.scan_shift_x_mm = 1, faults.scan_shift_y_mm = -2, faults.scan_shift_z_mm = 0.5;
  const Points exact = marked_places(plane(), marks, Faults{}), faulty = marked_places(plane(), marks, faults);
  for (std::size_t k = 0; k < marks.size(); ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    CHECK((exact.col(column) - Vector3d(1.1 * marks[k].x(), marks[k].y(), 7.4)).norm() < 1e-12);
    const Vector3d printed(1.05 * 1.1 * 1.01 * 0.96 * marks[k].x(), 1.01 * 1.02 * marks[k].y(), 7.4);
    CHECK((faulty.col(column) - (0.97 * printed + Vector3d(1, -2, 0.5))).norm() < 1e-12);
  }
  Faults odd;
  odd.print_skew = 0.1, odd.scan_bow_mm = 2;
  const Points bent = marked_places(plane(), {{50, -70}}, odd);  // printed at 43, -70
  CHECK((bent.col(0) - Vector3d(47.3, -70, 7.4 - 2 * (0.473 * 0.473 + 0.49))).norm() < 1e-12);
  odd = {};
  odd.scan_turn_z_deg = 90, odd.scan_shift_z_mm = 1;
  CHECK((marked_places(plane(), {{50, -70}}, odd).col(0) - Vector3d(70, 55, 8.4)).norm() < 1e-12);
}

TEST_CASE("Measurement.MarksCoverTheOpeningEvenly") {
  std::mt19937_64 random(3);
  const std::vector<Vector2d> marks = draw_marks(Machine{}, 2000, random);
  REQUIRE(marks.size() == 2000);
  int right = 0, back = 0;
  for (const Vector2d& mark : marks) {
    CHECK(std::abs(mark.x()) <= 0.48 * 220);
    CHECK(std::abs(mark.y()) <= 0.48 * 240);
    right += mark.x() > 0, back += mark.y() > 0;
  }
  CHECK(std::abs(right - 1000) < 60);
  CHECK(std::abs(back - 1000) < 60);
}

TEST_CASE("Measurement.NoiseHasTheStatedSizeAndOutliersTheStatedShare") {
  std::mt19937_64 random(4);
  const std::vector<Vector2d> marks = draw_marks(Machine{}, 20000, random);
  const FormedSheet sheet = plane();
  const Points exact = marked_places(sheet, marks, Faults{});
  double squares = 0;
  int far = 0, near = 0;
  const std::vector<MeasuredPoint> points = scan(sheet, marks, Faults{}, {.noise_mm = 0.2}, random);
  for (std::size_t k = 0; k < points.size(); ++k) {
    CHECK(points[k].sigma_mm == 0.2);  // the plane faces the scanner
    const double off = (points[k].place_mm - exact.col(static_cast<Eigen::Index>(k))).norm();
    if (off > 2) ++far;
    else squares += off * off, ++near;
  }
  CHECK_THAT(std::sqrt(squares / (3 * near)), WithinRel(0.2, 0.01));
  CHECK_THAT(far / 20000.0, WithinAbs(0.02, 0.004));
}

TEST_CASE("Measurement.TheSameRequestGivesTheSameBytesAndSaysWhatIsHidden") {
  Request request;
  request.mould = Mould::cone;
  request.cause = "print_skew";
  request.seed = 5;
  request.forming = {.cells = 8, .mass_scale = 30};
  request.scan.points = 100;
  const auto files = make_object(request);
  CHECK(files == make_object(request));
  REQUIRE(files.size() == 4);
  const auto truth = nlohmann::json::parse(files.at("truth.json"));
  CHECK(truth.at("cause") == "print_skew");
  CHECK(truth.at("in_the_list") == false);
  CHECK(std::abs(truth.at("values").at("print_skew").get<double>()) > 0.005);
  CHECK(truth.at("movement_mean_mm").get<double>() > 0.2);
  const auto setup = nlohmann::json::parse(files.at("setup.json"));
  CHECK(setup.at("vacuum_kpa") == 80);
  CHECK(setup.at("measured_surface") == "outer");
  const std::string& csv = files.at("measured.csv");
  CHECK(csv.starts_with("sheet_x_mm,sheet_y_mm,x_mm,y_mm,z_mm,sigma_mm\n"));
  CHECK(std::count(csv.begin(), csv.end(), '\n') == 101);
  CHECK(csv.find("nan") == std::string::npos);
  request.cause = "none";
  const auto clean = nlohmann::json::parse(make_object(request).at("truth.json"));
  CHECK(clean.at("movement_mean_mm") == 0);
  CHECK(clean.at("world") == truth.at("world"));
  CHECK(clean.at("sheet") == truth.at("sheet"));
}

TEST_CASE("Measurement.AnotherSheetOfTheSameWorldHasItsOwnMarksAndNoise") {
  Request request;
  request.forming = {.cells = 8, .mass_scale = 30};
  request.scan.points = 20;
  request.seed = 5;
  const auto first = make_object(request);
  request.seed = 77;
  request.world_seed = 5;
  const auto second = make_object(request);
  const auto world = [](const auto& files) { return nlohmann::json::parse(files.at("truth.json")).at("world"); };
  CHECK(world(first) == world(second));
  CHECK(first.at("setup.json") == second.at("setup.json"));
  CHECK(first.at("measured.csv") != second.at("measured.csv"));
  request.world_seed.reset();
  CHECK(world(make_object(request)) != world(first));
}

TEST_CASE("Measurement.AnotherDayIsALittleOtherForTheSameWorld") {
  Request request;
  request.forming = {.cells = 8, .mass_scale = 30};
  request.scan = {.points = 20, .noise_mm = 0, .outlier_share = 0};
  const auto usual = make_object(request);
  request.day_seed = 3;
  const auto other = make_object(request);
  const auto world = [](const auto& files) { return nlohmann::json::parse(files.at("truth.json")).at("world"); };
  CHECK(world(usual).at("warmer_k") == 0);
  CHECK(world(other).at("warmer_k") != 0);
  CHECK(world(other).at("relaxation_s") == world(usual).at("relaxation_s"));
  CHECK(usual.at("setup.json") == other.at("setup.json"));
  CHECK(usual.at("measured.csv") != other.at("measured.csv"));
  CHECK(other.at("measured.csv") == make_object(request).at("measured.csv"));
}

TEST_CASE("Measurement.HalfTheLevelIsHalfTheFault") {
  for (const std::string_view cause : cause_names) {
    std::mt19937_64 first(9), second(9);
    const auto strong = values_of(draw_faults(cause, 1, first)), medium = values_of(draw_faults(cause, 0.5, second));
    REQUIRE(strong.size() == medium.size());
    REQUIRE_FALSE(strong.empty());
    for (std::size_t k = 0; k < strong.size(); ++k)
      CHECK_THAT(medium[k].second, WithinRel(0.5 * strong[k].second, 1e-12));
  }
}

}  // namespace formwright::foreign_laboratory
