// SPDX-License-Identifier: GPL-3.0-or-later
// A laser's G-code, read back.
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <numbers>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/random.h"
#include "fabrication/planned_laser_job.h"
#include "fabrication/writers/gcode_writer.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;
using namespace test;

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
