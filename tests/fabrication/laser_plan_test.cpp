// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/laser/laser_plan.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "base/error.h"
#include "fabrication/planned_laser_job.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;
using namespace test;

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

}  // namespace
}  // namespace formwright
