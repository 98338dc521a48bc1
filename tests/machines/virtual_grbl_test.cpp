// SPDX-License-Identifier: GPL-3.0-or-later
// The virtual GRBL does with its beam, its coordinates and its reports what grbl 1.1h does.
#include "machines/virtual_grbl/virtual_grbl.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

/// A machine without switches, booted.
struct Machine {
  explicit Machine(VirtualGrblOptions options = {.homes = false}) : grbl(options) {
    grbl.open(0);
    pass(1);
    grbl.take_output();
  }
  void pass(double seconds) { grbl.advance(now_s += seconds); }
  /// What it says until `seconds` later.
  std::string tell(const std::string& line, double seconds = 0.1) {
    grbl.receive(line + "\n", now_s);
    pass(seconds);
    return grbl.take_output();
  }
  std::string ask() {
    grbl.receive("?", now_s);
    return grbl.take_output();
  }
  VirtualGrbl grbl;
  double now_s = 0;
};

TEST_CASE("VirtualGrbl.ConstantPowerShinesAtRestBehindACutOnly") {
  Machine machine;
  machine.tell("M3S500");
  CHECK_FALSE(machine.grbl.beam());  // G0
  machine.tell("G1F1000");
  CHECK(machine.grbl.beam());
  machine.tell("G0");
  CHECK_FALSE(machine.grbl.beam());
  machine.tell("G1X5", 2);
  CHECK(machine.grbl.state() == "Idle");
  CHECK(machine.grbl.beam());
  CHECK(machine.ask().find("FS:0,500") != std::string::npos);
  machine.tell("G0X0", 2);
  CHECK_FALSE(machine.grbl.beam());
  machine.tell("G1X5", 2);
  machine.tell("M5");
  CHECK_FALSE(machine.grbl.beam());
}

TEST_CASE("VirtualGrbl.DynamicPowerIsDarkAtRestInLaserModeOnly") {
  for (const bool laser : {true, false}) {
    Machine machine({.homes = false, .laser_mode = laser});
    machine.tell("M4S500");
    machine.tell("G1X5F1000", 2);
    CHECK(machine.grbl.beam() == !laser);
    CHECK_FALSE(machine.grbl.burns().empty());
  }
}

TEST_CASE("VirtualGrbl.JogsKeepTheSpindlesState") {
  for (const char* on : {"M3S500", "M4S500"}) {
    Machine machine;
    machine.tell(on);
    CHECK(machine.grbl.burns().empty());
    machine.tell("$J=G91G21X10F1000", 2);
    REQUIRE_FALSE(machine.grbl.burns().empty());
    CHECK(machine.grbl.burns().front().jog);
    CHECK(machine.grbl.beam() == (on[1] == '3'));  // and what does not go with the speed stays
  }
}

TEST_CASE("VirtualGrbl.HoldsTurnALaserOffAndASpindleNot") {
  for (const bool laser : {true, false}) {
    Machine machine({.homes = false, .laser_mode = laser});
    machine.tell("M3S500");
    machine.tell("G1X100F1000", 1);
    machine.grbl.receive("!", machine.now_s);
    machine.pass(1);
    CHECK(machine.grbl.state() == "Hold");
    CHECK(machine.grbl.beam() == !laser);
    machine.tell("M5");
    CHECK(machine.grbl.beam() == !laser);  // no line is read in a hold
    machine.grbl.receive("\x18", machine.now_s);
    CHECK_FALSE(machine.grbl.beam());
  }
}

TEST_CASE("VirtualGrbl.TheSpindleWaitsForThePlanner") {
  Machine machine;
  machine.tell("M4S500");
  machine.tell("G1X10F600");
  CHECK(machine.tell("M5", 0.3) == "");
  machine.pass(2);
  CHECK(machine.grbl.take_output() == "ok\r\n");
}

TEST_CASE("VirtualGrbl.ALaserAtRestIsLitByAnOverrideWithConstantPower") {
  Machine machine;
  machine.tell("M3S500");
  CHECK_FALSE(machine.grbl.beam());
  machine.grbl.receive("\x9a", machine.now_s);
  machine.pass(0.01);
  CHECK(machine.grbl.beam());  // protocol.c sets the spindle anew whatever the motion mode
}

TEST_CASE("VirtualGrbl.ReportsInInchesAndInWorkCoordinates") {
  Machine machine;
  machine.tell("G10L2P1X10");
  machine.tell("G0X25.4", 2);
  machine.tell("$13=1");
  machine.tell("$10=0");
  const std::string report = machine.ask();
  {
    INFO(report);
    CHECK(report.find("WPos:1.0000,") != std::string::npos);
    CHECK(report.find("WCO:0.3937,") != std::string::npos);
  }
  CHECK(machine.tell("$#").find("[G54:0.3937,") != std::string::npos);
}

TEST_CASE("VirtualGrbl.WorkSystemsOffsetsAndPredefinedPlaces") {
  Machine machine;
  machine.tell("G10L2P2X10Y5");
  machine.tell("G55");
  machine.tell("G0X1Y1", 2);
  CHECK_THAT(machine.grbl.position_mm()[0], WithinAbs(11, 1e-9));
  machine.tell("G92X0");
  machine.tell("G0X2", 2);
  CHECK_THAT(machine.grbl.position_mm()[0], WithinAbs(13, 1e-9));
  machine.tell("G53G0X3", 2);
  CHECK_THAT(machine.grbl.position_mm()[0], WithinAbs(3, 1e-9));
  machine.tell("G92.1");
  machine.tell("G28.1");
  machine.tell("G0X30Y30", 2);
  machine.tell("G28", 2);
  CHECK_THAT(machine.grbl.position_mm()[0], WithinAbs(3, 1e-9));
  machine.tell("G20G0X1", 2);
  CHECK_THAT(machine.grbl.position_mm()[0], WithinAbs(35.4, 1e-9));
  CHECK(machine.tell("$G").find("G55 G17 G20") != std::string::npos);
  machine.tell("M2", 0.2);
  CHECK(machine.tell("$G").find("G1 G54") != std::string::npos);
}

TEST_CASE("VirtualGrbl.ArcsByRadiusAndByCentreEndWhereTheyShould") {
  Machine machine;
  machine.tell("M4S500");
  CHECK(machine.tell("G2X20Y0R10F6000", 4).substr(0, 2) == "ok");
  double high = 0, low = 0;
  for (const auto& burn : machine.grbl.burns())
    high = std::max(high, burn.to_mm[1]), low = std::min(low, burn.to_mm[1]);
  CHECK_THAT(high, WithinAbs(10, 0.01));
  CHECK_THAT(low, WithinAbs(0, 1e-9));
  CHECK_THAT(machine.grbl.position_mm()[0], WithinAbs(20, 1e-9));
  machine.tell("G18G3X0Z0I-10K0", 4);
  CHECK_THAT(machine.grbl.position_mm()[0], WithinAbs(0, 1e-9));
  CHECK(machine.tell("G17G2X50R10") == "error:34\r\n");
  CHECK(machine.tell("G2X50") == "error:35\r\n");
}

TEST_CASE("VirtualGrbl.RefusesAsTheFirmwareDoes") {
  Machine machine;
  for (const auto& [line, error] :
       std::vector<std::pair<const char*, int>>{{"G64", 20},       {"T1M6", 20},        {"G0G1X1", 24},
                                                {"X1X2", 25},      {"G1X1", 22},        {"G", 2},
                                                {"1", 1},          {"G4", 28},          {"G10X1", 28},
                                                {"G92", 26},       {"$J=X1", 22},       {"$J=G2X1F1", 16},
                                                {"G28G1X1F1", 24}, {"$999=1", 3},       {"$H", 5},
                                                {"M3.5", 23},      {"G10L2P9X1", 29},   {"G2I-1", 26},
                                                {"M7", 20},        {"N10000001X1", 27}, {"T300", 38},
                                                {"G43.1X1", 37},   {"G0I1", 36},        {"G1.5X1", 23},
                                                {"G59.1", 23},     {"M400", 23},        {"$J=X-1F100S5", 36},
                                                {"G0X1.2.3", 1}}) {
    INFO(line);
    CHECK(machine.tell(line) == "error:" + std::to_string(error) + "\r\n");
  }
}

TEST_CASE("VirtualGrbl.TakesWhatTheFirmwareTakes") {
  Machine machine;
  for (const char* line :
       {"(comment)", ";comment", "/G0X0", "G0X0(a)Y0", "G0X0;x", "G10L2X0", "$J=F100", "N10000000T255"}) {
    INFO(line);
    CHECK(machine.tell(line) == "ok\r\n");
  }
}

TEST_CASE("VirtualGrbl.StartupLinesRunAtABootAndBehindHomingNotBehindUnlocking") {
  Machine machine(VirtualGrblOptions{});
  CHECK(machine.grbl.state() == "Alarm");
  machine.tell("$X");
  CHECK(machine.tell("$N0=M3S200G1F100") == "ok\r\n");
  machine.tell("M5");
  CHECK(machine.tell("$N").find("$N0=M3S200G1F100\r\n$N1=\r\n") != std::string::npos);
  machine.tell("$H", 3);
  CHECK(machine.grbl.beam());
  machine.tell("M5");
  machine.grbl.brown_out(machine.now_s);
  machine.pass(1);
  CHECK_FALSE(machine.grbl.beam());  // locked
  machine.tell("$X");
  CHECK_FALSE(machine.grbl.beam());
}

TEST_CASE("VirtualGrbl.ChecksWithoutMoving") {
  Machine machine;
  CHECK(machine.tell("$C").find("Enabled") != std::string::npos);
  CHECK(machine.tell("G1X50F100M3S100") == "ok\r\n");
  CHECK(machine.tell("G64") == "error:20\r\n");
  CHECK(machine.grbl.position_mm()[0] == 0);
  CHECK_FALSE(machine.grbl.beam());
  CHECK(machine.tell("$C").find("Grbl 1.1h") != std::string::npos);
}

TEST_CASE("VirtualGrbl.TheErrorLatchKeepsEvenM5FromActing") {
  Machine machine({.homes = false, .error_latch = true});
  machine.tell("G1F1000");
  machine.tell("M3S500");
  CHECK(machine.tell("G64") == "error:20\r\n");
  CHECK(machine.tell("M5") == "error:20\r\n");
  CHECK(machine.grbl.beam());
  machine.tell("");
  CHECK(machine.tell("M5") == "ok\r\n");
  CHECK_FALSE(machine.grbl.beam());
}

TEST_CASE("VirtualGrbl.APowerFailureLosesTheCount") {
  Machine machine;
  machine.tell("G0X50", 2);
  machine.grbl.brown_out(machine.now_s);
  machine.pass(1);
  CHECK(machine.ask().find("MPos:0.000") != std::string::npos);
  CHECK_THAT(machine.grbl.position_mm()[0], WithinAbs(50, 1e-9));
}

}  // namespace
}  // namespace formwright
