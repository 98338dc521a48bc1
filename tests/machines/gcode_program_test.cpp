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

TEST(GcodeProgram, AnOriginThatMovesIsNamed) {
  for (const char* text :
       {"G0X1\nG92X0Y0\nG1X5F100", "G21\nG10L20P0X0Y0", "G21\nG10L2P1X5", "G21\nG92.1", "G21\nG92", "G21\nG92E0X5"}) {
    const GcodeProgram p = program(text);
    EXPECT_EQ(p.origin_line(), 2) << text;
    try {
      require_fixed_origin(p);
      ADD_FAILURE() << text;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("Line 2 moves the origin"), std::string::npos) << error.what();
    }
  }
  for (const char* text : {"G92E0\nG1X5F100", "G10\nG11", "G0X92Y10"}) {
    EXPECT_EQ(program(text).origin_line(), 0) << text;
    EXPECT_NO_THROW(require_fixed_origin(program(text)));
  }
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
