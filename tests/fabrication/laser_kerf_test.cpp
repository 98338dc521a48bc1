// SPDX-License-Identifier: GPL-3.0-or-later
// On which side of its line a laser cuts, and what tabs leave standing.
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>
#include <vector>

#include "fabrication/laser/laser_plan.h"
#include "fabrication/planned_laser_job.h"
#include "fabrication/sheet/contours.h"
#include "fabrication/svg/svg_reader.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinULP;
using namespace test;

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

}  // namespace
}  // namespace formwright
