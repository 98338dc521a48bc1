// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/gcode_program.h"

#include <gtest/gtest.h>

#include "base/error.h"

namespace formwright {
namespace {

GcodeProgram program(const std::string& text) { return GcodeProgram::read(as_bytes(text), 78); }

std::string sentence_of(const std::string& text) {
  try {
    program(text);
  } catch (const Error& error) {
    EXPECT_EQ(error.where(), "job");
    return error.what();
  }
  return "";
}

TEST(GcodeProgram, KeepsWhatIsSentAndWhereItStood) {
  const GcodeProgram p = program("; a job\r\n%\nN10 g21 G90 (mm! really?)\n\n  G0 X1.5 Y-2 ; there\nM3 s500\nM5");
  ASSERT_EQ(p.line_count(), 4);
  EXPECT_EQ(p.line(0), "G21G90");
  EXPECT_EQ(p.line(1), "G0X1.5Y-2");
  EXPECT_EQ(p.number(1), 5);
  EXPECT_EQ(p.index_of(4), 1);
  EXPECT_EQ(p.index_of(99), 4);
  EXPECT_TRUE(p.fires());
  EXPECT_FALSE(program("G0X1\nM5").fires());
}

TEST(GcodeProgram, SaysWhatIsWrongAndWhere) {
  EXPECT_NE(sentence_of("G0X1\nG1X!2").find("Line 2"), std::string::npos);
  EXPECT_NE(sentence_of("G0X1\n$132=5").find("settings"), std::string::npos);
  EXPECT_NE(sentence_of("G1X" + std::string(90, '1')).find("93 characters"), std::string::npos);
  EXPECT_NE(sentence_of("G0X\n").find("needs a number"), std::string::npos);
  EXPECT_NE(sentence_of("; nothing\n\n").find("no G-code"), std::string::npos);
  EXPECT_NE(sentence_of("PK\x03\x04").find("character"), std::string::npos);
  EXPECT_NE(sentence_of("G0 X1 (never closed\n").find("Line 1"), std::string::npos);
}

TEST(GcodeProgram, BoundsHoldUnitsRelativeMovesAndArcs) {
  const GcodeProgram inches = program("G20\nG0X1Y2");
  EXPECT_NEAR(inches.bounds().high_mm[0], 25.4, 1e-12);
  EXPECT_NEAR(inches.bounds().high_mm[1], 50.8, 1e-12);
  // As if the head stood at the origin, from where alone such a job is started.
  const GcodeProgram relative = program("G91\nG1X10F100\nX10\nY-5");
  EXPECT_NEAR(relative.bounds().high_mm[0], 20, 1e-12);
  EXPECT_NEAR(relative.bounds().low_mm[1], -5, 1e-12);
  // Half a circle of radius 10 about (10, 0), counter-clockwise from (20, 0): it reaches y = 10.
  const GcodeProgram half = program("G0X20Y0\nG3X0Y0I-10J0F100");
  EXPECT_NEAR(half.bounds().high_mm[1], 10, 1e-9);
  EXPECT_NEAR(half.bounds().low_mm[1], 0, 1e-9);
  const GcodeProgram below = program("G0X20Y0\nG2X0Y0R10F100");
  EXPECT_NEAR(below.bounds().low_mm[1], -10, 1e-9);
  const GcodeProgram circle = program("G0X20Y0\nG2X20Y0I-10J0F100");
  EXPECT_NEAR(circle.bounds().low_mm[0], 0, 1e-9);
  EXPECT_NEAR(circle.bounds().high_mm[1], 10, 1e-9);
  // Machine coordinates say nothing about work coordinates.
  EXPECT_TRUE(program("G53G0X-5").bounds().empty);
}

TEST(GcodeProgram, BoundsAreOfTheAxesThatAreNamed) {
  const GcodeBounds x = program("G0X5\nG1X9F100").bounds();
  EXPECT_EQ(x.named, (std::array<bool, 3>{true, false, false}));
  EXPECT_DOUBLE_EQ(x.low_mm[0], 5);
  const GcodeBounds later = program("G0Z3\nG0X5Y7\nG1Z-2F100").bounds();
  EXPECT_DOUBLE_EQ(later.low_mm[1], 7);
  EXPECT_DOUBLE_EQ(later.low_mm[2], -2);
  EXPECT_DOUBLE_EQ(later.high_mm[2], 3);
  EXPECT_FALSE(program("M3S10\nM5").bounds().named[0]);
}

TEST(GcodeProgram, ArcsBulgeInEveryPlane) {
  // Half circles of radius 10, clockwise seen from the end of the third axis.
  const GcodeBounds zx = program("G18\nG0X0Y5Z0\nG2X20Z0I10K0F100").bounds();
  EXPECT_NEAR(zx.low_mm[2], -10, 1e-9);
  EXPECT_NEAR(zx.high_mm[2], 0, 1e-9);
  EXPECT_DOUBLE_EQ(zx.high_mm[1], 5);
  const GcodeBounds yz = program("G19\nG0X1Y0Z0\nG3X4Y20Z0J10K0F100").bounds();
  EXPECT_NEAR(yz.low_mm[2], -10, 1e-9);
  EXPECT_DOUBLE_EQ(yz.high_mm[0], 4);  // a helix
  // The longer of two arcs for R < 0: three quarters of a circle about (10, 0).
  const GcodeBounds longer = program("G0X0Y0\nG3X10Y10R-10F100").bounds();
  EXPECT_NEAR(longer.high_mm[0], 20, 1e-9);
  EXPECT_NEAR(longer.low_mm[1], -10, 1e-9);
  EXPECT_NEAR(longer.high_mm[1], 10, 1e-9);
  EXPECT_NEAR(longer.low_mm[0], 0, 1e-9);
  const GcodeBounds shorter = program("G0X0Y0\nG3X10Y10R10F100").bounds();
  EXPECT_NEAR(shorter.high_mm[0], 10, 1e-9);
  EXPECT_NEAR(shorter.low_mm[1], 0, 1e-9);
}

TEST(GcodeProgram, KeepsItsLinesWhereverTheyLie) {
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
    EXPECT_EQ(p.index_of(i), index);
    if (i % 7 == 0) continue;
    ASSERT_EQ(p.line(index), (i % 5 == 0 ? "G0X" : "G1F60X") + std::to_string(i));
    EXPECT_EQ(p.number(index), i);
    EXPECT_EQ(p.state_before(index).position_mm[0], i == 1 ? 0 : (i - 1) % 7 == 0 ? i - 2 : i - 1);
    int rapid = index;
    while (rapid > 0 && !p.line(rapid).starts_with("G0")) --rapid;
    EXPECT_EQ(p.rapid_before(index), rapid);
    ++index;
  }
  EXPECT_EQ(p.line_count(), index);
  EXPECT_EQ(p.index_of(2501), index);
}

TEST(GcodeProgram, KnowsWhetherItCountsFromWhereTheHeadStands) {
  for (const char* text :
       {"G91\nG1X10F100", "G21G91M4S300\nG1X100F1000", "G0X1\nG91\nY5", "G2X10Y0I5F100", "G3I5F100", "G0Y1\nG2X10I5"})
    EXPECT_TRUE(program(text).from_here()) << text;
  // Only x and y count, and only until the program has said where they go. The last is as Formwright's own jobs begin.
  for (const char* text : {"G91\nG0Z5\nG90\nG0X1Y2", "G91G0Z5\nG90G0X1Y2\nG91X5", "G0X1Y2\nG91\nX2Y-5",
                           "G91G28X0Y0\nG90G0X1Y1\nG2X3I1", "G90.1G91.1\nG0X5", "G53G0X-5", "G91G53G0X-5",
                           "G21\nG90\nG94\nM4 S0\nG0 X1 Y2 S0\nG1 X3 Y2 S9 F60\nM5\nG0 X0 Y0\nM2"})
    EXPECT_FALSE(program(text).from_here()) << text;
}

TEST(GcodeProgram, KnowsTheStateALineBeginsIn) {
  const GcodeProgram p = program("G21G90\nM4S300\nG0X1Y2\nG1X5F600\nG91\nX2\nM5");
  const GcodeState s = p.state_before(6);
  EXPECT_EQ(s.motion, 1);
  EXPECT_EQ(s.spindle, 4);
  EXPECT_TRUE(s.relative);
  EXPECT_DOUBLE_EQ(s.position_mm[0], 7);
  EXPECT_DOUBLE_EQ(s.position_mm[1], 2);
  EXPECT_DOUBLE_EQ(s.feed_mm_per_min, 600);
  EXPECT_DOUBLE_EQ(s.power, 300);
}

TEST(GcodeProgram, KnowsWhatALineDoes) {
  EXPECT_TRUE(effect_of("g1 x5").moves);
  EXPECT_TRUE(effect_of("X5").moves);
  EXPECT_TRUE(effect_of("$H").moves);
  EXPECT_TRUE(effect_of("M3 S10").fires);
  EXPECT_FALSE(effect_of("$$").moves || effect_of("$$").fires);
  EXPECT_FALSE(effect_of("M5").fires);
  EXPECT_DOUBLE_EQ(dwell_s("G4P2.5"), 2.5);
  EXPECT_DOUBLE_EQ(dwell_s("G1X1"), 0);
}

}  // namespace
}  // namespace formwright
