// SPDX-License-Identifier: GPL-3.0-or-later
// No mill's job starts before somebody has said where z is 0.
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include "grbl_talk.h"
#include "machines/marlin/marlin_driver.h"
#include "machines/virtual_marlin.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

constexpr double machine_bed_mm = 200;
constexpr const char* milling = "G21G90\nM3S1000\nG0Z5\nG0X10Y10\nG1Z-1F600\nG1X20\nG0Z5\nM5\n";

Json start_with(const Json& z) { return {{"do", "start"}, {"confirmed", true}, {"z", z}}; }

/// A mill with switches, homed, its origin of x and y set, its tool 40 mm below the switch.
struct HomedMill : GrblTalk {
  HomedMill() : GrblTalk({.laser_mode = false}) {
    connect();
    driver = GrblDriver({.tool = MachineTool::mill});
    driver.opened(now_s);
    connect_and_home();
    move_z(-40);
    load(milling);
  }
  void move_z(double mm) {
    tell({{"do", "jog"}, {"z_mm", mm}, {"speed_mm_per_s", 20}});
    pass(0.5);
    REQUIRE(pass_until([&] { return phase() == "idle"; }, 20));
    pass(0.5);
  }
  double head_mm() const { return state()["machine_mm"][2]; }
};

TEST_CASE("MillZ.AHomedMillStartsOnlyOnceSomebodySaidWhereZIsZero") {
  HomedMill mill;
  REQUIRE(mill.can("start"));
  CHECK(mill.refusal({{"do", "start"}, {"confirmed", true}}).find("Where is z 0") != std::string::npos);
  for (const Json& other : {Json("Here"), Json(true), Json(0), Json(nullptr)})
    CHECK(mill.refusal(start_with(other)).find("Where is z 0") != std::string::npos);
  mill.pass(1);
  CHECK(mill.machine.burns().size() == 0U);
  CHECK(mill.state()["job"] == nullptr);
}

TEST_CASE("MillZ.TheStateSaysWhereZIsZeroAndHowLongAgoItWasSet") {
  HomedMill mill;
  CHECK(mill.state()["z_choice"]["origin_machine_mm"] == 0.0);
  CHECK(mill.state()["z_choice"]["set_seconds_ago"] == nullptr);
  mill.tell({{"do", "set_origin"}, {"axes", "z"}});
  mill.pass(3);
  CHECK_THAT(mill.state()["z_choice"]["origin_machine_mm"].get<double>(), WithinAbs(mill.head_mm(), 1e-9));
  CHECK_THAT(mill.state()["z_choice"]["set_seconds_ago"].get<double>(), WithinAbs(3, 0.5));
}

TEST_CASE("MillZ.HereMakesThePlaceOfTheTipZero") {
  HomedMill mill;
  const double tip_mm = mill.head_mm();
  REQUIRE(tip_mm < -30);
  REQUIRE(mill.refusal(start_with("here")) == "");
  {
    const bool reached = mill.pass_until([&] { return mill.ended() == "done"; }, 60);
    INFO(mill.state().dump());
    REQUIRE(reached);
  }
  CHECK_THAT(mill.head_mm(), WithinAbs(tip_mm + 5, 0.02));  // the job ends at z 5
  CHECK_THAT(mill.state()["z_choice"]["origin_machine_mm"].get<double>(), WithinAbs(tip_mm, 1e-9));
}

TEST_CASE("MillZ.KeptLeavesZeroWhereItWas") {
  HomedMill mill;
  const double set_mm = mill.head_mm();
  mill.tell({{"do", "set_origin"}, {"axes", "z"}});
  mill.pass(0.5);
  mill.move_z(10);
  REQUIRE(mill.refusal(start_with("kept")) == "");
  {
    const bool reached = mill.pass_until([&] { return mill.ended() == "done"; }, 60);
    INFO(mill.state().dump());
    REQUIRE(reached);
  }
  CHECK_THAT(mill.head_mm(), WithinAbs(set_mm + 5, 0.02));
}

TEST_CASE("MillZ.TheReachOfTheAxisIsCheckedFromTheZeroThatIsChosen") {
  HomedMill mill;
  // At its switch the tool has no 5 mm above it; what was kept lies lower.
  mill.tell({{"do", "set_origin"}, {"axes", "z"}});
  mill.pass(0.5);
  mill.move_z(39);
  CHECK(mill.refusal(start_with("here")).find("z") != std::string::npos);
  CHECK_THAT(mill.state()["z_choice"]["origin_machine_mm"].get<double>(), WithinAbs(mill.head_mm() - 39, 0.02));
  CHECK(mill.refusal(start_with("kept")) == "");
}

TEST_CASE("MillZ.ALaserAndAJobWithoutZAreNotAsked") {
  HomedMill mill;
  mill.load("G21G90\nM3S1000\nG0X10Y10\nG1X20F600\nM5\n");
  CHECK(mill.state()["z_choice"] == nullptr);
  CHECK(mill.refusal({{"do", "start"}, {"confirmed", true}}) == "");
  GrblTalk laser;
  laser.connect_and_home();
  laser.load("G21G90\nM4S100\nG0Z0\nG1X20F600\nM5\n");
  CHECK(laser.state()["z_choice"] == nullptr);
}

TEST_CASE("MillZ.AMarlinMillIsAskedAsWell") {
  VirtualMarlin machine({}, 1);
  MarlinDriver driver({.controller = DriverController::marlin,
                       .tool = MachineTool::mill,
                       .bed_x_mm = machine_bed_mm,
                       .bed_y_mm = machine_bed_mm});
  driver.opened(machine.now_s());
  std::string sent;
  const auto pass = [&](double seconds) {
    for (const double end_s = machine.now_s() + seconds; machine.now_s() < end_s;) {
      for (const Bytes& packet : driver.take_output()) sent += as_text(packet), machine.receive(as_text(packet));
      machine.advance(0.002);
      driver.received(as_bytes(machine.take_output()), machine.now_s());
      driver.tick(machine.now_s());
    }
  };
  const auto refusal = [&](const Json& command) {
    try {
      driver.command(command, machine.now_s());
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  pass(15);
  REQUIRE(refusal({{"do", "home"}, {"confirmed", true}}) == "");
  pass(15);
  driver.load("test",
              as_bytes(std::string_view("G21\nG90\nM3 S1000\nG0 Z5\nG0 X10 Y10\nG1 Z-1 F600\nG1 X20\nG0 Z5\nM5\n")));
  CHECK(refusal({{"do", "start"}, {"confirmed", true}}).find("Where is z 0") != std::string::npos);
  sent.clear();
  CHECK(refusal(start_with("here")) == "");
  pass(1);
  const std::size_t zeroed = sent.find("G92 Z0"), begins = sent.find("M3");
  REQUIRE(zeroed != std::string::npos);
  REQUIRE(begins != std::string::npos);
  CHECK(zeroed < begins);
}

}  // namespace
}  // namespace formwright
