// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/gcode/gcode_program.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include "base/error.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinULP;

GcodeProgram program(const std::string& text) { return GcodeProgram::read(as_bytes(text), 78); }

std::string sentence_of(const std::string& text) {
  try {
    program(text);
  } catch (const Error& error) {
    CHECK(error.where() == "job");
    return error.what();
  }
  return "";
}

TEST_CASE("GcodeProgram.KeepsWhatIsSentAndWhereItStood") {
  const GcodeProgram p = program("; a job\r\n%\nN10 g21 G90 (mm! really?)\n\n  G0 X1.5 Y-2 ; there\nM3 s500\nM5");
  REQUIRE(p.line_count() == 4);
  CHECK(p.line(0) == "G21G90");
  CHECK(p.line(1) == "G0X1.5Y-2");
  CHECK(p.number(1) == 5);
  CHECK(p.index_of(4) == 1);
  CHECK(p.index_of(99) == 4);
  CHECK(p.fires());
  CHECK_FALSE(program("G0X1\nM5").fires());
}

TEST_CASE("GcodeProgram.SaysWhatIsWrongAndWhere") {
  CHECK(sentence_of("G0X1\nG1X!2").find("Line 2") != std::string::npos);
  CHECK(sentence_of("G0X1\n$132=5").find("settings") != std::string::npos);
  CHECK(sentence_of("G1X" + std::string(90, '1')).find("93 characters") != std::string::npos);
  CHECK(sentence_of("G0X\n").find("needs a number") != std::string::npos);
  CHECK(sentence_of("; nothing\n\n").find("no G-code") != std::string::npos);
  CHECK(sentence_of("PK\x03\x04").find("character") != std::string::npos);
  CHECK(sentence_of("G0 X1 (never closed\n").find("Line 1") != std::string::npos);
}

TEST_CASE("GcodeProgram.BoundsHoldUnitsRelativeMovesAndArcs") {
  const GcodeProgram inches = program("G20\nG0X1Y2");
  CHECK_THAT(inches.bounds().high_mm[0], WithinAbs(25.4, 1e-12));
  CHECK_THAT(inches.bounds().high_mm[1], WithinAbs(50.8, 1e-12));
  // As if the head stood at the origin, from where alone such a job is started.
  const GcodeProgram relative = program("G91\nG1X10F100\nX10\nY-5");
  CHECK_THAT(relative.bounds().high_mm[0], WithinAbs(20, 1e-12));
  CHECK_THAT(relative.bounds().low_mm[1], WithinAbs(-5, 1e-12));
  // Half a circle of radius 10 about (10, 0), counter-clockwise from (20, 0): it reaches y = 10.
  const GcodeProgram half = program("G0X20Y0\nG3X0Y0I-10J0F100");
  CHECK_THAT(half.bounds().high_mm[1], WithinAbs(10, 1e-9));
  CHECK_THAT(half.bounds().low_mm[1], WithinAbs(0, 1e-9));
  const GcodeProgram below = program("G0X20Y0\nG2X0Y0R10F100");
  CHECK_THAT(below.bounds().low_mm[1], WithinAbs(-10, 1e-9));
  const GcodeProgram circle = program("G0X20Y0\nG2X20Y0I-10J0F100");
  CHECK_THAT(circle.bounds().low_mm[0], WithinAbs(0, 1e-9));
  CHECK_THAT(circle.bounds().high_mm[1], WithinAbs(10, 1e-9));
  // Machine coordinates say nothing about work coordinates.
  CHECK(program("G53G0X-5").bounds().empty);
}

TEST_CASE("GcodeProgram.BoundsAreOfTheAxesThatAreNamed") {
  const GcodeBounds x = program("G0X5\nG1X9F100").bounds();
  CHECK(x.named == std::array<bool, 3>{true, false, false});
  CHECK_THAT(x.low_mm[0], WithinULP(5.0, 4));
  const GcodeBounds later = program("G0Z3\nG0X5Y7\nG1Z-2F100").bounds();
  CHECK_THAT(later.low_mm[1], WithinULP(7.0, 4));
  CHECK_THAT(later.low_mm[2], WithinULP(-2.0, 4));
  CHECK_THAT(later.high_mm[2], WithinULP(3.0, 4));
  CHECK_FALSE(program("M3S10\nM5").bounds().named[0]);
}

TEST_CASE("GcodeProgram.ArcsBulgeInEveryPlane") {
  // Half circles of radius 10, clockwise seen from the end of the third axis.
  const GcodeBounds zx = program("G18\nG0X0Y5Z0\nG2X20Z0I10K0F100").bounds();
  CHECK_THAT(zx.low_mm[2], WithinAbs(-10, 1e-9));
  CHECK_THAT(zx.high_mm[2], WithinAbs(0, 1e-9));
  CHECK_THAT(zx.high_mm[1], WithinULP(5.0, 4));
  const GcodeBounds yz = program("G19\nG0X1Y0Z0\nG3X4Y20Z0J10K0F100").bounds();
  CHECK_THAT(yz.low_mm[2], WithinAbs(-10, 1e-9));
  CHECK_THAT(yz.high_mm[0], WithinULP(4.0, 4));  // a helix
  // The longer of two arcs for R < 0: three quarters of a circle about (10, 0).
  const GcodeBounds longer = program("G0X0Y0\nG3X10Y10R-10F100").bounds();
  CHECK_THAT(longer.high_mm[0], WithinAbs(20, 1e-9));
  CHECK_THAT(longer.low_mm[1], WithinAbs(-10, 1e-9));
  CHECK_THAT(longer.high_mm[1], WithinAbs(10, 1e-9));
  CHECK_THAT(longer.low_mm[0], WithinAbs(0, 1e-9));
  const GcodeBounds shorter = program("G0X0Y0\nG3X10Y10R10F100").bounds();
  CHECK_THAT(shorter.high_mm[0], WithinAbs(10, 1e-9));
  CHECK_THAT(shorter.low_mm[1], WithinAbs(0, 1e-9));
}

TEST_CASE("GcodeProgram.KeepsItsLinesWhereverTheyLie") {
  // Empty lines, comments, all three line ends and a byte order mark; more lines than one block and one checkpoint.
  std::string text = "\xef\xbb\xbf";
  for (int i = 1; i <= 2500; ++i)
    text += (i % 7 == 0 ? "; a comment" : (i % 5 == 0 ? "G0X" : "G1F60X") + std::to_string(i)) +
            std::string(i % 3 == 0   ? "\r\n"
                        : i % 3 == 1 ? "\r"
                                     : "\n");
  const GcodeProgram p = program(text);
  int index = 0;
  for (int i = 1; i <= 2500; ++i) {
    CHECK(p.index_of(i) == index);
    if (i % 7 == 0) continue;
    REQUIRE(p.line(index) == (i % 5 == 0 ? "G0X" : "G1F60X") + std::to_string(i));
    CHECK(p.number(index) == i);
    CHECK(p.state_before(index).position_mm[0] == (i == 1 ? 0 : (i - 1) % 7 == 0 ? i - 2 : i - 1));
    int rapid = index;
    while (rapid > 0 && !p.line(rapid).starts_with("G0")) --rapid;
    CHECK(p.rapid_before(index) == rapid);
    ++index;
  }
  CHECK(p.line_count() == index);
  CHECK(p.index_of(2501) == index);
}

TEST_CASE("GcodeProgram.KnowsWhetherItCountsFromWhereTheHeadStands") {
  for (const char* text :
       {"G91\nG1X10F100", "G21G91M4S300\nG1X100F1000", "G0X1\nG91\nY5", "G2X10Y0I5F100", "G3I5F100", "G0Y1\nG2X10I5"}) {
    INFO(text);
    CHECK(program(text).from_here());
  }
  // Only x and y count, and only until the program has said where they go. The last is as Formwright's own jobs begin.
  for (const char* text : {"G91\nG0Z5\nG90\nG0X1Y2", "G91G0Z5\nG90G0X1Y2\nG91X5", "G0X1Y2\nG91\nX2Y-5",
                           "G91G28X0Y0\nG90G0X1Y1\nG2X3I1", "G90.1G91.1\nG0X5", "G53G0X-5", "G91G53G0X-5",
                           "G21\nG90\nG94\nM4 S0\nG0 X1 Y2 S0\nG1 X3 Y2 S9 F60\nM5\nG0 X0 Y0\nM2"}) {
    INFO(text);
    CHECK_FALSE(program(text).from_here());
  }
}

TEST_CASE("GcodeProgram.KnowsTheStateALineBeginsIn") {
  const GcodeProgram p = program("G21G90\nM4S300\nG0X1Y2\nG1X5F600\nG91\nX2\nM5");
  const GcodeState s = p.state_before(6);
  CHECK(s.motion == 1);
  CHECK(s.spindle == 4);
  CHECK(s.relative);
  CHECK_THAT(s.position_mm[0], WithinULP(7.0, 4));
  CHECK_THAT(s.position_mm[1], WithinULP(2.0, 4));
  CHECK_THAT(s.feed_mm_per_min, WithinULP(600.0, 4));
  CHECK_THAT(s.power, WithinULP(300.0, 4));
}

TEST_CASE("GcodeProgram.KnowsWhatALineDoes") {
  CHECK(effect_of("g1 x5").moves);
  CHECK(effect_of("X5").moves);
  CHECK(effect_of("$H").moves);
  CHECK(effect_of("M3 S10").fires);
  CHECK_FALSE((effect_of("$$").moves || effect_of("$$").fires));
  CHECK_FALSE(effect_of("M5").fires);
  CHECK_THAT(dwell_s("G4P2.5"), WithinULP(2.5, 4));
  CHECK_THAT(dwell_s("G1X1"), WithinULP(0.0, 4));
}

}  // namespace
}  // namespace formwright
