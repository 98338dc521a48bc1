// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/grbl/grbl_driver.h"

#include <catch2/matchers/catch_matchers_floating_point.hpp>
#include <cmath>

#include "grbl_talk.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

const std::string square = "G21G90\nM4S500\nG0X10Y10\nG1X30F1200\nY30\nX10\nY10\nM5\nG0X0Y0\nM2\n";
TEST_CASE("GrblDriver.GreetsAndLearnsWhatTheMachineIs") {
  GrblTalk talk;
  CHECK(talk.state()["connection"] == "greeting");
  talk.connect();
  CHECK(talk.state()["firmware"] == "1.1h.20190825");
  CHECK(talk.phase() == "alarm");  // homing is on: locked until then
  CHECK_FALSE(talk.state()["position_known"]);
  CHECK(talk.can("home"));
  CHECK(talk.can("stop"));
  CHECK_FALSE(talk.can("start"));
}

TEST_CASE("GrblDriver.ConnectsToABoardThatDoesNotReset") {
  VirtualGrblOptions options;
  options.homes = false;
  GrblTalk talk(options);
  talk.connect();
  talk.driver.closed(talk.now_s);
  CHECK(talk.state()["connection"] == "closed");
  talk.driver.opened(talk.now_s);  // the machine is not told: no banner comes
  talk.connect();
  CHECK(talk.phase() == "idle");
}

TEST_CASE("GrblDriver.KnowsTheOriginBeforeAReportSaysIt") {
  VirtualGrblOptions options;
  options.resets_on_open = false;
  GrblTalk talk(options);
  talk.connect_and_home();
  talk.pass(0.3);  // the next report that says the origin comes in about two seconds
  talk.driver.closed(talk.now_s);
  talk.driver.opened(talk.now_s);
  {
    const bool reached = talk.pass_until([&] { return !talk.state()["machine_mm"].is_null(); }, 5);
    INFO(talk.state().dump());
    REQUIRE(reached);
  }
  talk.pass(0.3);  // one report more
  {
    INFO(talk.state().dump());
    REQUIRE_FALSE(talk.state()["work_mm"].is_null());
  }
  CHECK_THAT(talk.state()["work_mm"][0].get<double>(), WithinAbs(0, 1e-9));
  CHECK_THAT(talk.state()["machine_mm"][0].get<double>(), WithinAbs(talk.machine.position_mm()[0], 1e-3));
}

TEST_CASE("GrblDriver.ConnectsToAMachineThatIsHeld") {
  VirtualGrblOptions options;
  options.resets_on_open = false;
  GrblTalk talk(options);
  talk.connect_and_home();
  talk.load(square);
  talk.tell(start_job);
  REQUIRE(talk.pass_until([&] { return talk.machine.beam(); }, 10));
  talk.tell({{"do", "pause"}});
  REQUIRE(talk.pass_until([&] { return talk.phase() == "paused"; }, 2));
  talk.driver.closed(talk.now_s);
  talk.driver.opened(talk.now_s);
  talk.connect();
  CHECK(talk.phase() == "paused");
  CHECK(talk.can("resume"));
  talk.tell(stop_job);
  talk.pass(3);
  CHECK(talk.phase() == "idle");
  CHECK(talk.state()["firmware"] == "1.1h.20190825");  // asked for once it rests
}

TEST_CASE("GrblDriver.NothingMovesOrFiresWithoutConfirmation") {
  GrblTalk talk;
  talk.connect();
  CHECK(talk.refusal({{"do", "home"}}) != "");
  talk.connect_and_home();
  talk.load(square);
  for (const char* what : {"start", "frame", "focus"}) {
    Json command = {{"do", what}, {"bounds_mm", {0, 0, 10, 10}}, {"power_percent", 1}};
    {
      INFO(what);
      CHECK(talk.refusal(command).find("confirmed") != std::string::npos);
    }
    command["confirmed"] = "yes";
    INFO(what);
    CHECK(talk.refusal(command).find("confirmed") != std::string::npos);
  }
  CHECK(talk.refusal({{"do", "send"}, {"line", "G0 X5"}}).find("confirmed") != std::string::npos);
  CHECK(talk.refusal({{"do", "send"}, {"line", "m3 s5"}}).find("confirmed") != std::string::npos);
  CHECK(talk.refusal({{"do", "send"}, {"line", "$G"}}) == "");
  const auto before = talk.machine.position_mm();
  talk.pass(1);
  CHECK(talk.machine.position_mm() == before);
  CHECK(talk.machine.burns().empty());
}

TEST_CASE("GrblDriver.CutsWhatTheJobSays") {
  GrblTalk talk;
  talk.connect_and_home();
  const auto origin = talk.machine.position_mm();
  talk.load(square);
  talk.tell(start_job);
  {
    const bool reached = talk.pass_until([&] { return !talk.ended().empty(); }, 60);
    INFO(talk.state().dump());
    REQUIRE(reached);
  }
  CHECK(talk.ended() == "done");
  CHECK(talk.machine.bytes_lost() == 0);
  double length = 0;
  for (const auto& burn : talk.machine.burns()) {
    length += std::hypot(burn.to_mm[0] - burn.from_mm[0], burn.to_mm[1] - burn.from_mm[1]);
    for (const auto& p : {burn.from_mm, burn.to_mm}) {
      const double x = p[0] - origin[0], y = p[1] - origin[1];
      CHECK_THAT(std::min({std::abs(x - 10), std::abs(x - 30), std::abs(y - 10), std::abs(y - 30)}),
                 WithinAbs(0, 1e-9));
    }
  }
  CHECK_THAT(length, WithinAbs(80, 1e-6));
  CHECK(talk.machine.position_mm() == origin);  // done means done, not only taken in
  CHECK(talk.state()["job"]["acknowledged"] == 10);
}

TEST_CASE("GrblDriver.StopEndsEverythingAndForgetsThePosition") {
  GrblTalk talk;
  talk.connect_and_home();
  talk.load("G21G90M4S500\nG1X250F600\nX0\nX250\n");
  talk.tell(start_job);
  talk.pass(2);
  REQUIRE(talk.machine.beam());
  talk.tell(stop_job);
  talk.pass(0.1);
  CHECK_FALSE(talk.machine.beam());
  talk.pass(1.5);
  CHECK(talk.ended() == "stopped");
  CHECK_FALSE(talk.state()["position_known"]);
  const auto there = talk.machine.position_mm();
  talk.pass(5);
  CHECK(talk.machine.position_mm() == there);  // the queue does not go on by itself
  CHECK(talk.refusal(start_job) != "");
  // It came to rest before the reset: no alarm, but homing is asked for all the same.
  CHECK(talk.phase() == "idle");
  CHECK(talk.can("home"));
}

TEST_CASE("GrblDriver.StopWithoutLaserModeResetsAtOnce") {
  VirtualGrblOptions options;
  options.laser_mode = false;
  GrblTalk talk(options);
  talk.connect_and_home();
  talk.load("G21G90\nG1X250F600\n");
  talk.tell(start_job);
  talk.pass(2);
  talk.tell(stop_job);
  talk.pass(0.05);
  CHECK(talk.machine.state() == "Alarm");
  talk.pass(1);
  CHECK(talk.state()["alarm"]["code"] == 3);
}

TEST_CASE("GrblDriver.RefusesLaserJobsWithoutLaserMode") {
  VirtualGrblOptions options;
  options.laser_mode = false;
  GrblTalk talk(options);
  talk.connect_and_home();
  talk.load(square);
  CHECK(talk.refusal(start_job).find("$32=1") != std::string::npos);
}

TEST_CASE("GrblDriver.HoldsAndGoesOn") {
  GrblTalk talk;
  talk.connect_and_home();
  talk.load(square);
  talk.tell(start_job);
  REQUIRE(talk.pass_until([&] { return talk.machine.beam(); }, 10));
  talk.tell({{"do", "pause"}});
  {
    const bool reached = talk.pass_until([&] { return talk.phase() == "paused"; }, 2);
    INFO(talk.state().dump());
    REQUIRE(reached);
  }
  CHECK_FALSE(talk.machine.beam());
  const auto there = talk.machine.position_mm();
  talk.pass(3);
  CHECK(talk.machine.position_mm() == there);
  CHECK(talk.refusal({{"do", "resume"}}).find("confirmed") != std::string::npos);
  talk.tell({{"do", "resume"}, {"confirmed", true}});
  REQUIRE(talk.pass_until([&] { return !talk.ended().empty(); }, 60));
  CHECK(talk.ended() == "done");
}

TEST_CASE("GrblDriver.ARefusedLineEndsTheJob") {
  GrblTalk talk;
  talk.connect_and_home();
  talk.machine.refuse_line("M1", 20);
  talk.load("G21G90\nM4S500\nG1X10F600\nM1\nG1X200\nM5\n");
  talk.tell(start_job);
  REQUIRE(talk.pass_until([&] { return !talk.ended().empty(); }, 60));
  CHECK(talk.ended() == "failed");
  CHECK(talk.state()["error"]["line_number"] == 4);
  CHECK(talk.state()["error"]["code"] == 20);
  talk.pass(2);
  CHECK_FALSE(talk.machine.beam());
  CHECK(talk.machine.position_mm()[0] < -301 + 60);
}

TEST_CASE("GrblDriver.AlarmsAreSaidInWords") {
  GrblTalk talk;
  talk.connect_and_home();
  talk.load(square);
  talk.tell(start_job);
  talk.pass(1);
  talk.machine.trip_limit();
  talk.pass(0.5);
  CHECK(talk.ended() == "failed");
  CHECK(talk.phase() == "alarm");
  CHECK(talk.state()["alarm"]["text"].get<std::string>().find("limit switch") != std::string::npos);
  CHECK_FALSE(talk.state()["position_known"]);
  // The machine hears nothing but a reset now; homing sends it by itself.
  talk.tell({{"do", "home"}, {"confirmed", true}});
  {
    const bool reached =
        talk.pass_until([&] { return talk.phase() == "idle" && talk.state()["position_known"] == true; }, 20);
    INFO(talk.state().dump());
    REQUIRE(reached);
  }
  CHECK(talk.state()["alarm"].is_null());
}

TEST_CASE("GrblDriver.ARestartInTheJobIsNoticed") {
  GrblTalk talk;
  talk.connect_and_home();
  talk.load(square);
  talk.tell(start_job);
  talk.pass(1);
  const std::size_t lines = talk.machine.lines().size();
  talk.machine.brown_out(talk.now_s);
  talk.pass(2);
  CHECK(talk.ended() == "failed");
  CHECK_FALSE(talk.state()["position_known"]);
  talk.pass(5);
  for (std::size_t i = lines; i < talk.machine.lines().size(); ++i)
    CHECK(talk.machine.lines()[i].substr(0, 1) == "$");  // nothing of the job follows
}

TEST_CASE("GrblDriver.AnUnpluggedCableClearsTheQueue") {
  GrblTalk talk;
  talk.connect_and_home();
  talk.load(square);
  talk.tell(start_job);
  talk.pass(1);
  talk.driver.closed(talk.now_s);
  CHECK(talk.ended() == "cut_off");
  CHECK_FALSE(talk.state()["position_known"]);
  CHECK(talk.driver.take_output().empty());
  CHECK(talk.refusal(start_job).find("not connected") != std::string::npos);
}

TEST_CASE("GrblDriver.FramesWithoutLightAndJogsUntilLetGo") {
  GrblTalk talk;
  talk.connect_and_home();
  talk.tell({{"do", "frame"}, {"bounds_mm", {5, 5, 60, 40}}, {"speed_mm_per_s", 100}, {"confirmed", true}});
  talk.pass(0.3);
  double far = -1e9;
  REQUIRE(talk.pass_until(
      [&] {
        far = std::max(far, talk.machine.position_mm()[0]);
        return talk.phase() == "idle";
      },
      20));
  CHECK_THAT(far, WithinAbs(-301 + 60, 1));
  CHECK_THAT(talk.machine.position_mm()[0], WithinAbs(-301 + 5, 1e-6));
  CHECK(talk.machine.burns().empty());
  talk.tell({{"do", "jog"}, {"x_mm", 200}, {"speed_mm_per_s", 50}});
  talk.pass(1);
  talk.tell({{"do", "jog_cancel"}});
  talk.pass(0.5);
  CHECK(talk.machine.position_mm()[0] < -301 + 70);
  CHECK(talk.phase() == "idle");
  CHECK(talk.state()["position_known"]);
}

TEST_CASE("GrblDriver.FocusIsWeakAndGoesOutByItself") {
  GrblTalk talk;
  talk.connect_and_home();
  CHECK(talk.refusal({{"do", "focus"}, {"power_percent", 50}, {"confirmed", true}}) != "");
  talk.tell({{"do", "focus"}, {"power_percent", 1}, {"confirmed", true}});
  talk.pass(0.5);
  CHECK(talk.machine.beam());
  CHECK(talk.state()["laser_on"]);
  talk.pass(61);
  CHECK_FALSE(talk.machine.beam());
  CHECK_FALSE(talk.state()["laser_on"]);
}

TEST_CASE("GrblDriver.TheFocusLightIsOutBeforeAJobBegins") {
  GrblTalk talk;
  talk.connect_and_home();
  talk.tell({{"do", "focus"}, {"power_percent", 1}, {"confirmed", true}});
  talk.pass(0.5);
  REQUIRE(talk.machine.beam());
  talk.load("G21G90\nG4P5\nG0X5Y5\n");  // says nothing of the beam, and waits
  talk.tell(start_job);
  talk.pass(1);
  CHECK_FALSE(talk.machine.beam());
  CHECK(talk.pass_until([&] { return talk.ended() == "done"; }, 20));
  for (const auto& burn : talk.machine.burns()) CHECK(burn.from_mm == burn.to_mm);  // the spot, and nothing else
}

TEST_CASE("GrblDriver.SaysSoWhenNothingAnswers") {
  GrblDriver driver({});
  driver.opened(0);
  for (double t = 0; t < 15; t += 0.05) driver.tick(t), driver.take_output();
  CHECK(driver.state(15)["connection"] == "silent");
}

TEST_CASE("GrblDriver.NoiseIsNoReasonToFall") {
  Random random(7);
  GrblDriver driver({});
  driver.opened(0);
  double now = 0;
  for (int i = 0; i < 3000; ++i) {
    std::string noise;
    for (std::size_t k = random.below(40); k > 0; --k) noise += static_cast<char>(random.below(256));
    for (const char* piece : {"ok\r\n", "<Idle|MPos:", "error:", "ALARM:", "Grbl ", "[OPT:", "$30=", "\n"})
      if (random.uniform() < 0.2) noise += piece;
    driver.received(as_bytes(noise), now += 0.01);
    driver.tick(now);
    driver.take_output();
    CHECK_NOTHROW(driver.take_events().dump());
    CHECK_NOTHROW(driver.state(now).dump());
  }
}

}  // namespace
}  // namespace formwright
