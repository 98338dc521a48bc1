// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/gcode/gcode_rules.h"

#include <catch2/catch_test_macros.hpp>

#include "base/error.h"

namespace formwright {
namespace {

/// The sentence that refuses the job; "" where it passes.
std::string refused(const std::string& text, GcodeDialect dialect = GcodeDialect::grbl, bool mist = true) {
  const bool marlin = dialect != GcodeDialect::grbl;
  try {
    require_runnable(GcodeProgram::read(as_bytes(text), 96, marlin), {dialect, mist});
  } catch (const Error& error) {
    CHECK(error.where() == "job");
    const std::string sentence = error.what();
    {
      INFO(sentence);
      CHECK((sentence.starts_with("Line ") && sentence.ends_with('.')));
    }
    return sentence;
  }
  return "";
}

TEST_CASE("GcodeRules.WaysThatNobodyCanTellAreRefused") {
  for (const auto& [line, fix] : {std::pair{"G53G0X-5", "machine coordinates"},
                                  {"G28", "a place that the machine keeps"},
                                  {"G30X5", "a place that the machine keeps"},
                                  {"G28.1", "a place that the machine keeps"},
                                  {"G55", "post the job in G54"},
                                  {"G59.3", "post the job in G54"},
                                  {"G92X0Y0", "moves the origin"},
                                  {"G92", "moves the origin"},
                                  {"G92.1", "moves the origin"},
                                  {"G92E0X5", "moves the origin"},
                                  {"G10L20P0X0Y0", "moves the origin"},
                                  {"G10L2P1X5", "moves the origin"},
                                  {"G52X5", "moves the origin"},
                                  {"G43.1Z5", "set z to 0"},
                                  {"G43H1", "set z to 0"},
                                  {"G81X5Z-3R2F100", "plain moves"},
                                  {"G38.2Z-5F50", "probe by hand"},
                                  {"G41D1", "tool's radius"},
                                  {"G5X1I2J2", "lines and arcs"},
                                  {"G51X2", "its size"},
                                  {"G7", "lathe"},
                                  {"G90.1", "offsets"},
                                  {"G93", "feeds a minute"},
                                  {"M98P100", "one run of lines"},
                                  {"O100", "one run of lines"},
                                  {"G1A90F100", "three axes"},
                                  {"G0X2000000", "in mm"},
                                  {"G2X10Y0R3F100", "cannot be"},
                                  {"G2X5Y5R4F100", "by its radius"},
                                  {"G2X10Y0F100", "without a centre"},
                                  {"G2X10Y0I1F100", "differ by"}}) {
    const std::string sentence = refused(std::string("G21G90\nG0X5Y5\n") + line);
    INFO(line << ": " << sentence);
    CHECK(sentence.starts_with("Line 3 "));
    CHECK(sentence.find(fix) != std::string::npos);
  }
}

TEST_CASE("GcodeRules.WordsThatGrblAnswersWithAnErrorAreRefused") {
  for (const auto& [line, error] :
       {std::pair{"G64", "error 20"}, {"T1M6", "M6, error 20"}, {"M61Q2", "error 20"},
        {"G61.1", "error 20"},        {"G1.5X1", "error 20"},   {"G0X1E5", "error 20"},
        {"G0G1X1F100", "error 21"},   {"G17G18", "error 21"},   {"M3M5", "error 21"},
        {"M7M8", "error 21"},         {"G1X1", "error 22"},     {"G1X1F0", "error 22"},
        {"G49G0X1", "error 24"},      {"G0X1X2", "error 25"},   {"G3I5F100", "error 26"},
        {"G2Z5I5F100", "error 32"},   {"G4", "error 28"},       {"G80X5", "error 31"},
        {"G0X1I5", "error 36"},       {"G0X1P2", "error 36"},   {"G2X10Y5R5I1F100", "error 36"},
        {"G1X1F-5", "error 4"},       {"T256", "error 38"},     {"G0X1N20000000", "error 27"}}) {
    const std::string sentence = refused(std::string("G21G90\nG0X5Y5\n") + line);
    INFO(line << ": " << sentence);
    CHECK(sentence.starts_with("Line 3 "));
    CHECK(sentence.find(error) != std::string::npos);
  }
  CHECK(refused("M7\nM9") == "");
  CHECK(refused("M7\nM9", GcodeDialect::grbl, false).find("mist") != std::string::npos);
}

TEST_CASE("GcodeRules.WhatGrblTakesPasses") {
  for (const char* text :
       {"G21G90G17G94G54G40G49G80\nG61\nM5\nG0X1Y2\nM4S0\nM8\nG1X3S500F1000\nX4\nG2X10Y2I3J0\nM5M9\nG0X0Y0\nM2",
        "G91\nG0Z5\nG90\nG0X1Y2", "G1F100\nX5", "G4P0.5X3", "G20\nG91.1\nG0X1Y1\nG3X2Y1R0.5F10", "T1\nM3S1\nM30",
        "G18\nG0X0Z0\nG3X10Z0R5Y4F100", "G80\nG0X5", "N5G0X1\nG0X2N10"}) {
    INFO(text);
    CHECK(refused(text) == "");
  }
}

TEST_CASE("GcodeRules.MarlinLeavesOutWhatItDoesNotKnow") {
  for (const auto& [line, fix] : {std::pair{"G20", "in inches"},
                                  {"X5", "begin it with G0 or G1"},
                                  {"G90G0X5", "line of its own"},
                                  {"G18", "out of the plane"},
                                  {"G29", "does not know"},
                                  {"G28X", "machine keeps"},
                                  {"M428", "does not know"},
                                  {"M23", "does not know"},
                                  {"T1", "changes the tool"},
                                  {"G92X0", "moves the origin"}}) {
    const std::string sentence = refused(std::string("G21\nG90\n") + line, GcodeDialect::marlin);
    {
      INFO(line << ": " << sentence);
      CHECK(sentence.starts_with("Line 3 "));
      CHECK(sentence.find(fix) != std::string::npos);
    }
    CHECK(refused(std::string("G21\nG90\n") + line, GcodeDialect::marlin_printer) == "");
  }
  CHECK(refused("G21\nG90\nM5\nG0 X1 Y2 F6000\nM4 I\nG1 X5 Y2 S100 F600\nG3 I5\nM5 I\nM5\nG0 X0 Y0\nG92 E0",
                GcodeDialect::marlin) == "");
}

TEST_CASE("GcodeRules.ParametersAndSkippedLinesAreNamedAsSuch") {
  for (const auto& [line, what] : {std::pair{"G1X#5", "parameters"},
                                   {"G1X[1+2]", "parameters"},
                                   {"#1=5", "parameters"},
                                   {"/G1X5", "leave out"},
                                   {"G1X5*71", "checksum"}}) {
    const std::string sentence = refused(std::string("G21\n") + line);
    INFO(sentence);
    CHECK(sentence.find(what) != std::string::npos);
  }
}

TEST_CASE("GcodeRules.ZIsHeldAgainstItsTravel") {
  const auto z_refused = [](const std::string& text, double travel, std::optional<double> lowest) -> std::string {
    try {
      require_z_reach(GcodeProgram::read(as_bytes(text), 78).bounds(), travel, lowest);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  const std::string job = "G0Z5\nG0X0Y0\nG1Z-60F100";
  CHECK(z_refused(job, 80, std::nullopt) == "");
  CHECK(z_refused(job, 60, std::nullopt).find("shallower") != std::string::npos);
  CHECK(z_refused(job, 80, -70) == "");
  CHECK(z_refused(job, 80, -50).find("Set z to 0") != std::string::npos);
  CHECK(z_refused("G0X5Y5", 1, -50) == "");
}

TEST_CASE("GcodeRules.CountingFromWhereTheHeadStandsNeedsTheOrigin") {
  const GcodeProgram relative = GcodeProgram::read(as_bytes(std::string("G91\nG1X10F100")), 78);
  CHECK_THROWS_AS(require_head_at_origin(relative, 0, std::nullopt), Error);
  CHECK_THROWS_AS(require_head_at_origin(relative, 0, std::array<double, 3>{5, 0, 0}), Error);
  CHECK_NOTHROW(require_head_at_origin(relative, 0, std::array<double, 3>{0.05, 0, 7}));
}

}  // namespace
}  // namespace formwright
