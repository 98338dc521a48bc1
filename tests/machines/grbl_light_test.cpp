// SPDX-License-Identifier: GPL-3.0-or-later
// The beam is dark whenever no stroke is burnt, whoever forgot to turn it off and whoever is gone.
#include <catch2/matchers/catch_matchers_floating_point.hpp>
#include <cmath>

#include "grbl_talk.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

const Json focus = {{"do", "focus"}, {"power_percent", 1}, {"confirmed", true}};
const Json home = {{"do", "home"}, {"confirmed", true}};
const Json frame = {{"do", "frame"}, {"bounds_mm", {5, 5, 60, 40}}, {"speed_mm_per_s", 100}, {"confirmed", true}};
const Json go_to = {{"do", "go_to"}, {"x_mm", 20}, {"y_mm", 20}, {"speed_mm_per_s", 100}};
const Json jog = {{"do", "jog"}, {"x_mm", 20}, {"speed_mm_per_s", 100}};

double lit_s(const GrblTalk& talk) {
  double sum = 0;
  for (const auto& burn : talk.machine.burns()) sum += burn.seconds;
  return sum;
}

void expect_strokes_only(const GrblTalk& talk) {
  for (const auto& burn : talk.machine.burns()) {
    CHECK_FALSE(burn.jog);
    INFO(burn.seconds << " s at rest");
    CHECK(burn.from_mm != burn.to_mm);
  }
}

bool heard(const GrblTalk& talk, const std::string& words) {
  return std::any_of(talk.events.begin(), talk.events.end(), [&](const Json& event) {
    return event.contains("text") && event["text"].get<std::string>().find(words) != std::string::npos;
  });
}

TEST_CASE("GrblLight.AJobThatEndsWithoutM5LeavesNothingOn") {
  for (const char* on : {"M3", "M4"})
    for (const Json& next : {frame, jog, go_to, home}) {
      GrblTalk talk;
      talk.connect_and_home();
      talk.load(std::string("G21\nG90\n") + on + " S800\nG1 X50 F3000\nG1 Y50\n");
      talk.tell(start_job);
      REQUIRE(talk.pass_until([&] { return talk.ended() == "done"; }, 30));
      CHECK(talk.machine.lines().back() == "M5");
      const double before = lit_s(talk);
      talk.tell(next);
      talk.pass(5);
      {
        INFO(on << next);
        CHECK(lit_s(talk) == before);
      }
      CHECK(talk.state()["laser_on"] == false);
      expect_strokes_only(talk);
    }
}

TEST_CASE("GrblLight.M5IsAnsweredBeforeTheHeadMoves") {
  GrblTalk talk;
  talk.connect_and_home();
  talk.tell({{"do", "send"}, {"line", "M4S500"}, {"confirmed", true}});
  talk.pass(0.2);
  talk.tell(jog);
  talk.pass(1);
  expect_strokes_only(talk);
  CHECK(talk.machine.burns().empty());
  // Refused, it keeps the head where it is.
  talk.tell({{"do", "send"}, {"line", "M4S500"}, {"confirmed", true}});
  talk.pass(0.2);
  const auto there = talk.machine.position_mm();
  talk.machine.refuse_next(3);
  talk.tell(frame);
  talk.pass(0.5);
  CHECK(talk.machine.position_mm() == there);
  CHECK(heard(talk, "refused to turn its laser"));
}

TEST_CASE("GrblLight.AJobThatBeginsAtTheOriginIsNotBegunElsewhere") {
  VirtualGrblOptions options;
  options.origin_low = true;
  GrblTalk talk(options);
  talk.connect();
  REQUIRE(talk.pass_until([&] { return talk.can("home"); }, 5));
  talk.tell(home);
  REQUIRE(talk.pass_until([&] { return talk.state()["position_known"] == true && talk.phase() == "idle"; }, 9));
  talk.tell({{"do", "send"}, {"line", "G10L2P1X100Y100"}, {"confirmed", true}});
  talk.pass(1);
  talk.load("G21\nG90\nM4 S800\nG1 X50 F3000\nG1 Y50\nM5\n");  // its writer thought that it stands at 0, 0
  CHECK(talk.refusal(start_job).find("x 0, y 0") != std::string::npos);
  talk.tell({{"do", "go_to"}, {"x_mm", 0}, {"y_mm", 0}, {"speed_mm_per_s", 150}});
  talk.pass(0.5);
  REQUIRE(talk.pass_until([&] { return talk.phase() == "idle" && talk.can("start"); }, 9));
  talk.pass(1);
  talk.tell(start_job);
  REQUIRE(talk.pass_until([&] { return talk.ended() == "done"; }, 30));
  for (const auto& burn : talk.machine.burns()) {
    INFO(burn.from_mm[0] << " " << burn.from_mm[1]);
    CHECK((burn.from_mm[1] == 100 || burn.from_mm[0] == 150));
  }
  // One that says where it begins goes there in the dark.
  talk.load("G21\nG90\nG0X0Y0\nM4 S800\nG1 X50 F3000\nM5\n");
  CHECK(talk.refusal(start_job) == "");
}

TEST_CASE("GrblLight.AKilledProgramLeavesItDarkInTheMiddleOfAnM3Job") {
  GrblTalk talk({.resets_on_open = false});
  talk.connect_and_home();
  talk.load("G21G90\nM3S500\nG1F3000\nX50\nY50\nX0\nY0\nX50\nY50\nX0\nY0\n");
  CHECK(talk.state()["warnings"].dump().find("M4") != std::string::npos);
  CHECK(talk.state()["when_connection_ends"].get<std::string>().find("laser off") != std::string::npos);
  talk.tell(start_job);
  REQUIRE(talk.pass_until([&] { return talk.machine.beam(); }, 5));
  talk.kill_host(true);
  talk.leave_alone(60);
  CHECK(talk.machine.state() == "Idle");
  CHECK_FALSE(talk.machine.beam());
  expect_strokes_only(talk);
  // Whoever comes next turns it off before anything moves.
  talk.plug_in();
  talk.connect();
  talk.pass(1);
  CHECK(talk.machine.lines().back() == "M5");
}

TEST_CASE("GrblLight.AJobThatBurnsAtRestIsConfirmedInWords") {
  GrblTalk talk;
  talk.connect_and_home();
  talk.load("G21G90\nM3S500\nG1X5F3000\nG4P0.2\nG1X9\nM5\n");
  CHECK(talk.refusal({{"do", "start"}}).find("line 4 burns at rest") != std::string::npos);
  CHECK(talk.state()["when_connection_ends"].get<std::string>().find("laser ON") != std::string::npos);
  talk.tell(start_job);
  REQUIRE(talk.pass_until([&] { return talk.ended() == "done"; }, 30));
  CHECK_THAT(lit_s(talk), WithinAbs(0.2, 0.4));
  CHECK_FALSE(talk.machine.beam());
}

TEST_CASE("GrblLight.FocusIsARowOfPulsesThatEndByThemselves") {
  GrblTalk talk;
  talk.connect_and_home();
  talk.tell({{"do", "override"}, {"power_percent", 200}});
  talk.pass(0.3);
  talk.tell(focus);
  CHECK_FALSE(talk.can("override"));
  talk.pass(5);
  CHECK(talk.state()["laser_on"] == true);
  CHECK(lit_s(talk) > 4.5);  // hardly a gap
  for (const auto& burn : talk.machine.burns()) CHECK(burn.power == 10);
  const double before = lit_s(talk);
  talk.kill_host(true);
  talk.leave_alone(60);
  CHECK(lit_s(talk) - before <= 1.1);
}

TEST_CASE("GrblLight.NothingCarriesTheFocusLightAlong") {
  for (const Json& next : {frame, jog, go_to, home, Json{{"do", "focus_off"}}, Json{{"do", "stop"}}}) {
    GrblTalk talk;
    talk.connect_and_home();
    talk.tell(focus);
    talk.pass(0.5);
    REQUIRE(talk.machine.beam());
    const auto spot = talk.machine.position_mm();
    talk.tell(next);
    talk.pass(next["do"] == "stop" ? 0.05 : 1.2);
    {
      INFO(next);
      CHECK_FALSE(talk.machine.beam());
    }
    talk.pass(4);
    for (const auto& burn : talk.machine.burns()) {
      INFO(next);
      CHECK((burn.from_mm == spot && burn.to_mm == spot));
    }
    CHECK_FALSE(talk.can("focus_off"));
  }
}

TEST_CASE("GrblLight.ALostByteKeepsNoPulseOn") {
  Random random(5);
  for (int round = 0; round < 40; ++round) {
    GrblTalk talk({.error_latch = round % 2 == 1}, {}, random.next());
    talk.connect_and_home();
    talk.tell(focus);
    talk.faults().lose_to_machine = 0.02;
    talk.pass(4);
    talk.kill_host(true);
    const double before = lit_s(talk);
    talk.leave_alone(20);
    INFO(round);
    CHECK(lit_s(talk) - before <= 1.1);
    for (const auto& burn : talk.machine.burns()) CHECK(burn.power <= 10);
  }
}

TEST_CASE("GrblLight.LightThatNobodyAskedForIsTurnedOff") {
  GrblTalk talk;
  talk.connect_and_home();
  // From the board's own panel, say.
  talk.machine.receive("M3S300G1F100\n", talk.now_s);
  talk.pass(1.5);
  CHECK_FALSE(talk.machine.beam());
  CHECK(heard(talk, "reports its laser on"));
  CHECK(talk.state()["position_known"]);
}

TEST_CASE("GrblLight.LinesByHandAreDarkAtRest") {
  GrblTalk talk;
  talk.connect_and_home();
  talk.tell({{"do", "send"}, {"line", "G1F900"}, {"confirmed", true}});
  talk.tell({{"do", "send"}, {"line", "m3 s500"}, {"confirmed", true}});
  talk.pass(2);
  CHECK(lit_s(talk) == 0);
}

TEST_CASE("GrblLight.ALimitSwitchIsResetAtOnceAndStaysAnAlarm") {
  GrblTalk talk;
  talk.connect_and_home();
  talk.machine.trip_limit();
  talk.pass(1);
  CHECK(talk.phase() == "alarm");
  CHECK(talk.state()["alarm"]["code"] == 1);
  CHECK(talk.state()["connection"] == "ready");
  talk.pass(5);
  CHECK(talk.state()["connection"] == "ready");  // it reports again
  CHECK_FALSE(talk.state()["position_known"]);
}

TEST_CASE("GrblLight.AStopWakesABoardThatSleepsOrIsSilent") {
  GrblTalk talk;
  talk.connect_and_home();
  talk.machine.receive("$SLP\n", talk.now_s);
  talk.pass(1);
  CHECK(talk.phase() == "sleep");
  talk.tell({{"do", "stop"}});
  talk.pass(2);
  CHECK(talk.phase() == "idle");
}

/// A machine with a long buffer goes on when its program is gone. Its dwell looks like rest to the next program, whose
/// first questions are then answered by the job's lines.
TEST_CASE("GrblLight.ARefusedLineOfAnEarlierProgramStopsTheMachine") {
  GrblTalk talk({.resets_on_open = false, .planner_blocks = 35, .rx_bytes = 1024});
  talk.connect_and_home();
  talk.load("G21\nG90\nM4S500\nG0X0Y0\nG1F1200\nG1X40Y0\nG4P2\nG0X0Y30\nG1X40Y30\nG1X40Y60\nM5\n");
  talk.machine.refuse_line("G0X0Y30", 20);
  talk.tell(start_job);
  REQUIRE(talk.pass_until([&] { return talk.machine.beam(); }, 20));
  talk.pull_cable();
  talk.leave_alone(2);
  const auto origin = talk.machine.origin_mm(54);
  REQUIRE(talk.pass_until([&] { return !talk.machine.beam(); }, 5));
  talk.plug_in();
  talk.pass(6);
  CHECK(heard(talk, "refused a line that was sent before this connection"));
  CHECK_FALSE(talk.machine.has_work());
  for (const auto& burn : talk.machine.burns())
    for (const auto& place : {burn.from_mm, burn.to_mm}) {
      CHECK_THAT(place[1] - origin[1], WithinAbs(0, 0.02));
      CHECK(place[0] - origin[0] <= 40.02);
    }
  CHECK(talk.state()["connection"] == "ready");
}

TEST_CASE("GrblLight.AJogWaitsForM5AlsoWhereALineByHandStandsBehindAFocusPulse") {
  GrblTalk talk;
  talk.connect_and_home();
  talk.tell(focus);
  talk.pass(0.3);
  talk.tell({{"do", "send"}, {"line", "M3S300"}, {"confirmed", true}});
  talk.tell({{"do", "focus_off"}});
  talk.pass(3);
  talk.tell(jog);
  talk.pass(2);
  const auto& lines = talk.machine.lines();
  const auto jogs =
      std::find_if(lines.begin(), lines.end(), [](const std::string& l) { return l.find("X20") != l.npos; });
  REQUIRE(jogs != lines.end());
  CHECK(*std::prev(jogs) == "M5");
  for (const auto& burn : talk.machine.burns()) CHECK_FALSE(burn.jog);
}

TEST_CASE("GrblLight.NoJobStartsWhileHomingWaits") {
  GrblTalk talk;
  talk.connect_and_home();
  talk.load("G21\nG90\nM4S100\nG0X1Y1\nG1X5F1000\nM5\n");
  talk.tell(focus);
  talk.pass(0.3);
  talk.tell(home);
  REQUIRE(talk.phase() == "idle");
  CHECK_FALSE(talk.can("start"));
  CHECK(talk.refusal(start_job).find("still moving") != std::string::npos);
}

}  // namespace
}  // namespace formwright
