// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/marlin/marlin_driver.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <deque>

#include "base/error.h"
#include "base/random.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinULP;

/// Marlin's side of the line protocol, from its documentation: numbers, checksums, requests, the extra ok.
class NoisyMarlin {
 public:
  explicit NoisyMarlin(std::uint64_t seed, double spoil) : random_(seed), spoil_(spoil) { output = "start\n"; }

  void receive(std::string_view bytes) {
    for (const char c : bytes) {
      if (c != '\n') {
        line_ += c;
        continue;
      }
      std::string line = std::exchange(line_, {});
      heard.push_back(line);
      if (dumb) continue;
      if (!line.empty() && random_.uniform() < spoil_) line[random_.below(line.size())] ^= 0x04;
      inbox_.push_back(line);
    }
    while (!slow && !inbox_.empty()) work();
  }
  /// Does one line of those that have arrived.
  void work() {
    if (inbox_.empty()) return;
    const auto numbered =
        std::count_if(inbox_.begin(), inbox_.end(), [](const std::string& line) { return line.starts_with('N'); });
    max_numbered = std::max(max_numbered, numbered);
    const std::string line = inbox_.front();
    inbox_.pop_front();
    take(line);
  }
  long done_times(const std::string& line) const { return std::count(done.begin(), done.end(), line); }
  long heard_times(const std::string& line) const { return std::count(heard.begin(), heard.end(), line); }

  std::string output;
  std::vector<std::string> done, heard;
  std::ptrdiff_t max_numbered = 0;  // lines with a number that waited at a time
  std::string unanswered;           // what is done without a word
  bool dumb = false;                // hears, does nothing, says nothing
  bool slow = false;                // does a line when it is told to work()
  bool emergency_parser = false;    // takes M108 and M410 out of the line without an answer

 private:
  void take(const std::string& line) {
    if (!line.starts_with('N') && line.find('*') == std::string::npos) {  // may come without a number
      if (!emergency_parser || (line != "M108" && line != "M410")) output += "ok\n";
      done.push_back(line);
      return;
    }
    const std::size_t star = line.find('*');
    unsigned checksum = 0;
    for (const char c : line.substr(0, star)) checksum ^= static_cast<unsigned char>(c);
    const bool whole = star != std::string::npos && line[0] == 'N' && std::to_string(checksum) == line.substr(star + 1);
    const int number = whole ? std::atoi(line.c_str() + 1) : -1;
    const std::string text = whole ? line.substr(line.find(' ') + 1, star - line.find(' ') - 1) : "";
    if (!whole) return again("Error:checksum mismatch, Last Line: ");
    if (text.starts_with("M110")) last_ = number - 1;
    if (number != last_ + 1) return again("Error:Line Number is not Last Line Number+1, Last Line: ");
    last_ = number;
    done.push_back(text);
    if (text == unanswered) return;
    if (text == "M105") output += "ok T:201.5 /210.0 B:60.1 /60.0 @:127 B@:0\n";
    else if (text == "M114") output += "X:1.00 Y:2.00 Z:3.00 E:0.00 Count X:80 Y:160 Z:1200\nok\n";
    else if (text == "M115") output += "FIRMWARE_NAME:Marlin 2.1.2 (Jan 1 2024) SOURCE_CODE_URL:x\nok\n";
    else output += "ok\n";
  }
  void again(const std::string& why) {
    output += why + std::to_string(last_) + "\nResend: " + std::to_string(last_ + 1) + "\nok\n";
  }

  std::string line_;
  std::deque<std::string> inbox_;
  int last_ = 0;
  Random random_;
  double spoil_;
};

struct MarlinTalk {
  explicit MarlinTalk(double spoil = 0, std::uint64_t seed = 1, MachineTool tool = MachineTool::printer,
                      double focus_seconds = 60)
      : machine(seed, spoil),
        driver({.controller = DriverController::marlin, .tool = tool, .focus_seconds = focus_seconds}) {
    driver.opened(0);
  }
  void hand_over() {
    for (const Bytes& packet : driver.take_output()) machine.receive(as_text(packet));
  }
  /// What still leaves when the port is closed now.
  std::string leaves() {
    std::string text = "\n";
    for (const Bytes& packet : driver.take_output()) text += as_text(packet);
    return text;
  }
  std::string phase() const { return driver.state(now_s)["phase"]; }
  bool can(const std::string& what) const {
    const Json names = driver.state(now_s)["can"];
    return std::find(names.begin(), names.end(), what) != names.end();
  }
  void tell(const Json& command) { driver.command(command, now_s); }
  std::string refusal(const Json& command) {
    try {
      tell(command);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }
  /// A job of many moves, under way.
  void start_moves() {
    std::string job;
    for (int i = 0; i < 5000; ++i) job += "G1 X" + std::to_string(i) + " F3000\n";
    driver.load("test", as_bytes(job));
    tell({{"do", "start"}, {"confirmed", true}});
    pass(0.5);
  }
  void pass(double seconds) {
    for (const double end = now_s + seconds; now_s < end; now_s += 0.01) {
      hand_over();
      if (machine.slow) machine.work();
      driver.received(as_bytes(std::exchange(machine.output, {})), now_s);
      driver.tick(now_s);
    }
  }
  NoisyMarlin machine;
  MarlinDriver driver;
  double now_s = 0;
};

TEST_CASE("MarlinDriver.NumbersLinesWithTheirChecksum") {
  // The example of the RepRap wiki, "Checking".
  CHECK(numbered_line(3, "T0") == "N3 T0*57");
  CHECK(numbered_line(4, "G92 E0") == "N4 G92 E0*67");
}

TEST_CASE("MarlinDriver.GreetsAndReadsTemperatures") {
  MarlinTalk talk;
  talk.pass(3);
  const Json state = talk.driver.state(talk.now_s);
  CHECK(state["connection"] == "ready");
  CHECK(state["phase"] == "idle");
  CHECK(state["firmware"] == "Marlin 2.1.2");
  CHECK_THAT(state["temperatures"]["hotend_c"], WithinULP(201.5, 4));
  CHECK_THAT(state["machine_mm"][2], WithinULP(3.0, 4));
}

TEST_CASE("MarlinDriver.SpoiledLinesAreSentAgainUntilAllIsThereInOrder") {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    MarlinTalk talk(0.15, seed);
    talk.pass(3);
    std::string job;
    for (int i = 0; i < 200; ++i) job += "G1 X" + std::to_string(i) + " F3000\n";
    talk.driver.load("test", as_bytes(job));
    talk.driver.command({{"do", "start"}, {"confirmed", true}}, talk.now_s);
    talk.pass(60);
    {
      INFO("seed " << seed);
      CHECK(talk.driver.state(talk.now_s)["job"]["ended"] == "done");
    }
    int next = 0;
    for (const std::string& line : talk.machine.done) {
      if (!line.starts_with("G1X")) continue;
      CHECK(line == "G1X" + std::to_string(next++) + "F3000");
    }
    CHECK(next == 200);
  }
}

TEST_CASE("MarlinDriver.StopClearsTheQueueAndTurnsTheHeatersOff") {
  MarlinTalk talk;
  talk.pass(3);
  std::string job;
  for (int i = 0; i < 5000; ++i) job += "G1 X" + std::to_string(i) + " F3000\n";
  talk.driver.load("test", as_bytes(job));
  CHECK_THROWS_AS(talk.driver.command({{"do", "start"}}, talk.now_s), Error);
  talk.driver.command({{"do", "start"}, {"confirmed", true}}, talk.now_s);
  talk.pass(1);
  talk.driver.command({{"do", "stop"}}, talk.now_s);
  talk.pass(3);
  CHECK(talk.driver.state(talk.now_s)["job"]["ended"] == "stopped");
  const auto& done = talk.machine.done;
  const auto stopped = std::find(done.begin(), done.end(), "M410");
  REQUIRE(stopped != done.end());
  CHECK(std::find(stopped, done.end(), "M104 S0") != done.end());
  CHECK(std::find(stopped, done.end(), "M140 S0") != done.end());
  CHECK(std::count_if(stopped, done.end(), [](const std::string& line) { return line.starts_with("G1"); }) == 0);
}

TEST_CASE("MarlinDriver.AHaltIsSaid") {
  MarlinTalk talk;
  talk.pass(3);
  talk.machine.output += "Error:Thermal Runaway, system stopped! Heater_ID: 0\n";
  talk.pass(0.2);
  const Json state = talk.driver.state(talk.now_s);
  CHECK(state["phase"] == "alarm");
  CHECK(state["alarm"]["text"].get<std::string>().find("Thermal Runaway") != std::string::npos);
}

TEST_CASE("MarlinDriver.AMotorCalledBIsNoBed") {
  MarlinTalk talk;
  talk.pass(3);
  talk.machine.output += "ok X:39.0 Y:3.0 Z:0 E:79.5 Count: A:3900 B:300 C:0\n";
  talk.pass(0.05);
  const Json state = talk.driver.state(talk.now_s);
  CHECK_THAT(state["temperatures"]["bed_c"], WithinULP(60.1, 4));
  CHECK_THAT(state["machine_mm"][0], WithinULP(39.0, 4));
}

TEST_CASE("MarlinDriver.MistakesInOtherWordsAreNoHalt") {
  for (const char* words : {"Error: Checksum mismatch", "Error: expected line 7 got 8",
                            "Error:No Line Number with checksum, Last Line: 4", "Error: Unknown command M5"}) {
    MarlinTalk talk;
    talk.pass(3);
    talk.machine.output += std::string(words) + "\n";
    talk.pass(0.1);
    INFO(words);
    CHECK(talk.driver.state(talk.now_s)["phase"] == "idle");
  }
}

TEST_CASE("MarlinDriver.SilenceEndsAJobAndIsNotTalkedInto") {
  MarlinTalk talk;
  talk.pass(3);
  std::string job;
  for (int i = 0; i < 500; ++i) job += "G1 X" + std::to_string(i) + " F3000\n";
  talk.driver.load("test", as_bytes(job));
  talk.driver.command({{"do", "start"}, {"confirmed", true}}, talk.now_s);
  talk.pass(0.5);
  talk.machine.dumb = true;
  const std::size_t heard = talk.machine.heard.size();
  talk.pass(110);
  CHECK(talk.driver.state(talk.now_s)["job"]["ended"].is_null());
  CHECK(talk.machine.heard.size() - heard <= 5u);
  talk.pass(20);
  const Json state = talk.driver.state(talk.now_s);
  CHECK(state["job"]["ended"] == "cut_off");
  CHECK(state["connection"] == "silent");
  CHECK_FALSE(state["position_known"]);
  CHECK(talk.machine.heard_times("M104 S0") == 1);
  CHECK(talk.machine.heard_times("M112") == 0);  // it may have been the cable
}

TEST_CASE("MarlinDriver.WhatTurnsOffLeavesBeforeThePortCloses") {
  MarlinTalk talk;
  talk.pass(3);
  talk.start_moves();
  talk.tell({{"do", "pause"}});
  talk.pass(0.5);
  REQUIRE(talk.phase() == "paused");
  talk.tell({{"do", "stop"}});
  const std::string text = talk.leaves();
  for (const char* line : {"\nM108\n", "\nM410\n", "\nM104 S0\n", "\nM140 S0\n", "\nM107\n"}) {
    INFO(line << " is not in " << text);
    CHECK(text.find(line) != std::string::npos);
  }
}

TEST_CASE("MarlinDriver.AStopIsOverWhenAllIsTurnedOff") {
  MarlinTalk talk;
  talk.pass(3);
  talk.tell({{"do", "stop"}});
  CHECK(talk.phase() == "stopping");
  for (int i = 0; i < 400 && talk.phase() == "stopping"; ++i) talk.pass(0.01);
  CHECK(talk.phase() == "idle");
  // Once at once, and once with a number, which it asks for until it is there.
  for (const char* line : {"M104 S0", "M140 S0", "M107"}) {
    INFO(line);
    CHECK(talk.machine.done_times(line) == 2);
  }
  CHECK(talk.machine.heard_times("M112") == 0);
}

TEST_CASE("MarlinDriver.AnswersToLinesWithoutANumberPassForNoOthers") {
  for (const bool emergency_parser : {false, true}) {
    CAPTURE(emergency_parser);
    MarlinTalk talk;
    talk.pass(3);
    talk.machine.slow = true;
    talk.machine.emergency_parser = emergency_parser;
    talk.start_moves();
    talk.hand_over();  // a line is under way
    talk.machine.max_numbered = 0;
    talk.tell({{"do", "stop"}});
    talk.pass(4);
    CHECK(talk.phase() == "idle");
    CHECK(talk.machine.max_numbered == 1);
    CHECK(talk.machine.done_times("M104 S0") == 2);
    CHECK(talk.machine.heard_times("M112") == 0);
  }
}

TEST_CASE("MarlinDriver.AStopBeforeTheGreetingIsNoEmergency") {
  MarlinTalk talk;
  talk.machine.output.clear();  // a board that does not restart when its port is opened
  talk.tell({{"do", "stop"}});
  CHECK(talk.phase() == "stopping");
  CHECK(talk.leaves().find("\nM140 S0\n") != std::string::npos);
  talk.pass(6);
  CHECK(talk.machine.heard_times("M112") == 0);
  CHECK(talk.phase() == "idle");
}

TEST_CASE("MarlinDriver.AStopThatIsNotHeardBecomesAnEmergency") {
  MarlinTalk talk;
  talk.pass(3);
  talk.start_moves();
  talk.machine.dumb = true;
  talk.hand_over();
  talk.tell({{"do", "stop"}});
  talk.pass(1.9);
  CHECK(talk.machine.heard_times("M112") == 0);
  talk.pass(0.3);
  CHECK(talk.machine.heard_times("M112") == 1);
  CHECK(talk.phase() == "alarm");
}

TEST_CASE("MarlinDriver.AJobThatMovesTheOriginIsAPrintersOnly") {
  const std::string job = "G28\nG92 X0 Y0\nG1 X5 F3000\n";
  MarlinTalk laser(0, 1, MachineTool::laser), printer(0, 1, MachineTool::printer);
  CHECK_THROWS_AS(laser.driver.load("test", as_bytes(job)), Error);
  CHECK_NOTHROW(printer.driver.load("test", as_bytes(job)));
}

TEST_CASE("MarlinDriver.AJogIsAMoveUntilItIsDone") {
  MarlinTalk talk(0, 1, MachineTool::laser);
  talk.pass(3);
  talk.tell({{"do", "set_origin"}});
  talk.driver.load("test", as_bytes("G21\nG90\nG1 X5 F3000\n"));
  CHECK(talk.can("start"));
  talk.tell({{"do", "jog"}, {"x_mm", 30}, {"speed_mm_per_s", 20}});
  CHECK(talk.phase() == "jogging");  // who ends the session stops the machine first
  CHECK(talk.can("jog"));
  CHECK_FALSE(talk.can("start"));
  talk.pass(1.5);
  CHECK(talk.phase() == "jogging");
  talk.pass(0.5);
  CHECK(talk.phase() == "idle");
  CHECK(talk.can("start"));
}

TEST_CASE("MarlinDriver.AJobThatCountsFromTheHeadStartsAtTheOriginOnly") {
  const std::string job = "G21\nG91\nM4 S100\nG1 X100 F1000\n";
  const Json start = {{"do", "start"}, {"confirmed", true}};
  MarlinTalk talk(0, 1, MachineTool::laser);
  talk.pass(3);
  talk.tell({{"do", "home"}, {"confirmed", true}});
  talk.pass(1);
  REQUIRE(talk.driver.state(talk.now_s)["position_known"]);
  talk.driver.load("test", as_bytes(job));
  CHECK(talk.refusal(start).find("G91") != std::string::npos);  // it says x 1, y 2
  talk.tell({{"do", "set_origin"}});
  CHECK(talk.refusal(start) == "");
  // A printer's job homes it by itself.
  MarlinTalk printer;
  printer.pass(3);
  printer.driver.load("test", as_bytes(job));
  CHECK(printer.refusal(start) == "");
}

TEST_CASE("MarlinDriver.ALostAnswerDoesNotMakeAJobDone") {
  // The answer to M400 never comes: the job is done when the machine tells its place behind it, and not before.
  MarlinTalk talk;
  talk.pass(3);
  talk.driver.load("test", as_bytes("G1 X5 F3000\nG1 X6\n"));
  talk.driver.command({{"do", "start"}, {"confirmed", true}}, talk.now_s);
  talk.machine.unanswered = "M400";
  talk.pass(9);
  REQUIRE(talk.machine.done.back() == "M400");
  CHECK(talk.driver.state(talk.now_s)["job"]["ended"].is_null());
  talk.pass(4);
  CHECK(talk.driver.state(talk.now_s)["job"]["ended"] == "done");
}

}  // namespace
}  // namespace formwright
