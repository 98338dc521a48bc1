// SPDX-License-Identifier: GPL-3.0-or-later
// What a machine's settings and state would make of a job is known before it begins.
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include "grbl_talk.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

const std::string square_without_end = "G21G90\nM4S500\nG0X10Y10\nG1X30F1200\nY30\nX10\nY10\nM5\n";

void by_hand(GrblTalk& talk, const std::string& line) {
  talk.tell({{"do", "send"}, {"line", line}, {"confirmed", true}});
  talk.pass(1);
}

TEST_CASE("GrblMachine.ReportsInInchesAreMillimetresHere") {
  GrblTalk talk;
  talk.machine.set_setting(13, 1);
  talk.machine.set_setting(10, 0);
  talk.connect_and_home();
  for (std::size_t axis = 0; axis < 2; ++axis)
    CHECK_THAT(talk.state()["machine_mm"][axis].get<double>(), WithinAbs(talk.machine.position_mm()[axis], 3e-3));
  talk.load(square_without_end);
  talk.tell(start_job);
  REQUIRE(talk.pass_until([&] { return talk.ended() == "done"; }, 60));
  CHECK_THAT(talk.state()["work_mm"][0].get<double>(), WithinAbs(10, 3e-3));
  by_hand(talk, "$13=0");
  CHECK_THAT(talk.state()["work_mm"][0].get<double>(), WithinAbs(10, 3e-3));
}

TEST_CASE("GrblMachine.PowersBeyondTheMachinesAreRefused") {
  GrblTalk talk;
  talk.machine.set_setting(30, 255);
  talk.connect_and_home();
  talk.load(square_without_end);
  const std::string refusal = talk.refusal(start_job);
  {
    INFO(refusal);
    CHECK(refusal.find("Line 2 asks for S500") != std::string::npos);
  }
  CHECK(refusal.find("255") != std::string::npos);
  by_hand(talk, "$30=1000");
  by_hand(talk, "$31=1000");
  CHECK(talk.refusal(start_job).find("$31=0") != std::string::npos);
  by_hand(talk, "$31=0");
  CHECK(talk.refusal(start_job) == "");
}

TEST_CASE("GrblMachine.StartupLinesThatFireOrMoveAreRefused") {
  for (const char* line : {"M3S200", "G0X5"}) {
    GrblTalk talk;
    talk.machine.set_startup_line(1, line);
    talk.connect();
    REQUIRE(talk.pass_until([&] { return talk.can("home"); }, 5));
    CHECK(talk.refusal({{"do", "home"}, {"confirmed", true}}).find("$N1=") != std::string::npos);
    talk.tell({{"do", "unlock"}});
    talk.pass(0.5);
    by_hand(talk, "$N1=");
    CHECK(talk.refusal({{"do", "home"}, {"confirmed", true}}) == "");
  }
  GrblTalk talk;
  talk.machine.set_startup_line(0, "G21G90");
  talk.connect_and_home();
}

TEST_CASE("GrblMachine.AJobBeginsInAKnownState") {
  GrblTalk talk;
  talk.connect_and_home();
  const auto origin = talk.machine.position_mm();
  for (const char* line : {"G20", "G91", "G18", "G10L2P2X-9Y-9", "G55", "S900", "G1F100"}) by_hand(talk, line);
  talk.load("M4S500\nG0X10Y10\nG1X30F1200\nM5\n");
  talk.tell(start_job);
  REQUIRE(talk.pass_until([&] { return !talk.ended().empty(); }, 60));
  CHECK(talk.ended() == "done");
  CHECK_THAT(talk.machine.position_mm()[0], WithinAbs(origin[0] + 30, 1e-9));
  CHECK_THAT(talk.machine.position_mm()[1], WithinAbs(origin[1] + 10, 1e-9));
  for (const auto& burn : talk.machine.burns()) CHECK(burn.power == 500);
}

TEST_CASE("GrblMachine.OffsetsInForceAreRefused") {
  GrblTalk talk;
  talk.connect_and_home();
  talk.load(square_without_end);
  by_hand(talk, "G92X5");
  CHECK(talk.refusal(start_job).find("G92.1") != std::string::npos);
  by_hand(talk, "G92.1");
  by_hand(talk, "G43.1Z2");
  CHECK(talk.refusal(start_job).find("G49") != std::string::npos);
  by_hand(talk, "G49");
  CHECK(talk.refusal(start_job) == "");
}

TEST_CASE("GrblMachine.OffsetsOfAMachineThatDidNotResetAreAskedFor") {
  GrblTalk talk({.resets_on_open = false});
  talk.connect_and_home();
  by_hand(talk, "G92X5");
  talk.kill_host(true);
  talk.leave_alone(1);
  talk.plug_in();
  talk.connect();
  CHECK(talk.state()["warnings"].dump().find("G92.1") != std::string::npos);
}

TEST_CASE("GrblMachine.HomingBySingleAxesIsRefusedWhereTheBuildHasNone") {
  // GRBL 1.1h stays in the state "Home" for ever behind "$HX" and "$H=1".
  GrblTalk talk;
  talk.connect();
  for (const char* line : {"$HX", "$H=1"})
    CHECK(talk.refusal({{"do", "send"}, {"line", line}, {"confirmed", true}}).find("send $H") != std::string::npos);
}

TEST_CASE("GrblMachine.PlacesAreKnownPerAxis") {
  GrblTalk talk({.homes = false, .laser_mode = false});
  talk.connect();
  talk.driver = GrblDriver({.tool = MachineTool::mill});
  talk.driver.opened(talk.now_s);
  talk.connect();
  const auto set = [&](const char* axes) {
    talk.tell({{"do", "set_origin"}, {"axes", axes}});
    talk.pass(0.5);
  };
  talk.load("G21G90\nM3S1000\nG0Z5\nG0X10Y10\nG1Z-1F100\nG1X20\nG0Z5\nM5\n");
  CHECK(talk.refusal(start_job).find("set the origin") != std::string::npos);
  set("z");
  CHECK(talk.state()["axes_known"] == Json{{"x", false}, {"y", false}, {"z", true}});
  CHECK_FALSE(talk.state()["position_known"]);
  CHECK_FALSE(talk.can("frame"));
  CHECK(talk.refusal(start_job) != "");
  talk.tell({{"do", "stop"}});  // nothing is known any more
  talk.pass(2);
  set("xy");
  CHECK(talk.can("frame"));
  CHECK(talk.refusal(start_job).find("Set z") != std::string::npos);
  set("z");
  CHECK(talk.refusal({{"do", "start"}, {"confirmed", true}, {"z", "kept"}}) == "");
  REQUIRE(talk.pass_until([&] { return talk.ended() == "done"; }, 60));
  CHECK(talk.state()["when_connection_ends"].get<std::string>().find("spindle running") != std::string::npos);
}

TEST_CASE("GrblMachine.GoingOnHeedsThePlannersSize") {
  GrblTalk talk({.planner_blocks = 100, .rx_bytes = 1024});
  talk.connect_and_home();
  std::string job = "G21G90\nM4S500\nG0X0Y0\nF600\n";
  for (int i = 1; i <= 400; ++i)
    job += "G1X" + std::to_string(i % 2) + "Y" + std::to_string(i / 8) + "\nS" + std::to_string(300 + i) + "\nG0X5\n";
  talk.load(job);
  talk.tell(start_job);
  REQUIRE(talk.pass_until([&] { return talk.state()["job"]["acknowledged"] > 600; }, 200));
  const double y_mm = talk.machine.position_mm()[1] - talk.machine.origin_mm(54)[1];
  const Json state = talk.state()["job"];
  // The careful line lies before where the head is: 101 moves, each third line none, back from what is answered.
  CHECK(state["careful_line"].get<int>() <= state["acknowledged"].get<int>() - 150);
  CHECK((state["careful_line"].get<int>() - 5) / 3 / 8 <= y_mm + 1);
}

TEST_CASE("GrblMachine.AForgottenPieceOfALineSpoilsNoGreeting") {
  GrblTalk talk({.resets_on_open = false});
  talk.connect_and_home();
  talk.kill_host(false);
  talk.machine.receive("G1X1", talk.now_s);  // the rest never came
  const auto there = talk.machine.position_mm();
  talk.leave_alone(1);
  talk.plug_in();
  talk.connect();
  talk.pass(1);
  CHECK(talk.state()["firmware"] == "1.1h.20190825");
  CHECK(talk.machine.position_mm() == there);
}

}  // namespace
}  // namespace formwright
