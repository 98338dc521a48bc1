// SPDX-License-Identifier: GPL-3.0-or-later
// What grblHAL does otherwise than GRBL 1.1, as its own firmware did it, compiled for a PC (core of August 2026).
#include "grbl_talk.h"
#include "machines/grbl/grbl_words.h"

namespace formwright {
namespace {

const Json focus = {{"do", "focus"}, {"power_percent", 1}, {"confirmed", true}};
const Json home = {{"do", "home"}, {"confirmed", true}};
const Json jog = {{"do", "jog"}, {"x_mm", 20}, {"speed_mm_per_s", 20}};
const Json jog_cancel = {{"do", "jog_cancel"}};
const std::string square = "G21\nG90\nG0 X5 Y5\nM4 S500\nG1 X20 F3000\nG1 Y20\nM5\n";

bool heard(const GrblTalk& talk, const std::string& words) {
  return std::any_of(talk.events.begin(), talk.events.end(), [&](const Json& event) {
    return event["event"] == "note" && event["text"].get<std::string>().find(words) != std::string::npos;
  });
}

double lit_s(const GrblTalk& talk) {
  double sum = 0;
  for (const auto& burn : talk.machine.burns()) sum += burn.seconds;
  return sum;
}

void say(GrblTalk& talk, const std::string& line) { talk.driver.received(as_bytes(line + "\r\n"), talk.now_s); }

TEST_CASE("GrblHal.ABoardThatWantsToBeHomedIsReadBehindItsAlarm") {
  GrblTalk talk({.grblhal = true});
  REQUIRE(talk.pass_until([&] { return talk.state()["connection"] == "ready"; }, 5));
  CHECK(talk.state()["alarm"]["code"] == 11);
  CHECK(talk.state()["alarm"]["text"] == grbl_alarm(11, GrblFirmware::grblhal).text);
  talk.tell({{"do", "unlock"}});
  talk.pass(0.5);
  CHECK(talk.phase() == "alarm");
  CHECK(talk.state()["error"]["text"] == grbl_error(46, GrblFirmware::grblhal));
  talk.tell(home);
  REQUIRE(talk.pass_until([&] { return talk.phase() == "idle" && talk.state()["position_known"] == true; }, 10));
}

TEST_CASE("GrblHal.ALockThatIsReportedOnceMoreIsNoFailureOfHoming") {
  GrblTalk talk({.grblhal = true});
  REQUIRE(talk.pass_until([&] { return talk.state()["connection"] == "ready"; }, 5));
  talk.tell(home);
  say(talk, "<Alarm:11|MPos:0.000,0.000,0.000|Bf:100,1023|FS:0,0>");
  CHECK(talk.phase() == "homing");
  // Homing that fails says so.
  say(talk, "ALARM:9");
  say(talk, "<Alarm:9|MPos:0.000,0.000,0.000|Bf:100,1023|FS:0,0>");
  CHECK(talk.phase() == "alarm");
  CHECK(talk.state()["alarm"]["code"] == 9);
}

TEST_CASE("GrblHal.AlarmsAreKnownFromReportsAlone") {
  GrblTalk talk({.resets_on_open = false, .grblhal = true});
  REQUIRE(talk.pass_until([&] { return talk.state()["connection"] == "ready"; }, 5));
  talk.pull_cable();
  talk.plug_in();
  REQUIRE(talk.pass_until([&] { return talk.state()["connection"] == "ready"; }, 15));
  CHECK(talk.state()["alarm"]["code"] == 11);
}

TEST_CASE("GrblHal.ACancelledJogTakesNoM5OutOfAPulse") {
  for (const bool jogs : {false, true}) {
    GrblTalk talk({.grblhal = true});
    talk.connect_and_home();
    talk.tell(focus);
    talk.pass(0.5);
    REQUIRE(talk.machine.beam());
    if (jogs) talk.tell(jog);
    talk.pass(0.1);
    talk.tell(jog_cancel);
    talk.pass(0.05);
    talk.kill_host(true);
    talk.leave_alone(20);
    CHECK(lit_s(talk) <= 1.1);
  }
}

TEST_CASE("GrblHal.LinesThatACancelledJogDropsAreNotWaitedFor") {
  for (const double after_s : {0.0, 0.001, 0.003, 0.006, 0.01, 0.02, 0.1, 0.5}) {
    INFO(after_s);
    GrblTalk talk({.grblhal = true});
    talk.connect_and_home();
    const double from_mm = talk.machine.position_mm()[0];
    for (int i = 0; i < 4; ++i) talk.tell(jog);
    talk.pass(0.1 + after_s);
    talk.tell(jog_cancel);
    talk.tell({{"do", "jog"}, {"y_mm", 3}, {"speed_mm_per_s", 20}});
    talk.pass(3);
    CHECK(talk.phase() == "idle");
    CHECK(talk.machine.position_mm()[0] - from_mm < 15);
    talk.load(square);
    talk.tell(start_job);
    CHECK(talk.pass_until([&] { return talk.ended() == "done"; }, 20));
    CHECK_FALSE(heard(talk, "did not answer every line"));
  }
}

TEST_CASE("GrblHal.AFullPlannerLeavesJogsUnreadWhenTheyAreCancelled") {
  GrblTalk talk({.grblhal = true});
  talk.connect_and_home();
  for (int i = 0; i < 200; ++i) {
    talk.tell({{"do", "jog"}, {"x_mm", 0.2}, {"speed_mm_per_s", 1}});
    talk.pass(0.01);
  }
  talk.tell(jog_cancel);
  talk.pass(2);
  CHECK(talk.phase() == "idle");
  const double there_mm = talk.machine.position_mm()[1];
  talk.tell({{"do", "jog"}, {"y_mm", 3}, {"speed_mm_per_s", 20}});
  talk.pass(2);
  CHECK(std::abs(talk.machine.position_mm()[1] - there_mm - 3) < 1e-6);
  talk.pass(4);
  CHECK_FALSE(heard(talk, "did not answer every line"));
}

TEST_CASE("GrblHal.ARefusedDwellKeepsNoPulseOnThoughTheProgramDies") {
  GrblTalk talk({.grblhal = true});
  talk.connect_and_home();
  talk.machine.refuse_line("G4P1", 28);
  talk.tell(focus);
  talk.pass(0.002);
  talk.kill_host(true);
  talk.leave_alone(20);
  CHECK(talk.machine.lines().back() == "G0");  // the pulse had left whole
  CHECK_FALSE(talk.machine.beam());
  CHECK(lit_s(talk) <= 1.1);
}

TEST_CASE("GrblHal.ReportsAreAskedForWhereQuestionMarksAreText") {
  GrblTalk talk({.grblhal = true});
  talk.machine.set_setting(39, 0);
  talk.connect_and_home();  // homes for seconds, jogs, sets the origin
  talk.load(square);
  talk.tell(start_job);
  talk.pass(0.6);
  talk.tell({{"do", "pause"}});
  REQUIRE(talk.pass_until([&] { return talk.phase() == "paused"; }, 2));
  talk.tell({{"do", "resume"}, {"confirmed", true}});
  CHECK(talk.pass_until([&] { return talk.ended() == "done"; }, 20));
  CHECK(talk.state()["error"].is_null());
}

TEST_CASE("GrblHal.AToolChangeWaitsForThePerson") {
  GrblTalk talk({.grblhal = true});
  talk.connect_and_home();
  talk.tell({{"do", "send"}, {"line", "T1M6"}, {"confirmed", true}});
  REQUIRE(talk.pass_until([&] { return talk.phase() == "paused"; }, 2));
  CHECK(heard(talk, "tool change"));
  CHECK_FALSE(talk.can("jog"));
  talk.pass(5);
  CHECK(talk.phase() == "paused");
  CHECK_FALSE(heard(talk, "did not answer every line"));
  talk.tell({{"do", "resume"}, {"confirmed", true}});
  talk.pass(0.5);
  CHECK(talk.phase() == "idle");
  CHECK(talk.state()["position_known"] == true);
}

TEST_CASE("GrblHal.AResetThatCameTooEarlyIsSentAgain") {
  GrblTalk talk({.soft_limits = true, .grblhal = true});
  talk.connect_and_home();
  talk.tell({{"do", "send"}, {"line", "G0X900"}, {"confirmed", true}});
  talk.pass(1.5);
  CHECK(talk.state()["alarm"]["code"] == 2);
  REQUIRE(talk.can("unlock"));
  CHECK_FALSE(heard(talk, "did not answer the reset"));
  talk.tell({{"do", "unlock"}});
  talk.pass(1);
  CHECK(talk.phase() == "idle");
}

TEST_CASE("GrblHal.AnEmergencyStopIsNotResetUntilAskedFor") {
  GrblTalk talk({.grblhal = true});
  talk.connect_and_home();
  say(talk, "ALARM:10");
  talk.pass(0.1);
  CHECK(talk.state()["alarm"]["text"] == grbl_alarm(10, GrblFirmware::grblhal).text);
  CHECK_FALSE(talk.state()["position_known"]);
  talk.pass(3);
  CHECK_FALSE(heard(talk, "did not answer the reset"));
  const std::size_t lines = talk.machine.lines().size();
  talk.driver.command(home, talk.now_s);
  // It hears nothing but a reset: the line for homing goes behind its banner.
  const std::string sent(as_text(talk.driver.take_output().front()));
  CHECK(sent == "\x18");
  CHECK(talk.machine.lines().size() == lines);
}

TEST_CASE("GrblHal.SettingsThatKeepTheBeamOnAreRefused") {
  struct Case {
    int setting;
    double value;
    const char* words;
  };
  for (const auto& [setting, value, words] : {Case{32, 2, "$32=1"}, Case{34, 5, "$34=0"}, Case{9, 5, "$9=1"}}) {
    GrblTalk talk({.grblhal = true});
    talk.machine.set_setting(setting, value);
    talk.connect_and_home();
    talk.load(square);
    CHECK(talk.refusal(start_job).find(words) != std::string::npos);
    CHECK(talk.refusal(focus).find(words) != std::string::npos);
  }
  GrblTalk talk({.grblhal = true});
  talk.machine.set_setting(63, 2);
  talk.connect_and_home();
  talk.load("G21\nG90\nG0 X5 Y5\nM3 S500\nG1 X20 F3000\nG4 P1\nM5\n");
  CHECK(talk.refusal(start_job).find("$63=3") != std::string::npos);
  talk.load(square);  // with M4 a hold is dark whatever $63 says
  CHECK(talk.refusal(start_job).empty());
}

TEST_CASE("GrblHal.OnlyAxesThatHomeAreKnownBehindHoming") {
  GrblTalk talk({.grblhal = true});
  talk.machine.set_setting(44, 3);
  talk.machine.set_setting(45, 0);
  talk.connect_and_home();
  CHECK(talk.state()["axes_known"] == Json({{"x", true}, {"y", true}, {"z", false}}));
  talk.tell({{"do", "set_origin"}, {"axes", "z"}});
  talk.pass(0.5);
  CHECK(talk.state()["axes_known"]["z"] == true);
}

TEST_CASE("GrblHal.AScaleThatIsInForceIsRefused") {
  GrblMachine machine;
  machine.hear("[GC:G0 G54 G17 G21 G90 G94 G40 G49 G98 G51 M5 M9 T0 F0 S0.]");
  CHECK(machine.misplaces().find("G50") != std::string::npos);
  machine.follow("G50");
  CHECK(machine.misplaces().empty());
  machine.follow("G51X2");
  CHECK_FALSE(machine.misplaces().empty());
  machine.reset_parser();
  CHECK(machine.misplaces().empty());
}

TEST_CASE("GrblHal.ReportsHoldMoreThanGrbls") {
  CHECK(read_grbl_report("<Alarm:11|MPos:0.000,0.000,0.000|Bf:100,1023|FS:0,0|H:0|TLR:0>")->detail == 11);
  const auto report = read_grbl_report(
      "<Run:2|MPos:1.000,2.000,3.000,4.000|Bf:100,1023|FS:0,20,18|Pn:XS|WCO:0.000,0.000,0.000,0.000|WCS:G54|A:SF|Sc:XY|"
      "MPG:1|H:1,7|T:3|P:0|TLR:0|FW:grblHAL>");
  REQUIRE(report);
  CHECK(report->spindle_on == true);
  CHECK(report->power == 20.0);
  CHECK(report->pendant == true);
  CHECK((*report->machine_mm)[2] == 3);
  CHECK_FALSE(read_grbl_report("<Idle|MPos:0,0,0|FS:0,0>")->spindle_on.has_value());
  CHECK(read_grbl_report("<Idle|MPos:0,0,0|Ov:100,100,100>")->spindle_on == false);
  CHECK(read_grbl_report("<Tool|MPos:0,0,0|FS:0,0|A:T>")->tool_change);
}

TEST_CASE("GrblHal.AHandHeldControlHasTheMachineForItself") {
  GrblTalk talk({.grblhal = true});
  talk.connect_and_home();
  say(talk, "<Idle|MPos:0.000,0.000,0.000|FS:0,0|MPG:1>");
  CHECK(talk.state()["can"] == Json({"stop"}));
  CHECK(talk.refusal(jog).find("hand-held control") != std::string::npos);
  say(talk, "<Idle|MPos:0.000,0.000,0.000|FS:0,0|MPG:0>");
  CHECK(talk.can("jog"));
}

TEST_CASE("GrblHal.EmptyMessagesAreNotShown") {
  GrblTalk talk({.grblhal = true});
  talk.connect_and_home();
  say(talk, "[MSG:]");
  talk.pass(0.1);
  for (const Json& event : talk.events) CHECK((event["event"] != "note" || event["text"] != ""));
}

TEST_CASE("GrblWords.EveryNumberOfEachFirmwareHasItsSentence") {
  const auto nameless = [](const std::string& text) {
    return text.find("raised alarm") != std::string::npos || text.find("with error") != std::string::npos;
  };
  for (int code = 0; code <= 22; ++code) {
    INFO(code);
    CHECK_FALSE(nameless(grbl_alarm(code, GrblFirmware::grblhal).text));
    CHECK_FALSE(grbl_alarm(code, GrblFirmware::grblhal).fix.empty());
    if (code <= 10) CHECK_FALSE(nameless(grbl_alarm(code, GrblFirmware::grbl).text));
    if (code <= 18) CHECK_FALSE(nameless(grbl_alarm(code, GrblFirmware::fluidnc).text));
  }
  for (int code = 1; code <= 92; ++code) {
    const bool unused = code == 59 || (code >= 67 && code <= 69);
    INFO(code);
    CHECK(nameless(grbl_error(code, GrblFirmware::grblhal)) == unused);
  }
  // The same number, another meaning.
  CHECK(grbl_alarm(10, GrblFirmware::grbl).text != grbl_alarm(10, GrblFirmware::grblhal).text);
  CHECK(grbl_alarm(13, GrblFirmware::fluidnc).text == grbl_alarm(10, GrblFirmware::grblhal).text);
  CHECK(nameless(grbl_alarm(13, GrblFirmware::grbl).text));
}

TEST_CASE("GrblWords.FluidNcIsKnownByItsBannerAndItsVersion") {
  GrblMachine machine;
  CHECK(machine.kind() == GrblFirmware::grbl);
  machine.hear_banner("Grbl 3.9 [FluidNC v3.9.1 (wifi) '$' for help]");
  CHECK(machine.kind() == GrblFirmware::fluidnc);
  CHECK(machine.firmware() == "3.9");
  GrblMachine other;
  other.hear("[VER:3.9 FluidNC v3.9.1 (esp32-wifi) :]");
  CHECK(other.kind() == GrblFirmware::fluidnc);
  GrblMachine third;
  third.hear("[FIRMWARE:grblHAL]");
  CHECK(third.kind() == GrblFirmware::grblhal);
}

TEST_CASE("VirtualGrbl.AsGrblHalACancelledJogEmptiesTheBuffer") {
  VirtualGrbl machine({.homes = false, .grblhal = true});
  machine.open(0);
  machine.advance(1);
  machine.receive("G1F1000\nM3S20\nG4P1\nM5\nG0\n", 1);
  machine.receive("\x85", 1.5);
  machine.advance(5);
  CHECK(machine.beam());
  CHECK(machine.lines().back() == "G4P1");
}

}  // namespace
}  // namespace formwright
