// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/k40/egv_bounds.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/random.h"
#include "fabrication/writers/egv_writer.h"
#include "machines/k40/k40_driver.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

constexpr double mm_per_mil = 0.0254;

/// Lines, zigzags and dots all over a bed, in layers of several speeds.
Toolpath random_path(Random& random, const MachineOptions& machine) {
  const auto place = [&] { return Vec3(machine.bed_x_mm * random.uniform(), machine.bed_y_mm * random.uniform(), 0); };
  ToolpathBuilder builder(Vec3(0, machine.bed_y_mm, 0), 100);
  const std::size_t strokes = 1 + random.below(25);
  for (std::size_t i = 0; i < strokes; ++i) {
    ToolMove move;
    move.work = true;
    move.layer = "cut";
    move.power_percent = 50;
    move.speed_mm_per_s = std::array{5.0, 10.0, 80.0}[random.below(3)];
    Vec3 at = place();
    for (std::size_t k = 1 + random.below(20); k > 0; --k) {
      move.points_mm.push_back(at);
      if (random.uniform() < 0.3) at = place();
      else if (random.uniform() < 0.5)
        at[static_cast<Eigen::Index>(random.below(2))] += 3 * (random.uniform() - 0.5);  // along an axis
      else at += Vec3(random.uniform() - 0.5, random.uniform() - 0.5, 0);
      at[0] = std::clamp(at[0], 0.0, machine.bed_x_mm);
      at[1] = std::clamp(at[1], 0.0, machine.bed_y_mm);
    }
    move.points_mm.push_back(at);
    builder.work(std::move(move));
  }
  return builder.take();
}

struct Steps {
  static constexpr std::int64_t far_steps = std::int64_t{1} << 40;
  std::array<std::int64_t, 2> low{far_steps, far_steps}, high{-far_steps, -far_steps}, at{0, 0};
  void see() {
    for (std::size_t axis = 0; axis < 2; ++axis)
      low[axis] = std::min(low[axis], at[axis]), high[axis] = std::max(high[axis], at[axis]);
  }
};

/// What the plan itself says: every stroke's points in whole steps from the upper left corner.
Steps worked_of(const Toolpath& path, const MachineOptions& machine) {
  Steps steps;
  for (const ToolMove& move : path.moves) {
    if (!move.work) continue;
    for (const Vec3& p : move.points_mm) {
      steps.at = {std::lround(p.x() / mm_per_mil), std::lround((machine.bed_y_mm - p.y()) / mm_per_mil)};
      steps.see();
    }
  }
  return steps;
}

/// The motors' steps one by one, read with none of the reader's code: the letters after the header are cut into words
/// of a direction and its distances.
struct Motors {
  Steps all, lit;

  explicit Motors(const std::string& egv) {
    std::string body = egv.substr(egv.rfind('%') + 1);
    std::erase_if(body, [](char c) { return c == '\n' || c == '-'; });
    all.see();
    for (std::size_t i = 0; i < body.size();) {
      const char c = body[i];
      if (c == 'C' && body[i + 1] == 'V') i += 18;  // CV, sixteen digits
      else if (c == 'S') i += body[i + 1] == '1' ? 2 : 1, beam = false;
      else if (c == 'M') both = true, ++i;
      else if (std::string("BTRL").find(c) != std::string::npos) {
        both = false;
        const std::size_t axis = c == 'B' || c == 'T' ? 0 : 1;
        on = axis;
        direction[axis] = c == 'T' || c == 'L' ? -1 : 1;
        ++i;
      } else if (c == 'D' || c == 'U') beam = c == 'D', ++i;
      else if (c == 'N' || c == 'F' || c == 'I' || c == 'P' || c == 'C') beam = false, ++i;
      else if (c == 'E') {
        // Out of "NSE" the board turns y round and steps along it.
        if (body[i - 1] == 'S') direction[1] = -direction[1], on = 1, both = false;
        ++i;
      } else i = step(body, i);
    }
  }

 private:
  std::size_t step(const std::string& body, std::size_t i) {
    long count = 0;
    if (body[i] >= '0' && body[i] <= '9') count = std::stol(body.substr(i, 3)), i += 3;
    else if (body[i] == '|') count = 25 + (body[i + 1] == 'z' ? 26 : body[i + 1] - 'a' + 1), i += 2;
    else if (body[i] == 'z') count = 255, ++i;
    else if (body[i] >= 'a' && body[i] < 'z') count = body[i] - 'a' + 1, ++i;
    else {
      FAIL_CHECK("the letter " << body[i]);
      return body.size();
    }
    for (; count > 0; --count) {
      lit.at = all.at;
      if (beam) lit.see();
      for (const std::size_t axis : {0u, 1u})
        if (both || on == axis) all.at[axis] += direction[axis];
      all.see();
      lit.at = all.at;
      if (beam) lit.see();
    }
    return i;
  }
  std::array<long, 2> direction{1, 1};
  std::size_t on = 0;
  bool both = false, beam = false;
};

void expect_same(const GcodeBounds& bounds, const Steps& steps, const std::string& what) {
  {
    INFO(what);
    REQUIRE_FALSE(bounds.empty);
  }
  for (std::size_t axis = 0; axis < 2; ++axis) {
    INFO(what);
    REQUIRE_THAT(bounds.low_mm[axis], WithinAbs(mm_per_mil * static_cast<double>(steps.low[axis]), 1e-9));
    REQUIRE_THAT(bounds.high_mm[axis], WithinAbs(mm_per_mil * static_cast<double>(steps.high[axis]), 1e-9));
  }
}

TEST_CASE("EgvBounds.AreThoseOfThePlanAndOfTheMotors") {
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    Random random(seed);
    MachineOptions machine;
    machine.controller = Controller::k40;
    machine.bed_x_mm = 20 + 380 * random.uniform();
    machine.bed_y_mm = 20 + 280 * random.uniform();
    const Toolpath path = random_path(random, machine);
    const std::string egv(as_text(write_egv(path, machine)));
    const EgvBounds bounds = egv_bounds(k40_packets(egv));
    const Motors motors(egv);
    const std::string what = "seed " + std::to_string(seed);
    if (motors.lit.high[0] >= motors.lit.low[0]) {
      expect_same(bounds.worked, motors.lit, what + ", lit steps");
      expect_same(bounds.worked, worked_of(path, machine), what + ", the plan");
    }
    expect_same(bounds.reached, motors.all, what + ", all steps");
    for (std::size_t axis = 0; axis < 2; ++axis) {
      INFO(what);
      REQUIRE_THAT(bounds.end_mm[axis], WithinAbs(mm_per_mil * static_cast<double>(motors.all.at[axis]), 1e-9));
    }
    {
      INFO(what);
      REQUIRE(motors.all.at == std::array<std::int64_t, 2>{0, 0});
    }
  }
}

TEST_CASE("EgvBounds.FollowTheLettersOfOtherPrograms") {
  const auto of = [](const std::string& egv) { return egv_bounds(k40_packets(egv)); };
  // Two rapid moves and their way back home.
  const EgvBounds moved = of("IB100R|aS1P\nIBaS1P\nIPP\n");
  CHECK(moved.worked.empty);
  CHECK_THAT(moved.reached.high_mm[0], WithinAbs(101 * mm_per_mil, 1e-12));
  CHECK_THAT(moved.reached.high_mm[1], WithinAbs(26 * mm_per_mil, 1e-12));
  CHECK(moved.end_mm == std::array<double, 2>{0, 0});
  // A raster: its rows are three steps apart, by themselves.
  const EgvBounds raster = of("ICV1752241000000003G003NBRNBzRzBS1EDBdTdBdTdFNSE-\n");
  CHECK_THAT(raster.worked.high_mm[1] - raster.worked.low_mm[1], WithinAbs(3 * 3 * mm_per_mil, 1e-12));
  for (const char* unknown : {"IAaS1P\n", "IB1S1P\n", "IaS1P\n", "IB1234S1P\n", "IBaS1234P\n", "I$\n"}) {
    INFO(unknown);
    CHECK_THROWS_AS(of(unknown), Error);
  }
}

}  // namespace
}  // namespace formwright
