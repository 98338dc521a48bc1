// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/marlin/marlin_laser.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include "machines/marlin_laser_talk.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

const Json home_laser = {{"do", "home"}, {"confirmed", true}}, start_laser = {{"do", "start"}, {"confirmed", true}},
           focus_laser = {{"do", "focus"}, {"power_percent", 1}, {"confirmed", true}};

struct ReadyTalk : MarlinLaserTalk {
  explicit ReadyTalk(const VirtualMarlinOptions& laser = {}, double focus_seconds = 60)
      : MarlinLaserTalk(laser, 1, focus_seconds) {
    pass(2);
  }
  std::string refusal(const Json& command) {
    try {
      driver.command(command, machine.now_s());
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }
  void homed() {
    try_tell(home_laser);
    REQUIRE(wait_for("idle", 30));
    pass(0.1);
  }
  void begin(const std::string& text) {
    driver.load("job", as_bytes(text));
    REQUIRE(refusal(start_laser) == "");
  }
  bool ends(const char* how) {
    for (int i = 0; i < 3000 && state()["job"]["ended"].is_null(); ++i) pass(0.02);
    return state()["job"]["ended"] == how;
  }
  std::array<bool, 3> axes_known() const {
    const Json axes = state()["axes_known"];
    return {axes["x"].get<bool>(), axes["y"].get<bool>(), axes["z"].get<bool>()};
  }
};

TEST_CASE("MarlinLaser.ReadsModesAndVersions") {
  using enum MarlinPower;
  CHECK(marlin_power_after("M4I", off) == dynamic);
  CHECK(marlin_power_after("M3 I S20", off) == continuous);
  CHECK(marlin_power_after("M3S20", off) == standard);
  CHECK(marlin_power_after("M3S20", dynamic) == dynamic);
  CHECK(marlin_power_after("M5", continuous) == continuous);
  CHECK(marlin_power_after("M5I", continuous) == off);
  CHECK(marlin_power_after("M5", standard) == off);
  CHECK(marlin_power_after("M30", standard) == standard);
  CHECK(marlin_line_as_sent("M4I") == "M4 I S0");
  CHECK(marlin_line_as_sent("M4IS30") == "M4IS30");
  CHECK(marlin_line_as_sent("M42I1") == "M42I1");
  CHECK(marlin_version("Marlin 2.1.2.5") == std::pair(2, 1));
  CHECK(marlin_version("Marlin bugfix-2.0.x") == std::pair(2, 0));
  CHECK(marlin_version("Marlin 1.1.9") == std::pair(1, 1));
  CHECK(marlin_version("Virtual") == std::nullopt);
}

TEST_CASE("MarlinLaser.SaysWhatHappensWhenTheConnectionEnds") {
  ReadyTalk talk;
  CHECK(talk.state()["when_connection_ends"] == "");
  const auto said = [&](const char* job) {
    talk.driver.load("job", as_bytes(std::string(job)));
    return talk.state()["when_connection_ends"].get<std::string>();
  };
  CHECK(said("M4 I\nG1 X5 S100 F600\n").find("then off (M4 I)") != std::string::npos);
  CHECK(talk.state()["warnings"] == Json::array());
  CHECK(said("M3 I\nG1 X5 S100 F600\n").find("stays on where the head stands") != std::string::npos);
  CHECK(talk.state()["warnings"].dump().find("constant power") != std::string::npos);
  CHECK(said("M3 S100\nG1 X5 F600\nM5\n").find("stays on where the head stands") != std::string::npos);
  CHECK(talk.state()["warnings"].dump().find("on travels and at rest") != std::string::npos);
  CHECK(said("G1 X5 F600\n").find("turns nothing on") != std::string::npos);
  ReadyTalk old({.inline_modes = false});
  old.driver.load("job", as_bytes(std::string("M4 I\nG1 X5 S100 F600\n")));
  CHECK(old.state()["warnings"].dump().find("Marlin 1.1.9") != std::string::npos);
  CHECK(old.state()["when_connection_ends"].get<std::string>().find("The laser is then off") == std::string::npos);
}

TEST_CASE("MarlinLaser.FirmwareWithoutInlineModesKeepsSuchJobsDark") {
  ReadyTalk talk({.inline_modes = false});
  talk.homed();
  talk.begin("G0 X10 Y10 F3000\nM4 I\nG1 X20 S200 F1200\nM5 I\nM5\n");
  CHECK(talk.ends("done"));
  CHECK(talk.lit_s == 0);  // and not at the power that "M4" alone starts with
}

TEST_CASE("MarlinLaser.AFocusLightEndsByItselfBehindADeadHost") {
  ReadyTalk talk;
  talk.expect_spot(true);
  REQUIRE(talk.try_tell(focus_laser));
  CHECK(talk.state()["laser_on"] == true);
  talk.pass(2);
  CHECK(talk.spot_s > 1.8);  // dark between pulses for a moment only
  talk.host_alive = false;
  talk.pass(0.3);
  CHECK_FALSE(talk.machine.shines());
  const double lit = talk.lit_s;
  talk.pass(10);
  CHECK(talk.lit_s == lit);
}

TEST_CASE("MarlinLaser.AFocusLightGoesOutByItsTimeByItsButtonAndByARestart") {
  ReadyTalk talk({}, 5);
  REQUIRE(talk.try_tell(focus_laser));
  talk.pass(6);
  CHECK(talk.lit_s > 4.5);
  CHECK(talk.lit_s < 5.4);
  CHECK(talk.state()["laser_on"] == false);
  REQUIRE(talk.try_tell(focus_laser));
  talk.pass(1);
  REQUIRE(talk.try_tell({{"do", "focus_off"}}));
  talk.pass(0.3);
  double lit = talk.lit_s;
  talk.pass(2);
  CHECK(talk.lit_s == lit);
  REQUIRE(talk.try_tell(focus_laser));
  talk.pass(1);
  talk.machine.restart();
  lit = talk.lit_s;
  talk.pass(5);
  CHECK(talk.lit_s == lit);
}

TEST_CASE("MarlinLaser.NothingMovesWithAFocusLightOrWithWhatAJobLeftOn") {
  for (const char* left_on : {"focus", "M3 S200\nG1 X20 Y5 F3000\n", "M3 I\nG1 X20 Y5 S200 F3000\n", "by hand"})
    for (const Json& order :
         {home_laser, Json{{"do", "jog"}, {"x_mm", 5}, {"speed_mm_per_s", 10}},
          Json{{"do", "go_to"}, {"x_mm", 50}, {"y_mm", 40}, {"speed_mm_per_s", 50}},
          Json{{"do", "frame"}, {"bounds_mm", {0, 0, 30, 30}}, {"speed_mm_per_s", 50}, {"confirmed", true}}}) {
      INFO(std::string(left_on) + order.dump());
      ReadyTalk talk;
      talk.homed();
      if (left_on == std::string("focus")) talk.try_tell(focus_laser), talk.pass(0.1);
      else if (left_on == std::string("by hand"))
        talk.try_tell({{"do", "send"}, {"line", "M3 S200"}, {"confirmed", true}}), talk.pass(0.3);
      else {
        talk.begin(left_on);
        REQUIRE(talk.ends("done"));
        CHECK_FALSE(talk.machine.shines());  // the job has ended behind an M5
        CHECK(talk.state()["laser_on"] == false);
      }
      CHECK(talk.refusal(order) == "");
      double lit_moving = 0;
      for (int i = 0; i < 4000; ++i) {
        talk.step();
        if (talk.machine.moves() && talk.machine.shines()) lit_moving += talk.step_s;
      }
      CHECK(lit_moving == 0);
      CHECK_FALSE(talk.machine.shines());
      CHECK(talk.state()["laser_on"] == false);
    }
}

TEST_CASE("MarlinLaser.WhatSomebodyLeftOnGoesOutWhenThePortIsOpened") {
  ReadyTalk talk;
  talk.try_tell({{"do", "send"}, {"line", "M3 S200"}, {"confirmed", true}});
  talk.pass(0.5);
  REQUIRE(talk.machine.shines());
  talk.host_alive = false;
  talk.machine.receive("N99 G1 X");  // a line that was never finished
  talk.pass(1);
  talk.attach(false);
  talk.pass(0.3);
  CHECK_FALSE(talk.machine.shines());
  CHECK(talk.wait_for("idle", 10));
  CHECK(talk.state()["laser_on"] == false);
}

TEST_CASE("MarlinLaser.APausedJobIsDarkAndGoesOnWithItsPower") {
  for (const char* on : {"M4 I", "M3 I"}) {
    CAPTURE(on);
    ReadyTalk talk;
    talk.homed();
    std::string job = "G0 X10 Y10 F3000\n" + std::string(on) + "\nG1 X11 S200 F1200\n";
    for (int i = 12; i < 100; ++i) job += "G1 X" + std::to_string(i) + "\n";
    talk.begin(job);
    talk.job.cuts_mm = {{10, 10, 99, 10}};
    talk.pass(2.5);
    REQUIRE(talk.machine.shines());
    talk.try_tell({{"do", "pause"}});
    talk.pass(3);
    CHECK_FALSE(talk.machine.shines());
    const double lit = talk.lit_s;
    talk.pass(1);
    CHECK(talk.lit_s == lit);
    talk.try_tell({{"do", "resume"}, {"confirmed", true}});
    CHECK(talk.ends("done"));
    CHECK_THAT(talk.lit_s, WithinAbs(89 / 20.0, 0.3));
    CHECK(talk.outside_s == 0);
  }
}

TEST_CASE("MarlinPlace.IsKnownAxisByAxis") {
  ReadyTalk talk;
  CHECK(talk.axes_known() == std::array{false, false, false});
  REQUIRE(talk.refusal({{"do", "set_origin"}, {"axes", "z"}}) == "");
  CHECK(talk.axes_known() == std::array{false, false, true});
  CHECK_FALSE(talk.can("go_to"));
  talk.driver.load("job", as_bytes(std::string("G1 X5 F600\n")));
  CHECK(talk.refusal(start_laser).find("home the machine first") != std::string::npos);
  REQUIRE(talk.refusal({{"do", "send"}, {"line", "G28 X"}, {"confirmed", true}}) == "");
  talk.pass(0.1);
  talk.wait_for("idle", 20);
  CHECK(talk.axes_known() == std::array{true, false, true});
  REQUIRE(talk.refusal({{"do", "set_origin"}, {"axes", "xy"}}) == "");
  CHECK(talk.axes_known() == std::array{true, true, true});
  talk.pass(0.3);
  REQUIRE(talk.refusal({{"do", "send"}, {"line", "M84 Z"}, {"confirmed", true}}) == "");
  talk.pass(0.3);
  CHECK(talk.axes_known() == std::array{true, true, false});
  talk.driver.load("job", as_bytes(std::string("G1 X5 Z-1 F600\n")));
  CHECK(talk.refusal(start_laser).find("how high the tool stands") != std::string::npos);
  talk.driver.load("job", as_bytes(std::string("G1 X5 F600\n")));
  CHECK(talk.refusal(start_laser) == "");
}

TEST_CASE("MarlinPlace.JobsAreHeldAgainstTheBedFromWhereTheOriginLies") {
  ReadyTalk talk({.bed_mm = {120, 90, 40}});
  // M211 counts, not the profile.
  talk.homed();
  const auto frame = [](double right, double high) {
    return Json{{"do", "frame"}, {"bounds_mm", {0, 0, right, high}}, {"confirmed", true}};
  };
  CHECK(talk.refusal(frame(121, 10)).find("121 mm long") != std::string::npos);
  REQUIRE(talk.refusal({{"do", "go_to"}, {"x_mm", 100}, {"y_mm", 50}}) == "");
  talk.pass(4);
  REQUIRE(talk.refusal({{"do", "set_origin"}}) == "");
  talk.pass(0.5);
  CHECK(talk.refusal(frame(21, 10)).find("leave the bed in x") != std::string::npos);
  CHECK(talk.refusal(frame(20, 41)).find("leave the bed in y") != std::string::npos);
  talk.driver.load("job", as_bytes(std::string("G0 X-101 Y0 F3000\nG1 X0 F600\n")));
  CHECK(talk.refusal(start_laser).find("leave the bed in x") != std::string::npos);
  talk.driver.load("job", as_bytes(std::string("G0 X-100 Y0 F3000\nG1 X20 F3000\n")));
  CHECK(talk.refusal(start_laser) == "");
  CHECK(talk.ends("done"));
  CHECK_THAT(talk.machine.head_mm()[0], WithinAbs(120, 1e-6));
  CHECK(talk.refusal(frame(20, 40)) == "");
  // Homing again brings the origin back to the corner.
  talk.wait_for("idle", 20);
  talk.homed();
  CHECK(talk.refusal(frame(120, 90)) == "");
}

TEST_CASE("MarlinPlace.ReadsLimits") {
  const auto limits =
      MarlinPlace::limits_in("Soft endstops: On  Min: X-5.00 Y0.00 Z0.00   Max:  X200.00 Y210.50 Z1.00");
  REQUIRE(limits);
  CHECK(limits->low_mm == std::array<double, 2>{-5, 0});
  CHECK(limits->high_mm == std::array<double, 2>{200, 210.5});
  CHECK(MarlinPlace::limits_in("  Min:  X0.00 Y0.00   Max:  X200.00 Y200.00"));
  CHECK_FALSE(MarlinPlace::limits_in("Soft endstops: Off"));
  CHECK_FALSE(MarlinPlace::limits_in("Min: X Y Max: X1 Y2"));
  CHECK_FALSE(MarlinPlace::limits_in("Min: X5 Y5 Max: X1 Y2"));
}

}  // namespace
}  // namespace formwright
