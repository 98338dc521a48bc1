// SPDX-License-Identifier: GPL-3.0-or-later
// Where a job may start_job on a GRBL machine, and where it goes on.
#include <catch2/matchers/catch_matchers_floating_point.hpp>
#include <cmath>

#include "grbl_talk.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinULP;

TEST_CASE("GrblDriver.GoingOnLeavesAnUnnamedAxisWhereItIs") {
  GrblTalk talk;
  talk.connect_and_home();
  talk.tell({{"do", "go_to"}, {"x_mm", 10}, {"y_mm", 20}, {"speed_mm_per_s", 50}});
  talk.pass(3);
  const double y = talk.machine.position_mm()[1], x = talk.machine.position_mm()[0] - 10;
  talk.load("G21G90\nG0X15\nG0X30\nG0X40\n");
  Json from = start_job;
  from["from_line"] = 3;
  talk.tell(from);
  CHECK(talk.pass_until([&] { return talk.ended() == "done"; }, 20));
  CHECK_THAT(talk.machine.position_mm()[0], WithinAbs(x + 40, 1e-6));
  CHECK_THAT(talk.machine.position_mm()[1], WithinAbs(y, 1e-6));
}

TEST_CASE("GrblDriver.JobsThatDoNotFitAreRefusedBeforeAnythingMoves") {
  GrblTalk talk;
  talk.connect_and_home();
  const auto there = talk.machine.position_mm();
  talk.load("G21G90\nG0X0\nG0X500\n");
  CHECK(talk.refusal(start_job).find("500 mm long") != std::string::npos);
  talk.load("G21G90\nG0X310Y0\nG0X0\n");  // 310 mm from an origin 301 mm from the end
  CHECK(talk.refusal(start_job).find("leave the bed in x") != std::string::npos);
  CHECK(talk.refusal({{"do", "frame"}, {"bounds_mm", {-150, 0, 20, 20}}, {"speed_mm_per_s", 50}, {"confirmed", true}})
            .find("bed") != std::string::npos);
  talk.pass(1);
  CHECK(talk.machine.position_mm() == there);
}

TEST_CASE("GrblDriver.AJobThatCountsFromTheHeadStartsAtTheOriginOnly") {
  GrblTalk talk;
  talk.connect_and_home();
  const double origin_mm = talk.machine.position_mm()[0];
  const auto rest = [&] {
    talk.pass(0.5);
    REQUIRE(talk.pass_until([&] { return talk.phase() == "idle" && talk.can("start"); }, 20));
  };
  talk.load("G21G91M4S300\nG1X100F6000\nM5\n");
  talk.tell({{"do", "jog"}, {"x_mm", 250}, {"y_mm", 250}, {"speed_mm_per_s", 150}});
  rest();
  // From here it would go to x 350, and the bed ends at 301.
  CHECK(talk.refusal(start_job).find("G91") != std::string::npos);
  talk.tell({{"do", "go_to"}, {"x_mm", 0}, {"y_mm", 0}, {"speed_mm_per_s", 150}});
  rest();
  CHECK(talk.refusal(start_job) == "");
  REQUIRE(talk.pass_until([&] { return !talk.ended().empty(); }, 30));
  CHECK(talk.ended() == "done");
  CHECK_THAT(talk.machine.position_mm()[0], WithinAbs(origin_mm + 100, 1e-9));
  rest();
  CHECK(talk.refusal(start_job) != "");
  talk.tell({{"do", "set_origin"}, {"axes", "xy"}});
  CHECK(talk.refusal(start_job) == "");
  REQUIRE(talk.pass_until([&] { return talk.ended() == "done"; }, 30));
  CHECK_THAT(talk.machine.position_mm()[0], WithinAbs(origin_mm + 200, 1e-9));
  // A tool that is lifted first does not make such a job.
  talk.load("G21G91\nG0Z-5\nG90\nG0X10Y10\nG0X0Y0\n");
  rest();
  CHECK(talk.refusal(start_job) == "");
}

TEST_CASE("GrblDriver.AJobThatCountsFromTheHeadGoesOnFromAnywhere") {
  GrblTalk talk;
  talk.connect_and_home();
  const auto origin = talk.machine.position_mm();
  std::string job = "G21G91\nM4S400\n";
  for (int i = 0; i < 20; ++i) job += "G0Y2\nG1X20F3000\nG0Y2\nG1X-20\n";
  talk.load(job + "M5\n");
  talk.tell(start_job);
  REQUIRE(talk.pass_until([&] { return talk.state()["job"]["acknowledged"] > 40; }, 60));
  talk.tell(stop_job);
  talk.pass(2);
  const int from = talk.state()["job"]["careful_line"];
  REQUIRE(from > 10);
  talk.tell({{"do", "home"}, {"confirmed", true}});
  REQUIRE(talk.pass_until([&] { return talk.phase() == "idle" && talk.state()["position_known"] == true; }, 20));
  talk.pass(1);
  CHECK(talk.refusal(start_job) != "");
  CHECK(talk.refusal({{"do", "start"}, {"confirmed", true}, {"from_line", from}}) == "");
  REQUIRE(talk.pass_until([&] { return !talk.ended().empty(); }, 120));
  CHECK(talk.ended() == "done");
  CHECK_THAT(talk.machine.position_mm()[0], WithinAbs(origin[0], 1e-6));
  CHECK_THAT(talk.machine.position_mm()[1], WithinAbs(origin[1] + 80, 1e-6));
}

TEST_CASE("GrblDriver.AJobMayStartAtOnceFromAnOriginJustSet") {
  GrblTalk talk;
  talk.connect_and_home();
  talk.load("G21G90\nG0X310Y0\nG0X0\n");  // does not fit from where the origin is: 301 mm from the end
  CHECK(talk.refusal(start_job).find("leave the bed in x") != std::string::npos);
  const double head_mm = talk.state()["machine_mm"][0];
  // However long ago the last report was, which named another origin.
  for (int i = 0; i < 8; ++i) {
    talk.tell({{"do", "set_origin"}, {"at", "corner"}});
    CHECK_THAT(talk.state()["work_mm"][0], WithinULP(head_mm + 400, 4));
    for (int k = 0; k < 4; ++k) {
      talk.pass(0.02);
      CHECK_THAT(talk.state()["work_mm"][0], WithinULP(head_mm + 400, 4));
    }
    talk.tell({{"do", "set_origin"}, {"axes", "xy"}});
    CHECK_THAT(talk.state()["work_mm"][0], WithinULP(0.0, 4));
    CHECK(talk.refusal(start_job) != "");
    talk.pass(0.137);
  }
  talk.tell({{"do", "set_origin"}, {"at", "corner"}});
  CHECK(talk.refusal(start_job) == "");
  REQUIRE(talk.pass_until([&] { return talk.ended() == "done"; }, 30));
}

TEST_CASE("GrblDriver.AJobNeverStartsIntoAFrameThatIsNotDone") {
  GrblTalk talk({}, {.burst_s = 0.05});
  talk.connect_and_home();
  talk.load("G21G90\nG0X5Y5\nG0X0Y0\n");
  int started = 0, refused = 0;
  for (int i = 0; i < 60; ++i) {
    REQUIRE(talk.pass_until([&] { return talk.can("frame"); }, 5));
    talk.tell({{"do", "frame"}, {"bounds_mm", {0, 0, 10, 10}}, {"speed_mm_per_s", 50}, {"confirmed", true}});
    talk.pass(0.04 * i);
    if (talk.refusal(start_job) != "") {
      ++refused;
      talk.pass(1.5);
      continue;
    }
    ++started;
    REQUIRE(talk.pass_until([&] { return talk.ended() != ""; }, 10));
    INFO("after " << 0.04 * i << " s: " << talk.state().dump());
    CHECK(talk.ended() == "done");
  }
  CHECK(started > 5);
  CHECK(refused > 5);
}

TEST_CASE("GrblDriver.GoesOnTheCarefulWay") {
  GrblTalk talk;
  talk.connect_and_home();
  std::string job = "G21G90\nM4S400\n";
  for (int i = 0; i < 30; ++i) {
    const std::string y = std::to_string(2 * i);
    job += "G0X0Y" + y + "\nG1X20F1500\n";
  }
  job += "M5\n";
  talk.load(job);
  talk.tell(start_job);
  REQUIRE(talk.pass_until([&] { return talk.state()["job"]["acknowledged"] > 40; }, 60));
  talk.tell(stop_job);
  talk.pass(2);
  const int from = talk.state()["job"]["careful_line"];
  CHECK(from > 10);
  CHECK(from <= 40 - 16 + 2);
  CHECK(talk.refusal({{"do", "start"}, {"confirmed", true}, {"from_line", from}}) !=
        "");  // where the head stands is unknown
  talk.tell({{"do", "home"}, {"confirmed", true}});
  REQUIRE(talk.pass_until([&] { return talk.phase() == "idle" && talk.state()["position_known"] == true; }, 20));
  const std::size_t burns_before = talk.machine.burns().size();
  talk.tell({{"do", "start"}, {"confirmed", true}, {"from_line", from}});
  REQUIRE(talk.pass_until([&] { return !talk.ended().empty(); }, 120));
  CHECK(talk.ended() == "done");
  // Every row is whole: each y has a stroke of 20 mm in one of the two runs.
  std::map<long, double> rows;
  for (const auto& burn : talk.machine.burns()) {
    CHECK_THAT(burn.power, WithinULP(400.0, 4));
    CHECK_THAT(burn.from_mm[1], WithinAbs(burn.to_mm[1], 1e-9));
    rows[std::lround(burn.from_mm[1] * 10)] += std::abs(burn.to_mm[0] - burn.from_mm[0]);
  }
  CHECK(rows.size() == 30u);
  for (const auto& [y, length] : rows) CHECK(length >= 20 - 1e-6);
  CHECK(talk.machine.burns().size() > burns_before);
}

// The report of rest from before the line is all that is known until the next one.
TEST_CASE("GrblDriver.AJobWaitsUntilALineByHandHasMoved") {
  GrblTalk talk;
  talk.connect_and_home();
  talk.tell({{"do", "set_origin"}, {"axes", "xy"}});
  talk.pass(1);
  talk.load("G21G90\nM4S500\nG1X20F1200\nM5\n");  // its first cut begins where the head is
  talk.tell({{"do", "send"}, {"line", "G0X30Y30"}, {"confirmed", true}});
  for (int ms = 0; ms < 300 && talk.machine.state() != "Run"; ++ms) talk.pass(1e-3);
  REQUIRE(talk.machine.state() == "Run");
  CHECK_FALSE(talk.can("start"));
  CHECK_FALSE(talk.refusal(start_job).empty());
  REQUIRE(talk.pass_until([&] { return talk.phase() == "idle"; }, 10));
  CHECK(talk.refusal(start_job).find("where that begins") != std::string::npos);
}

}  // namespace
}  // namespace formwright
