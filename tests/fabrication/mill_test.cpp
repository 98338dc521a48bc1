// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <functional>

#include "base/random.h"
#include "fabrication/writers/gcode_writer.h"
#include "fabrication/mill/mill_lines.h"
#include "fabrication/mill/mill_plan.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinULP;

HeightField field(int columns, int rows, double pitch_mm, const std::function<double(double, double)>& z) {
  HeightField result{columns, rows, pitch_mm, pitch_mm, {}};
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) result.z_mm.push_back(static_cast<float>(z(c * pitch_mm, r * pitch_mm)));
  return result;
}

/// Hills, a wall, a hole and a spike.
HeightField rugged(std::uint64_t seed) {
  Random random(seed);
  const double fx = random.uniform(0.2, 0.6), fy = random.uniform(0.2, 0.6), wall = random.uniform(4, 8);
  return field(80, 60, 0.2, [&](double x, double y) {
    double z = -2.2 + 1.5 * std::sin(fx * x) * std::cos(fy * y) + random.uniform(0, 0.15);
    if (x > wall && x < wall + 2) z = -0.2;
    if ((x - 3) * (x - 3) + (y - 9) * (y - 9) < 2) z = -4;
    if (std::abs(x - 12) < 0.15 && std::abs(y - 4) < 0.15) z = 0;
    return std::min(z, 0.0);
  });
}

MillOptions small(ToolShape shape, double diameter) {
  MillOptions options;
  options.tool = options.rough_tool = shape;
  options.diameter_mm = options.rough_diameter_mm = diameter;
  options.step_down_mm = 0.9;
  options.safe_height_mm = 3;
  return options;
}

TEST_CASE("Mill.ToolsHaveTheirProfiles") {
  CHECK_THAT((MillTool{ToolShape::ball, 6, 0, 0}).profile_mm(3), WithinAbs(3, 1e-12));
  CHECK_THAT((MillTool{ToolShape::ball, 10, 0, 0}).profile_mm(3), WithinAbs(1, 1e-12));
  CHECK((MillTool{ToolShape::flat, 6, 0, 0}).profile_mm(2.9) == 0);
  CHECK_THAT((MillTool{ToolShape::v, 6, 90, 0.4}).profile_mm(2.2), WithinAbs(2, 1e-12));
  CHECK((MillTool{ToolShape::v, 6, 90, 0.4}).profile_mm(0.1) == 0);
  CHECK(std::isinf((MillTool{ToolShape::flat, 6, 0, 0}).profile_mm(3.1)));
}

TEST_CASE("Mill.LowestTipsAreWhatTryingAllNodesGives") {
  const HeightField surface = rugged(1);
  for (const ToolShape shape : {ToolShape::ball, ToolShape::v, ToolShape::flat}) {
    const MillTool tool{shape, 1.9, 50, 0.1};
    const HeightField tips = lowest_tips(surface, footprint(tool, surface), Context());
    Random random(2);
    for (int i = 0; i < 300; ++i) {
      const int r = static_cast<int>(random.below(60)), c = static_cast<int>(random.below(80));
      double lowest = -1e9;
      for (int y = 0; y < 60; ++y)
        for (int x = 0; x < 80; ++x)
          if (const double d = 0.2 * std::sqrt((x - c) * (x - c) + (y - r) * (y - r)); d <= 0.95 * (1 + 1e-12))
            lowest = std::max(lowest, surface.at(y, x) - tool.profile_mm(std::min(d, 0.95)));
      CHECK_THAT(tips.at(r, c), WithinAbs(lowest, 1e-5));
    }
  }
}

TEST_CASE("Mill.NothingIsCutIntoAnywhereAlongThePath") {
  for (const ToolShape shape : {ToolShape::ball, ToolShape::v, ToolShape::flat})
    for (const RasterAlong along : {RasterAlong::x, RasterAlong::y}) {
      const HeightField surface = rugged(static_cast<std::uint64_t>(shape) + 3);
      MillOptions options = small(shape, 1.6);
      options.finish_along = along;
      options.finish_stepover_percent = 30;
      Context context;
      const MillPlan plan = plan_mill_job(surface, options, context);
      // Every move in small steps, against every node; the rim is taken back by as much as it moves sideways between
      // two half nodes.
      const MillTool tool{shape, 1.6 - 0.01, options.v_angle_degrees, options.v_tip_mm};
      double deepest_cut = 0;
      for (const ToolMove& move : plan.path.moves)
        for (std::size_t i = 1; i < move.points_mm.size(); ++i) {
          const Vec3 a = move.points_mm[i - 1], b = move.points_mm[i];
          const int steps = std::max(1, static_cast<int>(std::ceil((b - a).head<2>().norm() / 0.05)));
          for (int s = 0; s <= steps; ++s) {
            const Vec3 p = a + (b - a) * s / steps;
            for (int r = std::max(0, static_cast<int>((p.y() - 0.8) / 0.2));
                 r < std::min(60.0, (p.y() + 0.8) / 0.2 + 1); ++r)
              for (int c = std::max(0, static_cast<int>((p.x() - 0.8) / 0.2));
                   c < std::min(80.0, (p.x() + 0.8) / 0.2 + 1); ++c) {
                const double over = tool.profile_mm(
                    std::sqrt((c * 0.2 - p.x()) * (c * 0.2 - p.x()) + (r * 0.2 - p.y()) * (r * 0.2 - p.y())));
                deepest_cut = std::max(deepest_cut, surface.at(r, c) - (p.z() + over));
              }
          }
        }
      // Between half nodes (p / 2)^2 / 8 times R^2 / (R^2 - (0.7 R)^2)^1.5 of a ball; between quarters p / 16 times the
      // slope of a V.
      const double bound = shape == ToolShape::ball ? 0.00125 / (0.8 * 0.364)
                           : shape == ToolShape::v  ? 0.0125 / 0.577
                                                    : 0;
      {
        INFO(static_cast<int>(shape));
        CHECK(deepest_cut < bound + 0.002);
      }
      for (std::size_t i = 0; i < surface.z_mm.size(); ++i) CHECK(plan.carved.z_mm[i] >= surface.z_mm[i] - 1e-5f);
      CHECK(plan.deviation.mean_mm >= 0);
      REQUIRE(plan.of_tool);
      CHECK(plan.of_tool->mean_mm <= plan.deviation.mean_mm + 1e-6);
    }
}

TEST_CASE("Mill.RidgesOnAPlaneAreTheFormulas") {
  for (const double diameter : {2.0, 3.0, 6.0}) {
    MillOptions options = small(ToolShape::ball, diameter);
    options.stages = MillStages::finish;
    options.finish_stepover_percent = 100 * 0.8 / diameter;
    Context context;
    const MillPlan plan = plan_mill_job(field(61, 61, 0.1, [](double, double) { return -1; }), options, context);
    CHECK_THAT(plan.finish_stepover_mm, WithinAbs(0.8, 1e-9));
    double ridge = 0;
    for (int r = 8; r <= 52; ++r) ridge = std::max<double>(ridge, plan.carved.at(r, 30) + 1);
    CHECK_THAT(ridge, WithinAbs(scallop_mm(diameter, 0.8), 1e-5));
    CHECK_THAT(ridge, WithinAbs(0.8 * 0.8 / 4 / diameter, 0.05 * ridge));  // s^2 / 8 R
    CHECK_THAT(plan.carved.at(8, 30), WithinAbs(-1, 1e-5));
    CHECK_THAT(plan.of_tool->max_mm, WithinAbs(0, 1e-5));
  }
}

TEST_CASE("Mill.RidgesOnASphereConvergeToTheFormulas") {
  // Two balls of radius R beside the top of a dome of radius A, their middles on A + R; and in a bowl, on A - R.
  // A hundred times larger than what is carved, so that the whole micrometres of the path do not count.
  const double ball = 150, sphere = 2000, stepover = 80;
  for (const bool dome : {true, false}) {
    const double middles = dome ? sphere + ball : sphere - ball;
    const double sine = stepover / 2 / middles, reach = std::sqrt(ball * ball - stepover * stepover / 4),
                 up = middles * std::sqrt(1 - sine * sine);
    const double ridge = dome ? up - reach - sphere : sphere - (up + reach);
    double before = 0;
    for (const int fineness : {1, 2, 4}) {
      const double pitch = 10.0 / fineness;
      const int side = 80 * fineness + 1;  // lines on whole steps; the middle of the field is between two of them
      const double centre = 440;
      const HeightField surface = field(side, side, pitch, [&](double x, double y) {
        const double d = (x - centre) * (x - centre) + (y - centre) * (y - centre);
        return dome ? std::sqrt(sphere * sphere - d) - sphere - 50 : sphere - std::sqrt(sphere * sphere - d) - 200;
      });
      MillOptions options = small(ToolShape::ball, 2 * ball);
      options.stages = MillStages::finish;
      options.finish_stepover_percent = 50 * stepover / ball;
      options.path_tolerance_mm = 0.001;
      Context context;
      const MillPlan plan = plan_mill_job(surface, options, context);
      const int at = static_cast<int>(std::lround(centre / pitch));
      CHECK(at % static_cast<int>(std::lround(stepover / pitch)) == static_cast<int>(std::lround(40 / pitch)));
      const double error = std::abs(plan.carved.at(at, at) - surface.at(at, at) - ridge);
      {
        INFO(dome << fineness);
        CHECK(error < 0.15 * ridge / fineness);
      }
      if (fineness > 1) {
        CHECK(error < 0.7 * before + 1e-3);
      }
      before = error;
    }
  }
}

/// Spindle off, up to the safe height, over to a place whose x and y are both named, and only then the spindle and
/// down.
void expect_safe_beginning(std::string_view text, double safe_height_mm) {
  std::vector<std::string> lines;
  for (std::string_view rest = text; !rest.empty(); rest.remove_prefix(rest.find('\n') + 1))
    lines.emplace_back(rest.substr(0, rest.find('\n')));
  const auto at = [&](const std::function<bool(const std::string&)>& is) {
    return std::find_if(lines.begin(), lines.end(), is) - lines.begin();
  };
  const auto motion = at([](const std::string& line) { return line.starts_with("G0") || line.starts_with("G1 "); });
  const auto place = at([](const std::string& line) {
    return line.starts_with("G0") && line.find('X') != std::string::npos && line.find('Y') != std::string::npos;
  });
  const auto spindle = at([](const std::string& line) { return line.starts_with("M3"); });
  const auto work = at([](const std::string& line) { return line.starts_with("G1 "); });
  CHECK(at([](const std::string& line) { return line == "M5"; }) < motion);
  CHECK(lines[static_cast<std::size_t>(motion)].substr(0, 4) == "G0 Z");
  CHECK_THAT(std::stod(lines[static_cast<std::size_t>(motion)].substr(4)), WithinULP(safe_height_mm, 4));
  CHECK(motion < place);
  CHECK(place < spindle);
  CHECK(spindle < work);
  for (auto i = motion; i < place; ++i) CHECK(lines[static_cast<std::size_t>(i)].find('X') == std::string::npos);
  const auto last = std::find_if(lines.rbegin(), lines.rend(), [](const std::string& line) {
    return line.starts_with("G1 ") || line.starts_with("M");
  });
  {
    INFO(*last);
    CHECK((*last == "M2" || *last == "M5"));
  }
  CHECK(text.rfind("\nM5\n") != std::string_view::npos);
  CHECK(text.rfind("\nM5\n") > text.rfind("\nG1 "));
}

TEST_CASE("Mill.EntriesAreRampsAndFastMovesStayOverTheMaterial") {
  const HeightField surface = field(101, 61, 0.2, [](double x, double y) {
    return -2 + 0.5 * std::sin(0.1 * x) - 1.5 * std::exp(-0.1 * ((x - 9) * (x - 9) + (y - 6) * (y - 6)));
  });
  MillOptions options = small(ToolShape::flat, 1.6);
  options.ramp_degrees = 4;
  options.tool = ToolShape::ball;
  Context context;
  MillPlan plan = plan_mill_job(surface, options, context);
  CHECK(plan.layers >= 3);
  REQUIRE(plan.path.stages.size() == 2u);
  double reached = 0;
  int last_layer = 0;
  for (const ToolMove& move : plan.path.moves)
    for (std::size_t i = 1; i < move.points_mm.size(); ++i) {
      const Vec3 run = move.points_mm[i] - move.points_mm[i - 1];
      if (!move.work) {
        if (run.head<2>().norm() > 0) {
          CHECK(std::min(move.points_mm[i].z(), move.points_mm[i - 1].z()) >= options.safe_height_mm);
        }
      } else if (move.speed_mm_per_s == options.plunge_speed_mm_per_s) {
        const double steepest = std::tan(4.01 * 3.14159265 / 180);
        if (run.z() < -0.02) {
          CHECK(-run.z() <= steepest * std::max(run.head<2>().norm(), 0.2) + 0.002);
        }
      }
      if (move.layer == "rough") {
        CHECK(move.points_mm[i].z() >= -options.step_down_mm * move.pass - 1e-9);
        CHECK(move.pass >= last_layer);
        last_layer = move.pass;
      }
      reached = std::min(reached, move.points_mm[i].z());
    }
  CHECK(reached >= -4.001);
  const Bytes rough = write_mill_gcode(plan.path, options, 9000, 0),
              finish = write_mill_gcode(plan.path, options, 9000, 1);
  CHECK(as_text(rough).find("; layer finish") == std::string_view::npos);
  CHECK(as_text(finish).find("; layer rough") == std::string_view::npos);
  for (const Bytes& job : {rough, finish}) expect_safe_beginning(as_text(job), options.safe_height_mm);
  // Each stage begins and ends over the origin; the second goes on where the first ends in time.
  const ToolpathStage& second = plan.path.stages[1];
  CHECK(second.file == "job_2_finish.gcode");
  CHECK_THAT(second.start_s, WithinULP(plan.path.moves[second.first_move - 1].times_s.back(), 4));
  CHECK(plan.path.moves[second.first_move - 1].points_mm.back() == Vec3(0, 0, options.safe_height_mm));
  CHECK(plan.path.moves[second.first_move].points_mm.front() == Vec3(0, 0, 0));
  CHECK(plan.path.moves[second.first_move].points_mm[1] == Vec3(0, 0, options.safe_height_mm));
}

TEST_CASE("Mill.AJobThatBeginsAtTheOriginGoesThereFirst") {
  const HeightField surface = field(41, 41, 0.2, [](double, double) { return -1.0; });
  MillOptions options = small(ToolShape::flat, 1.6);
  options.x_mm = options.y_mm = 0;
  for (const Controller controller : {Controller::grbl_mill, Controller::marlin}) {
    options.controller = controller;
    Context context;
    MillPlan plan = plan_mill_job(surface, options, context);
    expect_safe_beginning(as_text(write_mill_gcode(plan.path, options, 9000)), options.safe_height_mm);
  }
}

TEST_CASE("Mill.RoughingLeavesTheAllowanceAndFinishingTakesIt") {
  const HeightField surface =
      field(101, 81, 0.2, [](double x, double y) { return -2 + std::sin(0.3 * x) * std::sin(0.3 * y); });
  MillOptions options = small(ToolShape::ball, 2);
  options.allowance_mm = 0.4;
  options.rough_stepover_percent = 10;
  options.stages = MillStages::rough;
  Context context;
  const MillPlan rough = plan_mill_job(surface, options, context);
  CHECK_THAT(rough.deviation.mean_mm, WithinAbs(0.41, 0.04));
  CHECK(*std::min_element(rough.carved.z_mm.begin(), rough.carved.z_mm.end()) >= -3 + 0.4 - 1e-3);
  options.stages = MillStages::both;
  options.finish_stepover_percent = 10;
  const MillPlan both = plan_mill_job(surface, options, context);
  CHECK(both.deviation.p95_mm < 0.015);
  for (int r = 5; r < 76; ++r)  // a border of the tool's radius is reached from one side only
    for (int c = 5; c < 96; ++c) CHECK(both.carved.at(r, c) - surface.at(r, c) < 0.03);
}

TEST_CASE("Mill.WhatNeedsNoRoughingSaysWhichToolToMount") {
  const HeightField surface = field(61, 41, 0.2, [](double x, double) { return -0.1 + 0.1 * std::sin(0.3 * x); });
  MillOptions options = small(ToolShape::ball, 2);
  options.rough_diameter_mm = 4;
  options.allowance_mm = 0.3;
  Context context;
  const MillPlan plan = plan_mill_job(surface, options, context);
  CHECK(plan.rough_seconds == 0);
  CHECK(plan.path.stages.empty());
  REQUIRE_FALSE(plan.notes.empty());
  CHECK(plan.notes.back().find("mount the finishing tool") != std::string::npos);
}

TEST_CASE("Mill.RampsComeToAnEndOnEverySlope") {
  for (const double slope : {0.0, 0.05, 0.0874, 0.1, 1.0, 20.0})
    for (const double degrees : {1.0, 5.0, 45.0, 90.0}) {
      const HeightField surface =
          field(301, 5, 0.1, [&](double x, double) { return std::max(-30.0, -0.5 - slope * std::abs(x - 11)); });
      MillOptions options = small(ToolShape::flat, 1);
      options.ramp_degrees = degrees;
      options.step_down_mm = 3;
      Context context;
      const MillPlan plan = plan_mill_job(surface, options, context);
      CHECK(plan.path.length_mm(true) > 30);
      CHECK(plan.path.length_mm(true) < 30'000);
    }
}

/// How far the polyline passes over the points, at most; it must not pass below.
double passes_over(const std::vector<Vec3>& kept, const std::vector<Vec3>& points) {
  double over = 0;
  std::size_t segment = 1;
  for (const Vec3& p : points) {
    while (kept[segment].x() < p.x()) ++segment;
    const Vec3 &a = kept[segment - 1], &b = kept[segment];
    const double z = a.z() + (b.z() - a.z()) * (p.x() - a.x()) / (b.x() - a.x());
    CHECK(z >= p.z() - 1e-9);
    over = std::max(over, z - p.z());
  }
  return over;
}

TEST_CASE("Mill.ThinningNeverGoesBelow") {
  Random random(4);
  std::vector<Vec3> points;
  for (int i = 0; i < 500; ++i)
    points.emplace_back(0.1 * i, 2, i < 200 ? -0.01 * i : std::sin(0.05 * i) + random.uniform(0, 0.002));
  const auto kept = thinned(points, 0.01);
  CHECK(kept.size() < 250u);
  CHECK_THAT((kept.front() - points.front()).norm(), WithinAbs(0, 1e-3));
  CHECK_THAT((kept.back() - points.back()).norm(), WithinAbs(0, 1e-3));
  CHECK(passes_over(kept, points) <= 0.01 + 1e-9);
}

TEST_CASE("Mill.HillsAndHollowsAreThinnedToTheFormula") {
  // Over a hill tangents, in a hollow chords: both as long as sqrt(8 R t), so that a quarter of the tolerance takes
  // twice the points.
  const double radius = 20;
  for (const double side : {-1.0, 1.0}) {
    std::vector<Vec3> points;
    for (int i = 0; i <= 2000; ++i) {
      const double x = 0.01 * i - 10;
      points.emplace_back(0.01 * i, 3, side * (radius - std::sqrt(radius * radius - x * x)));
    }
    for (const double tolerance : {0.064, 0.016}) {
      const auto kept = thinned(points, tolerance);
      const double across =
          2 * radius * std::asin(10 / radius);  // along the arc, whose pieces are as long as the formula says
      const double pieces = across / std::sqrt(8 * radius * tolerance);
      CHECK(passes_over(kept, points) <= tolerance + 1e-9);
      {
        INFO(side << tolerance);
        CHECK(static_cast<double>(kept.size()) > pieces);
        CHECK(static_cast<double>(kept.size()) < 1.25 * pieces + 3);
      }
      CHECK_THAT(kept.front().z(), WithinAbs(points.front().z(), 1e-3));
      CHECK_THAT(kept.back().z(), WithinAbs(points.back().z(), 1e-3));
    }
  }
}

TEST_CASE("Mill.ThePathToleranceIsAllThatFewerLinesLeave") {
  const HeightField surface =
      field(201, 121, 0.1, [](double x, double y) { return -2.5 + 1.5 * std::sin(0.3 * x) * std::cos(0.4 * y); });
  MillOptions options = small(ToolShape::ball, 1.6);
  options.stages = MillStages::finish;
  options.finish_stepover_percent = 20;
  Context context;
  const auto lines = [](const MillPlan& plan) {
    std::size_t count = 0;
    for (const ToolMove& move : plan.path.moves) count += move.points_mm.size();
    return count;
  };
  options.path_tolerance_mm = 0.001;
  const MillPlan exact = plan_mill_job(surface, options, context);
  options.path_tolerance_mm = 0.02;
  const MillPlan coarse = plan_mill_job(surface, options, context);
  CHECK(5 * lines(coarse) < lines(exact));
  double maximum = 0;
  for (std::size_t i = 0; i < surface.z_mm.size(); ++i) {
    CHECK(coarse.carved.z_mm[i] >= exact.carved.z_mm[i] - 1.01e-3f);
    maximum = std::max<double>(maximum, coarse.carved.z_mm[i] - exact.carved.z_mm[i]);
  }
  CHECK(maximum <= 0.02 + 1e-5);
  CHECK(maximum > 0.005);  // the simulation sees it
}

}  // namespace
}  // namespace formwright
