// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/marlin_driver.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "base/random.h"

namespace formwright {
namespace {

/// Marlin's side of the line protocol, from its documentation: numbers, checksums, requests, the extra ok.
class VirtualMarlin {
 public:
  explicit VirtualMarlin(std::uint64_t seed, double spoil) : random_(seed), spoil_(spoil) { output = "start\n"; }

  void receive(std::string_view bytes) {
    for (const char c : bytes) {
      if (c != '\n') {
        line_ += c;
        continue;
      }
      std::string line = std::exchange(line_, {});
      ++heard;
      if (dumb) continue;
      if (!line.empty() && random_.uniform() < spoil_) line[random_.below(line.size())] ^= 0x04;
      take(line);
    }
  }
  std::string output;
  std::vector<std::string> done;
  int heard = 0;           // lines
  std::string unanswered;  // what is done without a word
  bool dumb = false;       // hears, does nothing, says nothing

 private:
  void take(const std::string& line) {
    if (line == "M108" || line == "M410") {
      output += "ok\n";
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
  int last_ = 0;
  Random random_;
  double spoil_;
};

struct MarlinTalk {
  explicit MarlinTalk(double spoil = 0, std::uint64_t seed = 1, MachineTool tool = MachineTool::printer)
      : machine(seed, spoil), driver({.controller = DriverController::marlin, .tool = tool}) {
    driver.opened(0);
  }
  void pass(double seconds) {
    for (const double end = now_s + seconds; now_s < end; now_s += 0.01) {
      for (const Bytes& packet : driver.take_output()) machine.receive(as_text(packet));
      driver.received(as_bytes(std::exchange(machine.output, {})), now_s);
      driver.tick(now_s);
    }
  }
  VirtualMarlin machine;
  MarlinDriver driver;
  double now_s = 0;
};

TEST(MarlinDriver, NumbersLinesWithTheirChecksum) {
  // The example of the RepRap wiki, "Checking".
  EXPECT_EQ(numbered_line(3, "T0"), "N3 T0*57");
  EXPECT_EQ(numbered_line(4, "G92 E0"), "N4 G92 E0*67");
}

TEST(MarlinDriver, GreetsAndReadsTemperatures) {
  MarlinTalk talk;
  talk.pass(3);
  const Json state = talk.driver.state(talk.now_s);
  EXPECT_EQ(state["connection"], "ready");
  EXPECT_EQ(state["phase"], "idle");
  EXPECT_EQ(state["firmware"], "Marlin 2.1.2");
  EXPECT_DOUBLE_EQ(state["temperatures"]["hotend_c"], 201.5);
  EXPECT_DOUBLE_EQ(state["machine_mm"][2], 3);
}

TEST(MarlinDriver, SpoiledLinesAreSentAgainUntilAllIsThereInOrder) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    MarlinTalk talk(0.15, seed);
    talk.pass(3);
    std::string job;
    for (int i = 0; i < 200; ++i) job += "G1 X" + std::to_string(i) + " F3000\n";
    talk.driver.load("test", as_bytes(job));
    talk.driver.command({{"do", "start"}, {"confirmed", true}}, talk.now_s);
    talk.pass(60);
    EXPECT_EQ(talk.driver.state(talk.now_s)["job"]["ended"], "done") << "seed " << seed;
    int next = 0;
    for (const std::string& line : talk.machine.done) {
      if (!line.starts_with("G1X")) continue;
      EXPECT_EQ(line, "G1X" + std::to_string(next++) + "F3000");
    }
    EXPECT_EQ(next, 200);
  }
}

TEST(MarlinDriver, StopClearsTheQueueAndTurnsTheHeatersOff) {
  MarlinTalk talk;
  talk.pass(3);
  std::string job;
  for (int i = 0; i < 5000; ++i) job += "G1 X" + std::to_string(i) + " F3000\n";
  talk.driver.load("test", as_bytes(job));
  EXPECT_THROW(talk.driver.command({{"do", "start"}}, talk.now_s), Error);
  talk.driver.command({{"do", "start"}, {"confirmed", true}}, talk.now_s);
  talk.pass(1);
  talk.driver.command({{"do", "stop"}}, talk.now_s);
  talk.pass(3);
  EXPECT_EQ(talk.driver.state(talk.now_s)["job"]["ended"], "stopped");
  const auto& done = talk.machine.done;
  const auto stopped = std::find(done.begin(), done.end(), "M410");
  ASSERT_NE(stopped, done.end());
  EXPECT_NE(std::find(stopped, done.end(), "M104 S0"), done.end());
  EXPECT_NE(std::find(stopped, done.end(), "M140 S0"), done.end());
  EXPECT_EQ(std::count_if(stopped, done.end(), [](const std::string& line) { return line.starts_with("G1"); }), 0);
}

TEST(MarlinDriver, AHaltIsSaid) {
  MarlinTalk talk;
  talk.pass(3);
  talk.machine.output += "Error:Thermal Runaway, system stopped! Heater_ID: 0\n";
  talk.pass(0.2);
  const Json state = talk.driver.state(talk.now_s);
  EXPECT_EQ(state["phase"], "alarm");
  EXPECT_NE(state["alarm"]["text"].get<std::string>().find("Thermal Runaway"), std::string::npos);
}

TEST(MarlinDriver, AMotorCalledBIsNoBed) {
  MarlinTalk talk;
  talk.pass(3);
  talk.machine.output += "ok X:39.0 Y:3.0 Z:0 E:79.5 Count: A:3900 B:300 C:0\n";
  talk.pass(0.05);
  const Json state = talk.driver.state(talk.now_s);
  EXPECT_DOUBLE_EQ(state["temperatures"]["bed_c"], 60.1);
  EXPECT_DOUBLE_EQ(state["machine_mm"][0], 39);
}

TEST(MarlinDriver, MistakesInOtherWordsAreNoHalt) {
  for (const char* words : {"Error: Checksum mismatch", "Error: expected line 7 got 8",
                            "Error:No Line Number with checksum, Last Line: 4", "Error: Unknown command M5"}) {
    MarlinTalk talk;
    talk.pass(3);
    talk.machine.output += std::string(words) + "\n";
    talk.pass(0.1);
    EXPECT_EQ(talk.driver.state(talk.now_s)["phase"], "idle") << words;
  }
}

TEST(MarlinDriver, SilenceEndsAJobAndIsNotTalkedInto) {
  MarlinTalk talk;
  talk.pass(3);
  std::string job;
  for (int i = 0; i < 500; ++i) job += "G1 X" + std::to_string(i) + " F3000\n";
  talk.driver.load("test", as_bytes(job));
  talk.driver.command({{"do", "start"}, {"confirmed", true}}, talk.now_s);
  talk.pass(0.5);
  talk.machine.dumb = true;
  const int heard = talk.machine.heard;
  talk.pass(110);
  EXPECT_TRUE(talk.driver.state(talk.now_s)["job"]["ended"].is_null());
  EXPECT_LE(talk.machine.heard - heard, 5);
  talk.pass(20);
  const Json state = talk.driver.state(talk.now_s);
  EXPECT_EQ(state["job"]["ended"], "cut_off");
  EXPECT_EQ(state["connection"], "silent");
  EXPECT_FALSE(state["position_known"]);
}

TEST(MarlinDriver, ALostAnswerDoesNotMakeAJobDone) {
  // The answer to M400 never comes: the job is done when the machine tells its place behind it, and not before.
  MarlinTalk talk;
  talk.pass(3);
  talk.driver.load("test", as_bytes("G1 X5 F3000\nG1 X6\n"));
  talk.driver.command({{"do", "start"}, {"confirmed", true}}, talk.now_s);
  talk.machine.unanswered = "M400";
  talk.pass(9);
  ASSERT_EQ(talk.machine.done.back(), "M400");
  EXPECT_TRUE(talk.driver.state(talk.now_s)["job"]["ended"].is_null());
  talk.pass(4);
  EXPECT_EQ(talk.driver.state(talk.now_s)["job"]["ended"], "done");
}

}  // namespace
}  // namespace formwright
