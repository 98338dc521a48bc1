// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/grbl_driver.h"

#include <cmath>
#include <set>

#include "grbl_talk.h"

namespace formwright {
namespace {

const std::string square = "G21G90\nM4S500\nG0X10Y10\nG1X30F1200\nY30\nX10\nY10\nM5\nG0X0Y0\nM2\n";
const Json start = {{"do", "start"}, {"confirmed", true}}, stop = {{"do", "stop"}};

TEST(GrblDriver, GreetsAndLearnsWhatTheMachineIs) {
  GrblTalk talk;
  EXPECT_EQ(talk.state()["connection"], "greeting");
  talk.connect();
  EXPECT_EQ(talk.state()["firmware"], "1.1h.20190825");
  EXPECT_EQ(talk.phase(), "alarm");  // homing is on: locked until then
  EXPECT_FALSE(talk.state()["position_known"]);
  EXPECT_TRUE(talk.can("home"));
  EXPECT_TRUE(talk.can("stop"));
  EXPECT_FALSE(talk.can("start"));
}

TEST(GrblDriver, ConnectsToABoardThatDoesNotReset) {
  VirtualGrblOptions options;
  options.homes = false;
  GrblTalk talk(options);
  talk.connect();
  talk.driver.closed(talk.now_s);
  EXPECT_EQ(talk.state()["connection"], "closed");
  talk.driver.opened(talk.now_s);  // the machine is not told: no banner comes
  talk.connect();
  EXPECT_EQ(talk.phase(), "idle");
}

TEST(GrblDriver, KnowsTheOriginBeforeAReportSaysIt) {
  VirtualGrblOptions options;
  options.resets_on_open = false;
  GrblTalk talk(options);
  talk.connect_and_home();
  talk.pass(0.3);  // the next report that says the origin comes in about two seconds
  talk.driver.closed(talk.now_s);
  talk.driver.opened(talk.now_s);
  ASSERT_TRUE(talk.pass_until([&] { return !talk.state()["machine_mm"].is_null(); }, 5)) << talk.state().dump();
  talk.pass(0.3);  // one report more
  ASSERT_FALSE(talk.state()["work_mm"].is_null()) << talk.state().dump();
  EXPECT_NEAR(talk.state()["work_mm"][0].get<double>(), 0, 1e-9);
  EXPECT_NEAR(talk.state()["machine_mm"][0].get<double>(), talk.machine.position_mm()[0], 1e-3);
}

TEST(GrblDriver, ConnectsToAMachineThatIsHeld) {
  VirtualGrblOptions options;
  options.resets_on_open = false;
  GrblTalk talk(options);
  talk.connect_and_home();
  talk.load(square);
  talk.tell(start);
  ASSERT_TRUE(talk.pass_until([&] { return talk.machine.beam(); }, 10));
  talk.tell({{"do", "pause"}});
  ASSERT_TRUE(talk.pass_until([&] { return talk.phase() == "paused"; }, 2));
  talk.driver.closed(talk.now_s);
  talk.driver.opened(talk.now_s);
  talk.connect();
  EXPECT_EQ(talk.phase(), "paused");
  EXPECT_TRUE(talk.can("resume"));
  talk.tell(stop);
  talk.pass(3);
  EXPECT_EQ(talk.phase(), "idle");
  EXPECT_EQ(talk.state()["firmware"], "1.1h.20190825");  // asked for once it rests
}

TEST(GrblDriver, NothingMovesOrFiresWithoutConfirmation) {
  GrblTalk talk;
  talk.connect();
  EXPECT_NE(talk.refusal({{"do", "home"}}), "");
  talk.connect_and_home();
  talk.load(square);
  for (const char* what : {"start", "frame", "focus"}) {
    Json command = {{"do", what}, {"bounds_mm", {0, 0, 10, 10}}, {"power_percent", 1}};
    EXPECT_NE(talk.refusal(command).find("confirmed"), std::string::npos) << what;
    command["confirmed"] = "yes";
    EXPECT_NE(talk.refusal(command).find("confirmed"), std::string::npos) << what;
  }
  EXPECT_NE(talk.refusal({{"do", "send"}, {"line", "G0 X5"}}).find("confirmed"), std::string::npos);
  EXPECT_NE(talk.refusal({{"do", "send"}, {"line", "m3 s5"}}).find("confirmed"), std::string::npos);
  EXPECT_EQ(talk.refusal({{"do", "send"}, {"line", "$G"}}), "");
  const auto before = talk.machine.position_mm();
  talk.pass(1);
  EXPECT_EQ(talk.machine.position_mm(), before);
  EXPECT_TRUE(talk.machine.burns().empty());
}

TEST(GrblDriver, CutsWhatTheJobSays) {
  GrblTalk talk;
  talk.connect_and_home();
  const auto origin = talk.machine.position_mm();
  talk.load(square);
  talk.tell(start);
  ASSERT_TRUE(talk.pass_until([&] { return !talk.ended().empty(); }, 60)) << talk.state().dump();
  EXPECT_EQ(talk.ended(), "done");
  EXPECT_EQ(talk.machine.bytes_lost(), 0);
  double length = 0;
  for (const auto& burn : talk.machine.burns()) {
    length += std::hypot(burn.to_mm[0] - burn.from_mm[0], burn.to_mm[1] - burn.from_mm[1]);
    for (const auto& p : {burn.from_mm, burn.to_mm}) {
      const double x = p[0] - origin[0], y = p[1] - origin[1];
      EXPECT_NEAR(std::min({std::abs(x - 10), std::abs(x - 30), std::abs(y - 10), std::abs(y - 30)}), 0, 1e-9);
    }
  }
  EXPECT_NEAR(length, 80, 1e-6);
  EXPECT_EQ(talk.machine.position_mm(), origin);  // done means done, not only taken in
  EXPECT_EQ(talk.state()["job"]["acknowledged"], 10);
}

TEST(GrblDriver, StopEndsEverythingAndForgetsThePosition) {
  GrblTalk talk;
  talk.connect_and_home();
  talk.load("G21G90M4S500\nG1X250F600\nX0\nX250\n");
  talk.tell(start);
  talk.pass(2);
  ASSERT_TRUE(talk.machine.beam());
  talk.tell(stop);
  talk.pass(0.1);
  EXPECT_FALSE(talk.machine.beam());
  talk.pass(1.5);
  EXPECT_EQ(talk.ended(), "stopped");
  EXPECT_FALSE(talk.state()["position_known"]);
  const auto there = talk.machine.position_mm();
  talk.pass(5);
  EXPECT_EQ(talk.machine.position_mm(), there);  // the queue does not go on by itself
  EXPECT_NE(talk.refusal(start), "");
  // It came to rest before the reset: no alarm, but homing is asked for all the same.
  EXPECT_EQ(talk.phase(), "idle");
  EXPECT_TRUE(talk.can("home"));
}

TEST(GrblDriver, StopWithoutLaserModeResetsAtOnce) {
  VirtualGrblOptions options;
  options.laser_mode = false;
  GrblTalk talk(options);
  talk.connect_and_home();
  talk.load("G21G90\nG1X250F600\n");
  talk.tell(start);
  talk.pass(2);
  talk.tell(stop);
  talk.pass(0.05);
  EXPECT_EQ(talk.machine.state(), "Alarm");
  talk.pass(1);
  EXPECT_EQ(talk.state()["alarm"]["code"], 3);
}

TEST(GrblDriver, RefusesLaserJobsWithoutLaserMode) {
  VirtualGrblOptions options;
  options.laser_mode = false;
  GrblTalk talk(options);
  talk.connect_and_home();
  talk.load(square);
  EXPECT_NE(talk.refusal(start).find("$32=1"), std::string::npos);
}

TEST(GrblDriver, HoldsAndGoesOn) {
  GrblTalk talk;
  talk.connect_and_home();
  talk.load(square);
  talk.tell(start);
  ASSERT_TRUE(talk.pass_until([&] { return talk.machine.beam(); }, 10));
  talk.tell({{"do", "pause"}});
  ASSERT_TRUE(talk.pass_until([&] { return talk.phase() == "paused"; }, 2)) << talk.state().dump();
  EXPECT_FALSE(talk.machine.beam());
  const auto there = talk.machine.position_mm();
  talk.pass(3);
  EXPECT_EQ(talk.machine.position_mm(), there);
  EXPECT_NE(talk.refusal({{"do", "resume"}}).find("confirmed"), std::string::npos);
  talk.tell({{"do", "resume"}, {"confirmed", true}});
  ASSERT_TRUE(talk.pass_until([&] { return !talk.ended().empty(); }, 60));
  EXPECT_EQ(talk.ended(), "done");
}

TEST(GrblDriver, ARefusedLineEndsTheJob) {
  GrblTalk talk;
  talk.connect_and_home();
  talk.machine.refuse_line("M1", 20);
  talk.load("G21G90\nM4S500\nG1X10F600\nM1\nG1X200\nM5\n");
  talk.tell(start);
  ASSERT_TRUE(talk.pass_until([&] { return !talk.ended().empty(); }, 60));
  EXPECT_EQ(talk.ended(), "failed");
  EXPECT_EQ(talk.state()["error"]["line_number"], 4);
  EXPECT_EQ(talk.state()["error"]["code"], 20);
  talk.pass(2);
  EXPECT_FALSE(talk.machine.beam());
  EXPECT_LT(talk.machine.position_mm()[0], -301 + 60);
}

TEST(GrblDriver, AlarmsAreSaidInWords) {
  GrblTalk talk;
  talk.connect_and_home();
  talk.load(square);
  talk.tell(start);
  talk.pass(1);
  talk.machine.trip_limit();
  talk.pass(0.5);
  EXPECT_EQ(talk.ended(), "failed");
  EXPECT_EQ(talk.phase(), "alarm");
  EXPECT_NE(talk.state()["alarm"]["text"].get<std::string>().find("limit switch"), std::string::npos);
  EXPECT_FALSE(talk.state()["position_known"]);
  // The machine hears nothing but a reset now; homing sends it by itself.
  talk.tell({{"do", "home"}, {"confirmed", true}});
  ASSERT_TRUE(talk.pass_until([&] { return talk.phase() == "idle" && talk.state()["position_known"] == true; }, 20))
      << talk.state().dump();
  EXPECT_TRUE(talk.state()["alarm"].is_null());
}

TEST(GrblDriver, ARestartInTheJobIsNoticed) {
  GrblTalk talk;
  talk.connect_and_home();
  talk.load(square);
  talk.tell(start);
  talk.pass(1);
  const std::size_t lines = talk.machine.lines().size();
  talk.machine.brown_out(talk.now_s);
  talk.pass(2);
  EXPECT_EQ(talk.ended(), "failed");
  EXPECT_FALSE(talk.state()["position_known"]);
  talk.pass(5);
  for (std::size_t i = lines; i < talk.machine.lines().size(); ++i)
    EXPECT_EQ(talk.machine.lines()[i].substr(0, 1), "$");  // nothing of the job follows
}

TEST(GrblDriver, AnUnpluggedCableClearsTheQueue) {
  GrblTalk talk;
  talk.connect_and_home();
  talk.load(square);
  talk.tell(start);
  talk.pass(1);
  talk.driver.closed(talk.now_s);
  EXPECT_EQ(talk.ended(), "cut_off");
  EXPECT_FALSE(talk.state()["position_known"]);
  EXPECT_TRUE(talk.driver.take_output().empty());
  EXPECT_NE(talk.refusal(start).find("not connected"), std::string::npos);
}

TEST(GrblDriver, FramesWithoutLightAndJogsUntilLetGo) {
  GrblTalk talk;
  talk.connect_and_home();
  talk.tell({{"do", "frame"}, {"bounds_mm", {5, 5, 60, 40}}, {"speed_mm_per_s", 100}, {"confirmed", true}});
  talk.pass(0.3);
  double far = -1e9;
  ASSERT_TRUE(talk.pass_until(
      [&] {
        far = std::max(far, talk.machine.position_mm()[0]);
        return talk.phase() == "idle";
      },
      20));
  EXPECT_NEAR(far, -301 + 60, 1);
  EXPECT_NEAR(talk.machine.position_mm()[0], -301 + 5, 1e-6);
  EXPECT_TRUE(talk.machine.burns().empty());
  talk.tell({{"do", "jog"}, {"x_mm", 200}, {"speed_mm_per_s", 50}});
  talk.pass(1);
  talk.tell({{"do", "jog_cancel"}});
  talk.pass(0.5);
  EXPECT_LT(talk.machine.position_mm()[0], -301 + 70);
  EXPECT_EQ(talk.phase(), "idle");
  EXPECT_TRUE(talk.state()["position_known"]);
}

TEST(GrblDriver, FocusIsWeakAndGoesOutByItself) {
  GrblTalk talk;
  talk.connect_and_home();
  EXPECT_NE(talk.refusal({{"do", "focus"}, {"power_percent", 50}, {"confirmed", true}}), "");
  talk.tell({{"do", "focus"}, {"power_percent", 1}, {"confirmed", true}});
  talk.pass(0.5);
  EXPECT_TRUE(talk.machine.beam());
  EXPECT_TRUE(talk.state()["laser_on"]);
  talk.pass(61);
  EXPECT_FALSE(talk.machine.beam());
  EXPECT_FALSE(talk.state()["laser_on"]);
}

TEST(GrblDriver, TheFocusLightIsOutBeforeAJobBegins) {
  GrblTalk talk;
  talk.connect_and_home();
  talk.tell({{"do", "focus"}, {"power_percent", 1}, {"confirmed", true}});
  talk.pass(0.5);
  ASSERT_TRUE(talk.machine.beam());
  talk.load("G21G90\nG4P5\nG0X5Y5\n");  // says nothing of the beam, and waits
  talk.tell(start);
  talk.pass(1);
  EXPECT_FALSE(talk.machine.beam());
  EXPECT_TRUE(talk.pass_until([&] { return talk.ended() == "done"; }, 20));
  for (const auto& burn : talk.machine.burns()) EXPECT_EQ(burn.from_mm, burn.to_mm);  // the spot, and nothing else
}

TEST(GrblDriver, GoingOnLeavesAnUnnamedAxisWhereItIs) {
  GrblTalk talk;
  talk.connect_and_home();
  talk.tell({{"do", "go_to"}, {"x_mm", 10}, {"y_mm", 20}, {"speed_mm_per_s", 50}});
  talk.pass(3);
  const double y = talk.machine.position_mm()[1], x = talk.machine.position_mm()[0] - 10;
  talk.load("G21G90\nG0X15\nG0X30\nG0X40\n");
  Json from = start;
  from["from_line"] = 3;
  talk.tell(from);
  EXPECT_TRUE(talk.pass_until([&] { return talk.ended() == "done"; }, 20));
  EXPECT_NEAR(talk.machine.position_mm()[0], x + 40, 1e-6);
  EXPECT_NEAR(talk.machine.position_mm()[1], y, 1e-6);
}

TEST(GrblDriver, JobsThatDoNotFitAreRefusedBeforeAnythingMoves) {
  GrblTalk talk;
  talk.connect_and_home();
  const auto there = talk.machine.position_mm();
  talk.load("G21G90\nG0X0\nG0X500\n");
  EXPECT_NE(talk.refusal(start).find("500 mm long"), std::string::npos);
  talk.load("G21G90\nG0X310Y0\nG0X0\n");  // 310 mm from an origin 301 mm from the end
  EXPECT_NE(talk.refusal(start).find("leave the bed in x"), std::string::npos);
  EXPECT_NE(
      talk.refusal({{"do", "frame"}, {"bounds_mm", {-150, 0, 20, 20}}, {"speed_mm_per_s", 50}, {"confirmed", true}})
          .find("bed"),
      std::string::npos);
  talk.pass(1);
  EXPECT_EQ(talk.machine.position_mm(), there);
}

TEST(GrblDriver, AJobThatCountsFromTheHeadStartsAtTheOriginOnly) {
  GrblTalk talk;
  talk.connect_and_home();
  const double origin_mm = talk.machine.position_mm()[0];
  const auto rest = [&] {
    talk.pass(0.5);
    ASSERT_TRUE(talk.pass_until([&] { return talk.phase() == "idle" && talk.can("start"); }, 20));
  };
  talk.load("G21G91M4S300\nG1X100F6000\nM5\n");
  talk.tell({{"do", "jog"}, {"x_mm", 250}, {"y_mm", 250}, {"speed_mm_per_s", 150}});
  rest();
  // From here it would go to x 350, and the bed ends at 301.
  EXPECT_NE(talk.refusal(start).find("G91"), std::string::npos);
  talk.tell({{"do", "go_to"}, {"x_mm", 0}, {"y_mm", 0}, {"speed_mm_per_s", 150}});
  rest();
  EXPECT_EQ(talk.refusal(start), "");
  ASSERT_TRUE(talk.pass_until([&] { return !talk.ended().empty(); }, 30));
  EXPECT_EQ(talk.ended(), "done");
  EXPECT_NEAR(talk.machine.position_mm()[0], origin_mm + 100, 1e-9);
  rest();
  EXPECT_NE(talk.refusal(start), "");
  talk.tell({{"do", "set_origin"}, {"axes", "xy"}});
  EXPECT_EQ(talk.refusal(start), "");
  ASSERT_TRUE(talk.pass_until([&] { return talk.ended() == "done"; }, 30));
  EXPECT_NEAR(talk.machine.position_mm()[0], origin_mm + 200, 1e-9);
  // A tool that is lifted first does not make such a job.
  talk.load("G21G91\nG0Z-5\nG90\nG0X10Y10\nG0X0Y0\n");
  rest();
  EXPECT_EQ(talk.refusal(start), "");
}

TEST(GrblDriver, AJobThatCountsFromTheHeadGoesOnFromAnywhere) {
  GrblTalk talk;
  talk.connect_and_home();
  const auto origin = talk.machine.position_mm();
  std::string job = "G21G91\nM4S400\n";
  for (int i = 0; i < 20; ++i) job += "G0Y2\nG1X20F3000\nG0Y2\nG1X-20\n";
  talk.load(job + "M5\n");
  talk.tell(start);
  ASSERT_TRUE(talk.pass_until([&] { return talk.state()["job"]["acknowledged"] > 40; }, 60));
  talk.tell(stop);
  talk.pass(2);
  const int from = talk.state()["job"]["careful_line"];
  ASSERT_GT(from, 10);
  talk.tell({{"do", "home"}, {"confirmed", true}});
  ASSERT_TRUE(talk.pass_until([&] { return talk.phase() == "idle" && talk.state()["position_known"] == true; }, 20));
  talk.pass(1);
  EXPECT_NE(talk.refusal(start), "");
  EXPECT_EQ(talk.refusal({{"do", "start"}, {"confirmed", true}, {"from_line", from}}), "");
  ASSERT_TRUE(talk.pass_until([&] { return !talk.ended().empty(); }, 120));
  EXPECT_EQ(talk.ended(), "done");
  EXPECT_NEAR(talk.machine.position_mm()[0], origin[0], 1e-6);
  EXPECT_NEAR(talk.machine.position_mm()[1], origin[1] + 80, 1e-6);
}

TEST(GrblDriver, AJobMayStartAtOnceFromAnOriginJustSet) {
  GrblTalk talk;
  talk.connect_and_home();
  talk.load("G21G90\nG0X310Y0\nG0X0\n");  // does not fit from where the origin is: 301 mm from the end
  EXPECT_NE(talk.refusal(start).find("leave the bed in x"), std::string::npos);
  const double head_mm = talk.state()["machine_mm"][0];
  // However long ago the last report was, which told of another origin.
  for (int i = 0; i < 8; ++i) {
    talk.tell({{"do", "set_origin"}, {"at", "corner"}});
    EXPECT_DOUBLE_EQ(talk.state()["work_mm"][0], head_mm + 400);
    for (int k = 0; k < 4; ++k) {
      talk.pass(0.02);
      EXPECT_DOUBLE_EQ(talk.state()["work_mm"][0], head_mm + 400);
    }
    talk.tell({{"do", "set_origin"}, {"axes", "xy"}});
    EXPECT_DOUBLE_EQ(talk.state()["work_mm"][0], 0);
    EXPECT_NE(talk.refusal(start), "");
    talk.pass(0.137);
  }
  talk.tell({{"do", "set_origin"}, {"at", "corner"}});
  EXPECT_EQ(talk.refusal(start), "");
  ASSERT_TRUE(talk.pass_until([&] { return talk.ended() == "done"; }, 30));
}

TEST(GrblDriver, AJobNeverStartsIntoAFrameThatIsNotDone) {
  GrblTalk talk({}, {.burst_s = 0.05});
  talk.connect_and_home();
  talk.load("G21G90\nG0X5Y5\nG0X0Y0\n");
  int started = 0, refused = 0;
  for (int i = 0; i < 60; ++i) {
    ASSERT_TRUE(talk.pass_until([&] { return talk.can("frame"); }, 5));
    talk.tell({{"do", "frame"}, {"bounds_mm", {0, 0, 10, 10}}, {"speed_mm_per_s", 50}, {"confirmed", true}});
    talk.pass(0.04 * i);
    if (talk.refusal(start) != "") {
      ++refused;
      talk.pass(1.5);
      continue;
    }
    ++started;
    ASSERT_TRUE(talk.pass_until([&] { return talk.ended() != ""; }, 10));
    EXPECT_EQ(talk.ended(), "done") << "after " << 0.04 * i << " s: " << talk.state().dump();
  }
  EXPECT_GT(started, 5);
  EXPECT_GT(refused, 5);
}

TEST(GrblDriver, GoesOnTheCarefulWay) {
  GrblTalk talk;
  talk.connect_and_home();
  std::string job = "G21G90\nM4S400\n";
  for (int i = 0; i < 30; ++i) {
    const std::string y = std::to_string(2 * i);
    job += "G0X0Y" + y + "\nG1X20F1500\n";
  }
  job += "M5\n";
  talk.load(job);
  talk.tell(start);
  ASSERT_TRUE(talk.pass_until([&] { return talk.state()["job"]["acknowledged"] > 40; }, 60));
  talk.tell(stop);
  talk.pass(2);
  const int from = talk.state()["job"]["careful_line"];
  EXPECT_GT(from, 10);
  EXPECT_LE(from, 40 - 16 + 2);
  EXPECT_NE(talk.refusal({{"do", "start"}, {"confirmed", true}, {"from_line", from}}),
            "");  // where the head stands is unknown
  talk.tell({{"do", "home"}, {"confirmed", true}});
  ASSERT_TRUE(talk.pass_until([&] { return talk.phase() == "idle" && talk.state()["position_known"] == true; }, 20));
  const std::size_t burns_before = talk.machine.burns().size();
  talk.tell({{"do", "start"}, {"confirmed", true}, {"from_line", from}});
  ASSERT_TRUE(talk.pass_until([&] { return !talk.ended().empty(); }, 120));
  EXPECT_EQ(talk.ended(), "done");
  // Every row is whole: each y has a stroke of 20 mm in one of the two runs.
  std::map<long, double> rows;
  for (const auto& burn : talk.machine.burns()) {
    EXPECT_DOUBLE_EQ(burn.power, 400);
    EXPECT_NEAR(burn.from_mm[1], burn.to_mm[1], 1e-9);
    rows[std::lround(burn.from_mm[1] * 10)] += std::abs(burn.to_mm[0] - burn.from_mm[0]);
  }
  EXPECT_EQ(rows.size(), 30u);
  for (const auto& [y, length] : rows) EXPECT_GE(length, 20 - 1e-6);
  EXPECT_GT(talk.machine.burns().size(), burns_before);
}

TEST(GrblDriver, SaysSoWhenNothingAnswers) {
  GrblDriver driver({});
  driver.opened(0);
  for (double t = 0; t < 15; t += 0.05) driver.tick(t), driver.take_output();
  EXPECT_EQ(driver.state(15)["connection"], "silent");
}

TEST(GrblDriver, NoiseIsNoReasonToFall) {
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
    EXPECT_NO_THROW(driver.take_events().dump());
    EXPECT_NO_THROW(driver.state(now).dump());
  }
}

}  // namespace
}  // namespace formwright
