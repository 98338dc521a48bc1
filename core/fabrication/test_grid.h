// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Tests to find out what a laser does to a material: power and speed, kerf, focus.
#include "fabrication/laser/laser_plan.h"

namespace formwright {

enum class GridKind { power_speed, kerf, focus };
template <>
struct EnumNames<GridKind> {
  static constexpr std::array<std::string_view, 3> names{"power_speed", "kerf", "focus"};
  static constexpr std::array<std::string_view, 3> labels{"Power and speed", "Kerf", "Focus"};
};

enum class GridWork { cut, engrave };
template <>
struct EnumNames<GridWork> {
  static constexpr std::array<std::string_view, 2> names{"cut", "engrave"};
  static constexpr std::array<std::string_view, 2> labels{"Cut squares out", "Fill squares"};
};

struct TestGridOptions : LaserMachineOptions {
  GridKind kind = GridKind::power_speed;
  GridWork work = GridWork::cut;
  double x_mm = 10, y_mm = 10;
  int columns = 5, rows = 5;
  double power_from_percent = 20, power_to_percent = 100;
  double speed_from_mm_per_s = 5, speed_to_mm_per_s = 25;
  double cell_mm = 8, gap_mm = 4, line_mm = 0.15;
  int passes = 1;
  double power_percent = 80, speed_mm_per_s = 10;
  double kerf_length_mm = 100;
  double focus_range_mm = 3;
  double label_mm = 3, label_power_percent = 20, label_speed_mm_per_s = 50;

  static constexpr auto parameters = std::tuple_cat(
      inherit_parameters<TestGridOptions>(LaserMachineOptions::parameters),
      std::tuple{
          parameter(
              "kind", &TestGridOptions::kind, "Test",
              "Power and speed: a grid of squares, one for each pair. Kerf: ten pieces that show how wide the beam burns. Focus: a line for each height of the head.")
              .group("Test"),
          parameter("work", &TestGridOptions::work, "Squares",
                    "Whether the squares of the power and speed test are cut out or filled with engraved lines.")
              .group("Squares"),
          parameter("x_mm", &TestGridOptions::x_mm, "Position in x", unit::mm, 0, 20'000,
                    "Distance of the test's left edge from the left side of the bed.")
              .group("Test")
              .slider(0, 500),
          parameter("y_mm", &TestGridOptions::y_mm, "Position in y", unit::mm, 0, 20'000,
                    "Distance of the test's front edge from the front of the bed.")
              .group("Test")
              .slider(0, 500),
          parameter(
              "columns", &TestGridOptions::columns, "Number of powers", unit::none, 1, 20,
              "How many powers the power and speed test compares, one for each column; in the focus test, the number of lines.")
              .group("Squares")
              .slider(2, 10),
          parameter("rows", &TestGridOptions::rows, "Number of speeds", unit::none, 1, 20,
                    "How many speeds the power and speed test compares, one for each row.")
              .group("Squares")
              .slider(2, 10),
          parameter("power_from_percent", &TestGridOptions::power_from_percent, "Lowest power", unit::percent, 0, 100,
                    "Laser power of the first column in the power and speed test.")
              .group("Squares"),
          parameter("power_to_percent", &TestGridOptions::power_to_percent, "Highest power", unit::percent, 0, 100,
                    "Laser power of the last column in the power and speed test.")
              .group("Squares"),
          parameter("speed_from_mm_per_s", &TestGridOptions::speed_from_mm_per_s, "Lowest speed", unit::mm_per_s, 0.1,
                    2000, "Speed of the lowest row in the power and speed test.")
              .group("Squares")
              .slider(1, 300),
          parameter("speed_to_mm_per_s", &TestGridOptions::speed_to_mm_per_s, "Highest speed", unit::mm_per_s, 0.1,
                    2000, "Speed of the highest row in the power and speed test.")
              .group("Squares")
              .slider(1, 300),
          parameter("cell_mm", &TestGridOptions::cell_mm, "Square size", unit::mm, 1, 100,
                    "Side of each square in the power and speed test. Lines of the focus test are three times as long.")
              .group("Squares")
              .slider(3, 20),
          parameter("gap_mm", &TestGridOptions::gap_mm, "Gap", unit::mm, 0.5, 100,
                    "Distance between two squares of the test.")
              .group("Squares")
              .slider(1, 10),
          parameter("line_mm", &TestGridOptions::line_mm, "Line spacing", unit::mm, 0.02, 5,
                    "Distance between the engraved lines that fill a square. Closer is darker and takes longer.")
              .group("Squares")
              .slider(0.05, 1),
          parameter("passes", &TestGridOptions::passes, "Passes", unit::none, 1, 50,
                    "How many times every line of the test is repeated. 1 is usual.")
              .group("Test")
              .slider(1, 10),
          parameter("power_percent", &TestGridOptions::power_percent, "Power", unit::percent, 0, 100,
                    "Laser power of the kerf test and the focus test.")
              .group("Lines"),
          parameter("speed_mm_per_s", &TestGridOptions::speed_mm_per_s, "Speed", unit::mm_per_s, 0.1, 2000,
                    "Speed of the head in the kerf test and the focus test.")
              .group("Lines")
              .slider(1, 100),
          parameter("kerf_length_mm", &TestGridOptions::kerf_length_mm, "Kerf test length", unit::mm, 40, 500,
                    "Total length of the ten pieces in the kerf test. Longer measures more exactly.")
              .group("Lines")
              .slider(50, 200),
          parameter(
              "focus_range_mm", &TestGridOptions::focus_range_mm, "Focus range", unit::mm, 0.1, 50,
              "How far below and above the present focus height the focus test tries. 3 mm goes from 3 mm below to 3 mm above.")
              .group("Lines")
              .slider(1, 10),
          parameter("label_mm", &TestGridOptions::label_mm, "Height of numbers", unit::mm, 1, 20,
                    "Height of the numbers that are marked beside the test.")
              .group("Numbers")
              .slider(2, 6),
          parameter("label_power_percent", &TestGridOptions::label_power_percent, "Power of numbers", unit::percent, 0,
                    100,
                    "Laser power for the numbers beside the test. Low enough that they are marked and not cut through.")
              .group("Numbers"),
          parameter(
              "label_speed_mm_per_s", &TestGridOptions::label_speed_mm_per_s, "Speed of numbers", unit::mm_per_s, 0.1,
              2000,
              "Speed of the head for the numbers beside the test. Fast enough that they are marked and not cut through.")
              .group("Numbers")
              .slider(5, 200)});
};

struct TestCell {
  std::string name;                                        // "R1C1"; the part's name in the tool path
  double power_percent, speed_mm_per_s, z_mm, x_mm, y_mm;  // lower left corner on the bed
};

struct TestGrid {
  std::vector<LaserStroke> labels, strokes;
  std::vector<TestCell> cells;
  CutSheet drawing;  // what is run, on a sheet of the bed's size
};

/// The kerf test is a slot as long as ten pieces, cut apart by nine lines: pushed to the left, the pieces leave 11
/// kerfs free, and the last one's edge points at the kerf on the scale above it.
TestGrid make_test_grid(const TestGridOptions& options, const Context& context);

}  // namespace formwright
