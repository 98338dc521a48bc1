// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/laser/laser_plan.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

#include "base/random.h"
#include "fabrication/sheet/contours.h"
#include "fabrication/writers/gcode_writer.h"
#include "fabrication/svg/svg_reader.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinULP;

CutPath box(double x, double y, double width, double height, const std::string& name = "",
            CutLayer layer = CutLayer::cut) {
  return {layer, {{x, y}, {x + width, y}, {x + width, y + height}, {x, y + height}}, true, name};
}

LaserPlan planned(std::vector<CutPath> paths, const LaserOptions& options) {
  Context context;
  return plan_laser_job({"t", 200, 150, std::move(paths)}, options, context);
}

std::vector<const ToolMove*> work_of(const LaserPlan& plan) {
  std::vector<const ToolMove*> work;
  for (const ToolMove& move : plan.path.moves)
    if (move.work) work.push_back(&move);
  return work;
}

double area_of(const ToolMove& move) {
  Polygon polygon;
  for (const Vec3& p : move.points_mm) polygon.push_back(p.head<2>());
  return signed_area_mm2(polygon);
}

TEST_CASE("LaserPlan.KerfGoesToTheSideThatKeepsItsSize") {
  LaserOptions options;
  options.kerf_mm = 0.2;
  const double grown = 100 * 80 + 2 * (100 + 80) * 0.1 + std::numbers::pi * 0.01, shrunk = 19.8 * 9.8;
  const auto areas = [&](KerfSide side) {
    options.kerf_side = side;
    const LaserPlan plan = planned({box(10, 10, 100, 80, "plate"), box(40, 40, 20, 10)}, options);
    const auto work = work_of(plan);
    CHECK(work.size() == 2u);
    CHECK(work[0]->part == "plate");
    CHECK(work[1]->part == "plate");
    return std::pair(-area_of(*work[0]), area_of(*work[1]));  // the opening first, clockwise
  };
  CHECK_THAT(areas(KerfSide::parts).first, WithinAbs(shrunk, 0.01));
  CHECK_THAT(areas(KerfSide::parts).second, WithinAbs(grown, 0.01));
  CHECK_THAT(areas(KerfSide::centre).first, WithinAbs(200, 1e-6));
  CHECK_THAT(areas(KerfSide::centre).second, WithinAbs(8000, 1e-6));
  CHECK_THAT(areas(KerfSide::openings).second, WithinAbs(99.8 * 79.8, 0.01));
}

TEST_CASE("LaserPlan.KerfThatTheDrawingHoldsIsNotAddedAgain") {
  // A plate of 100 x 80 with an opening of 20 x 10, drawn for a kerf of 0.15.
  Context context;
  CutSheet sheet{"t", 200, 150, {box(9.925, 9.925, 100.15, 80.15), box(40.075, 40.075, 19.85, 9.85)}, 0.15};
  const auto areas = [&](double kerf_mm, KerfSide side) {
    LaserOptions options;
    options.kerf_mm = kerf_mm;
    options.kerf_side = side;
    const LaserPlan plan = plan_laser_job(sheet, options, context);
    const auto work = work_of(plan);
    CHECK(work.size() == 2u);
    return std::pair(-area_of(*work[0]), area_of(*work[1]));
  };
  for (const double kerf : {0.1, 0.15, 0.3}) {
    const auto [opening, outline] = areas(kerf, KerfSide::parts);
    INFO(kerf);
    CHECK_THAT(opening, WithinAbs((20 - kerf) * (10 - kerf), 0.02));
    CHECK_THAT(outline, WithinAbs((100 + kerf) * (80 + kerf), 0.02));
  }
  CHECK_THAT(areas(0.3, KerfSide::openings).second, WithinAbs(99.7 * 79.7, 0.02));
  // The lines as they are, where that is asked for.
  CHECK_THAT(areas(0.3, KerfSide::centre).second, WithinAbs(100.15 * 80.15, 1e-6));
  CHECK_THAT(areas(0, KerfSide::parts).second, WithinAbs(100.15 * 80.15, 1e-6));
  // What we write says it, whoever reads it.
  const SvgDrawing again = read_svg_drawing(write_svg(sheet), {}, context);
  CHECK_THAT(again.sheet.kerf_mm, WithinULP(0.15, 4));
  CHECK_THAT(side_by_side({sheet, sheet}, 20).kerf_mm, WithinULP(0.15, 4));
  CHECK(read_svg_drawing(write_svg(sheet), {0.01, UserUnit::inch}, context).sheet.kerf_mm == 0);
  sheet.kerf_mm = 0;
  CHECK(read_svg_drawing(write_svg(sheet), {}, context).sheet.kerf_mm == 0);
}

TEST_CASE("LaserPlan.WhatLiesBehindAMouthNarrowerThanTheKerfIsCut") {
  // A plate whose 10 x 10 window opens to its edge by a slit 0.05 wide.
  const CutPath keyhole{CutLayer::cut,
                        {{10, 10},
                         {70, 10},
                         {70, 29.975},
                         {60, 29.975},
                         {60, 25},
                         {50, 25},
                         {50, 35},
                         {60, 35},
                         {60, 30.025},
                         {70, 30.025},
                         {70, 50},
                         {10, 50}},
                        true,
                        "plate"};
  LaserOptions options;
  options.kerf_mm = 0.1;
  options.tabs_count = 2;
  const LaserPlan plan = planned({keyhole}, options);
  const auto work = work_of(plan);
  REQUIRE(work.size() == 4u);  // the window first and whole, then the outline in three pieces between its tabs
  CHECK(work[0]->part == "plate");
  CHECK_THAT(-area_of(*work[0]), WithinAbs(9.9 * 9.9, 0.02));
  REQUIRE_FALSE(plan.notes.empty());
  CHECK(plan.notes.back().find("mouth narrower than the kerf") != std::string::npos);
}

TEST_CASE("LaserPlan.OvercutLeavesTheTabsStanding") {
  LaserOptions options;
  options.kerf_mm = 0.1;
  options.tabs_count = 12;
  options.tab_width_mm = 0.5;
  options.overcut_mm = 2;
  options.free_start = false;
  const LaserPlan plan = planned({box(10, 10, 10, 10)}, options);
  const Vec2 first = work_of(plan).front()->points_mm.front().head<2>();
  Polygon ring = offset_polygon(box(10, 10, 10, 10).points_mm, 0.05).at(0);
  std::rotate(ring.begin(),
              std::min_element(ring.begin(), ring.end(),
                               [&](const Vec2& a, const Vec2& b) { return (a - first).norm() < (b - first).norm(); }),
              ring.end());
  const double length = path_length_mm(ring, true);
  double burned = 0;
  for (const ToolMove* move : work_of(plan))
    for (std::size_t i = 1; i < move->points_mm.size(); ++i)
      burned += (move->points_mm[i] - move->points_mm[i - 1]).norm();
  const auto middles = place_tabs(ring, 12, 0.6);
  REQUIRE(middles.size() == 12u);
  CHECK_THAT(burned, WithinAbs(length - 12 * 0.6 + (middles[0] - 0.3), 0.01));
  CHECK(middles[0] - 0.3 < 2);
}

TEST_CASE("LaserPlan.InsidesComeFirstAndPartsAreFinishedTogether") {
  // Three plates with two openings each, one of which holds another part with an opening.
  std::vector<CutPath> paths;
  for (int i = 0; i < 3; ++i) {
    const double x = 5 + 60 * i;
    const std::string name = "p" + std::to_string(i);
    paths.push_back(box(x, 5, 50, 100, name));
    paths.push_back(box(x + 5, 10, 40, 40));
    paths.push_back(box(x + 10, 15, 20, 20, name + "-inner"));
    paths.push_back(box(x + 15, 20, 5, 5));
    paths.push_back(box(x + 5, 60, 10, 10));
    paths.push_back({CutLayer::cut, {{x + 20, 70}, {x + 40, 70}}, false, ""});  // a slit
  }
  LaserOptions options;
  const LaserPlan plan = planned(paths, options);
  const auto work = work_of(plan);
  REQUIRE(work.size() == 18u);
  std::vector<int> plates;
  std::vector<double> size;
  for (const ToolMove* move : work) {
    plates.push_back(static_cast<int>((move->points_mm[0].x() - 2) / 60));
    size.push_back(std::abs(area_of(*move)));
  }
  for (std::size_t i = 0; i < 18; i += 6) {
    for (std::size_t k = i; k < i + 6; ++k) {
      INFO("a part is left unfinished");
      CHECK(plates[k] == plates[i]);
    }
    CHECK(size[i + 5] > 4900);  // the outline last
    const auto at = [&](double area) {
      return std::find_if(size.begin() + static_cast<long>(i), size.begin() + static_cast<long>(i) + 6,
                          [&](double s) { return std::abs(s - area) < 0.1 * area + 1; }) -
             size.begin();
    };
    CHECK(at(25) < at(400));
    CHECK(at(400) < at(1600));
  }
}

TEST_CASE("LaserPlan.EngraveThenMarkThenCutAndNotesNever") {
  std::vector<CutPath> paths{box(10, 10, 20, 20), box(12, 12, 5, 5, "", CutLayer::engrave),
                             box(20, 20, 5, 5, "", CutLayer::mark), box(0, 0, 200, 150, "", CutLayer::note)};
  LaserOptions options;
  const LaserPlan plan = planned(paths, options);
  std::vector<std::string> layers;
  for (const ToolMove* move : work_of(plan)) layers.push_back(move->layer);
  CHECK(layers == std::vector<std::string>{"engrave", "mark", "cut"});
  for (const ToolMove* move : work_of(plan)) CHECK(move->points_mm[0].x() < 40);
  options.mark_enabled = false;
  CHECK(work_of(planned(paths, options)).size() == 2u);
  options.take_as = TakeAs::cut;
  CHECK(work_of(planned(paths, options)).size() == 3u);
  CHECK_THROWS_AS(planned({paths[3]}, options), Error);
}

TEST_CASE("LaserPlan.TabsAreLeftInTheLastPassAwayFromCorners") {
  LaserOptions options;
  options.kerf_mm = 0.2;
  options.tabs_count = 4;
  options.tab_width_mm = 1;
  options.cut_passes = 3;
  options.overcut_mm = 2;
  const LaserPlan plan = planned({box(10, 10, 100, 80), box(40, 40, 20, 10)}, options);
  double burned[4] = {0, 0, 0, 0};
  std::vector<Vec2> gaps;
  for (std::size_t m = 0; m < plan.path.moves.size(); ++m) {
    const ToolMove& move = plan.path.moves[m];
    if (!move.work || (move.points_mm[0].head<2>() - Vec2(50, 45)).norm() < 20) continue;  // the outline only
    for (std::size_t i = 1; i < move.points_mm.size(); ++i)
      burned[move.pass] += (move.points_mm[i] - move.points_mm[i - 1]).norm();
  }
  const double round_trip = 360 + 0.2 * std::numbers::pi;
  CHECK_THAT(burned[1], WithinAbs(round_trip, 0.01));
  CHECK_THAT(burned[2], WithinAbs(round_trip, 0.01));
  CHECK_THAT(burned[3],
             WithinAbs(round_trip + 2 - 4 * 1.2, 0.02));  // what stands is as wide as asked for once the kerf is off
  const Polygon outline{{10, 10}, {110, 10}, {110, 90}, {10, 90}};
  const auto middles = place_tabs(outline, 4, 1.2);
  REQUIRE(middles.size() == 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    for (const double corner : {0.0, 100.0, 180.0, 280.0, 360.0}) CHECK(std::abs(middles[i] - corner) >= 1.2);
    CHECK_THAT(middles[i], WithinAbs(45 + 90 * static_cast<double>(i), 22.5));
  }
  CHECK(place_tabs(outline, 100, 1.2).size() == 75u);
}

TEST_CASE("LaserPlan.PassesAreRunAndGoDeeper") {
  LaserOptions options;
  options.cut_passes = 3;
  options.cut_step_down_mm = 0.5;
  const LaserPlan plan = planned({box(10, 10, 20, 20), {CutLayer::cut, {{50, 50}, {80, 50}}, false, ""}}, options);
  const auto work = work_of(plan);
  REQUIRE(work.size() == 6u);
  for (const ToolMove* move : work)
    for (const Vec3& p : move->points_mm) CHECK_THAT(p.z(), WithinAbs(-0.5 * (move->pass - 1), 1e-12));
  for (const ToolMove& move : plan.path.moves)
    if (!move.work && (move.points_mm.front().head<2>() - move.points_mm.back().head<2>()).norm() > 1) {
      CHECK(move.points_mm.back().z() == 0);
    }
}

TEST_CASE("LaserPlan.PlacingTurnsAndMirrors") {
  LaserOptions options;
  options.kerf_mm = 0;
  options.x_mm = 20;
  options.y_mm = 30;
  options.turn_degrees = 90;
  const auto bounds = work_bounds(planned({box(10, 20, 30, 40)}, options).path);
  // The page is 200 x 150; turned by 90 degrees its upper left corner is the lower left one.
  CHECK_THAT(bounds.x0_mm, WithinAbs(20 + 150 - 60, 1e-9));
  CHECK_THAT(bounds.x1_mm, WithinAbs(20 + 150 - 20, 1e-9));
  CHECK_THAT(bounds.y0_mm, WithinAbs(30 + 10, 1e-9));
  CHECK_THAT(bounds.y1_mm, WithinAbs(30 + 40, 1e-9));
  options.turn_degrees = 0;
  options.mirrored = true;
  CHECK_THAT(work_bounds(planned({box(10, 20, 30, 40)}, options).path).x0_mm, WithinAbs(20 + 200 - 40, 1e-9));
}

TEST_CASE("LaserPlan.WhatDoesNotFitIsSaid") {
  LaserOptions options;
  options.kerf_mm = 0.2;
  options.bed_x_mm = 200;
  options.bed_y_mm = 150;
  CHECK(planned({box(0.2, 0.2, 199.6, 149.6)}, options).misfits.empty());
  const auto beyond =
      planned({box(0, 0.3, 100, 100)}, options).misfits;  // half the kerf and half of it again burn over the edge
  REQUIRE(beyond.size() == 1u);
  {
    INFO(beyond[0]);
    CHECK(beyond[0].find("0.2 mm beyond the left edge") != std::string::npos);
  }
  options.no_go = "150,0,160,150";
  CHECK(planned({box(10, 10, 139.7, 20)}, options).misfits.empty());
  CHECK(planned({box(10, 10, 139.9, 20, "left")}, options).misfits.at(0).substr(0, 9) == "Part left");
  CHECK(planned({box(170, 10, 20, 20)}, options).misfits.at(0).substr(0, 8) == "A travel");
  options.no_go = "1,2,3";
  CHECK_THROWS_AS(planned({box(10, 10, 20, 20)}, options), Error);
}

/// G-code read back word by word.
struct Machine {
  Vec2 at{0, 0};
  double s = 0, burned_mm = 0;
  int longest = 0;
  std::vector<Vec2> path;

  void run(std::string_view text) {
    while (!text.empty()) {
      const std::string_view line = text.substr(0, text.find('\n'));
      text.remove_prefix(line.size() + 1);
      longest = std::max(longest, static_cast<int>(line.size()));
      if (line.starts_with(';')) continue;
      Vec2 to = at;
      bool rapid = false, feed = false;
      for (std::size_t i = 0; i < line.size(); ++i) {
        // Cut out first: strtod would read "0X5" as hexadecimal, and not every library's from_chars knows numbers with
        // a point.
        const std::size_t end = std::min(line.find_first_not_of("+-.0123456789", i + 1), line.size());
        const double value = std::strtod(std::string(line.substr(i + 1, end - i - 1)).c_str(), nullptr);
        if (line[i] == 'G') rapid = value == 0, feed = value == 1;
        if (line[i] == 'X') to.x() = value;
        if (line[i] == 'Y') to.y() = value;
        if (line[i] == 'S') s = value;
        i = end;
      }
      if (rapid && to != at) {
        INFO("burns while it travels: " << line);
        CHECK(s == 0);
      }
      if (feed && s > 0) burned_mm += (to - at).norm();
      if (rapid || feed) path.push_back(to);
      at = to;
    }
  }
};

/// M5 before a first rapid that names x and y, and after the last stroke.
void expect_dark_ends(std::string_view text) {
  const std::size_t rapid = text.find("\nG0 "), stroke = text.find("\nG1 "), on = text.find("\nM4");
  REQUIRE(rapid != std::string_view::npos);
  CHECK(text.find("\nM5\n") < rapid);
  CHECK(rapid < on);
  CHECK(on < stroke);
  const std::string_view line = text.substr(rapid + 1, text.find('\n', rapid + 1) - rapid - 1);
  {
    INFO(line);
    CHECK(line.find('X') != std::string_view::npos);
    CHECK(line.find('Y') != std::string_view::npos);
  }
  CHECK(text.rfind("\nM5\n") > text.rfind("\nG1 "));
}

TEST_CASE("LaserPlan.AJobThatBeginsAtTheOriginGoesThereFirst") {
  LaserOptions options;
  for (const Controller controller : {Controller::grbl, Controller::marlin}) {
    options.controller = controller;
    LaserPlan plan = planned({{CutLayer::cut, {{0, 0}, {50, 0}, {50, 20}}, false, ""}}, options);
    REQUIRE(plan.path.moves.front().work);
    const Bytes gcode = write_laser_gcode(plan.path, options);
    expect_dark_ends(as_text(gcode));
    INFO(as_text(gcode));
    CHECK(as_text(gcode).find("\nG0 X0 Y0\nM4") != std::string_view::npos);
  }
}

TEST_CASE("LaserPlan.GcodeIsTheToolPathForEveryOrigin") {
  Random random(17);
  std::vector<CutPath> paths;
  for (int i = 0; i < 60; ++i) {
    CutPath path{static_cast<CutLayer>(random.below(3)), {}, random.below(2) == 0, ""};
    const Vec2 middle(random.uniform(20, 180), random.uniform(20, 130));
    const int corners = 3 + static_cast<int>(random.below(40));
    for (int k = 0; k < corners; ++k) {
      const double angle = 2 * std::numbers::pi * k / corners, radius = random.uniform(2, 15);
      path.points_mm.emplace_back(middle + radius * Vec2(std::cos(angle), std::sin(angle)));
    }
    paths.push_back(std::move(path));
  }
  for (const BedOrigin origin : {BedOrigin::lower_left, BedOrigin::upper_left, BedOrigin::centre})
    for (const Controller controller : {Controller::grbl, Controller::marlin}) {
      LaserOptions options;
      options.origin = origin;
      options.controller = controller;
      options.bed_x_mm = 333.3;
      LaserPlan plan = planned(paths, options);
      const Bytes gcode = write_laser_gcode(plan.path, options);
      expect_dark_ends(as_text(gcode));
      Machine machine;
      if (controller == Controller::grbl) {
        machine.run(as_text(gcode));
        CHECK_THAT(machine.burned_mm, WithinAbs(plan.path.length_mm(true), 1e-6));
        std::size_t at = 0;
        for (const ToolMove& move : plan.path.moves)
          for (std::size_t i = 1; i < move.points_mm.size(); ++i, ++at) {
            // The bed's middle is at half a micrometre: rounding once is all there may be.
            CHECK((machine.path.at(at) - to_controller(move.points_mm[i].head<2>(), options)).cwiseAbs().maxCoeff() <=
                  5.001e-4);
          }
        CHECK(at + 1 == machine.path.size());  // and the last line, back to the origin
        CHECK(machine.longest <= 80);
      }
      // Lines are those that move to the points.
      std::vector<std::string> lines;
      for (std::string_view rest = as_text(gcode); !rest.empty(); rest.remove_prefix(rest.find('\n') + 1))
        lines.emplace_back(rest.substr(0, rest.find('\n')));
      CHECK(line_count(gcode) == static_cast<int>(lines.size()));
      for (const ToolMove& move : plan.path.moves)
        for (std::size_t i = 1; i < move.points_mm.size(); ++i)
          CHECK(lines.at(static_cast<std::size_t>(move.lines.at(i)) - 1).substr(0, 3) == (move.work ? "G1 " : "G0 "));
    }
}

}  // namespace
}  // namespace formwright
