// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <cmath>
#include <numbers>

#include "base/random.h"
#include "fabrication/toolpath/toolpath.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

Toolpath along(const std::vector<Vec3>& points, double speed) {
  Toolpath path;
  ToolMove move;
  move.work = true;
  move.speed_mm_per_s = speed;
  move.points_mm = points;
  path.moves.push_back(move);
  return path;
}

double seconds(const std::vector<Vec3>& points, double speed, const MotionLimits& limits = {}) {
  Toolpath path = along(points, speed);
  time_moves(path, limits);
  return path.seconds;
}

const MotionLimits limits{500, 0.01, 16};

TEST_CASE("MotionTiming.OneLineIsATrapezoidOrATriangle") {
  // 50 mm/s takes 0.1 s and 2.5 mm to reach.
  CHECK_THAT(seconds({{0, 0, 0}, {105, 0, 0}}, 50, limits), WithinAbs(0.1 + 2 + 0.1, 1e-12));
  CHECK_THAT(seconds({{0, 0, 0}, {3, 4, 0}}, 50, limits), WithinAbs(0.2, 1e-12));                       // just reached
  CHECK_THAT(seconds({{0, 0, 0}, {0, 0, 2}}, 50, limits), WithinAbs(2 * std::sqrt(2 / 500.0), 1e-12));  // not reached
}

TEST_CASE("MotionTiming.CornersAreTakenAsFastAsTheirDeviationAllows") {
  // v^2 = a d s / (1 - s), s = sin(theta / 2), theta the inner angle.
  for (const double degrees : {30.0, 90.0, 150.0}) {
    const double theta = degrees * std::numbers::pi / 180, s = std::sin(theta / 2);
    const double corner = std::sqrt(500 * 0.01 * s / (1 - s));
    REQUIRE(corner < 50);
    const double ramp_up_mm = 2.5, ramp_down_mm = (2500 - corner * corner) / 1000;
    const double expected = 2 * (0.1 + (50 - corner) / 500 + (100 - ramp_up_mm - ramp_down_mm) / 50);
    INFO(degrees);
    CHECK_THAT(seconds({{0, 0, 0}, {100, 0, 0}, {100 - 100 * std::cos(theta), 100 * std::sin(theta), 0}}, 50, limits),
               WithinAbs(expected, 1e-9));
  }
  const double there_and_back = seconds({{0, 0, 0}, {100, 0, 0}, {0, 0, 0}}, 50, limits);
  CHECK_THAT(there_and_back, WithinAbs(2 * seconds({{0, 0, 0}, {100, 0, 0}}, 50, limits), 1e-9));
}

TEST_CASE("MotionTiming.CuttingALineIntoPiecesChangesNothingWhileThePlannerSeesEnough") {
  std::vector<Vec3> pieces;
  for (int i = 0; i <= 100; ++i) pieces.emplace_back(i, 0, 0);
  CHECK_THAT(seconds(pieces, 50, limits), WithinAbs(seconds({pieces.front(), pieces.back()}, 50, limits), 1e-9));
}

TEST_CASE("MotionTiming.ShortPiecesAreAsSlowAsTheLookAheadMakesThem") {
  // 15 pieces of 0.02 mm ahead: the head must be able to stop within 0.3 mm.
  std::vector<Vec3> pieces;
  for (int i = 0; i <= 10'000; ++i) pieces.emplace_back(0.02 * i, 0, 0);
  const double limit = std::sqrt(2 * 500 * 0.3);
  const double expected = 200 / limit;
  CHECK_THAT(seconds(pieces, 100, limits), WithinAbs(expected, 0.05 * expected));
  CHECK_THAT(seconds(pieces, 100, {500, 0.01, 1000}),
             WithinAbs(seconds({pieces.front(), pieces.back()}, 100, limits), 1e-6));
}

TEST_CASE("MotionTiming.MoreIsNeverFasterAndTimesGrow") {
  Random random(3);
  std::vector<Vec3> points;
  for (int i = 0; i < 400; ++i) points.emplace_back(random.uniform(0, 50), random.uniform(0, 50), 0);
  const double base = seconds(points, 80, limits);
  CHECK(seconds(points, 120, limits) < base);
  CHECK(seconds(points, 80, {1000, 0.01, 16}) < base);
  CHECK(seconds(points, 80, {500, 0.05, 16}) < base);
  CHECK(seconds(points, 80, {500, 0.01, 64}) <= base);
  Toolpath path = along(points, 80);
  CHECK(base > path.length_mm(true) / 80);
  time_moves(path, limits);
  const auto& times = path.moves[0].times_s;
  REQUIRE(times.size() == points.size());
  for (std::size_t i = 1; i < times.size(); ++i) {
    CHECK(times[i] > times[i - 1]);
    CHECK(times[i] - times[i - 1] >= (points[i] - points[i - 1]).norm() / 80 - 1e-12);  // nowhere faster than told
  }
}

}  // namespace
}  // namespace formwright
