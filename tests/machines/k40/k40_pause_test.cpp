// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch_test_macros.hpp>

#include <algorithm>
#include <string>
#include <vector>

#include "machines/k40/k40_driver.h"
#include "machines/k40/k40_talk.h"

namespace formwright {
namespace {

TEST_CASE("K40.PausesArriveOnceThroughSpoiledPackets") {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    K40Talk talk(seed, 0.2);
    talk.pass(1);
    talk.driver.command({{"do", "home"}, {"confirmed", true}}, talk.now_s);
    talk.pass(3);
    std::string egv;
    for (int i = 0; i < 200; ++i) egv += letters_of(i) + "\n";
    talk.driver.load("job.egv", as_bytes(egv + "FNSE-\n"));
    const std::size_t before = talk.board.heard.size();
    talk.driver.command({{"do", "start"}, {"confirmed", true}}, talk.now_s);
    std::size_t holds = 0;
    for (int pause = 0; pause < 3; ++pause) {
      talk.pass(0.11 + 0.07 * static_cast<double>(seed));
      talk.driver.command({{"do", "pause"}}, talk.now_s);
      talk.board.spoil_next = pause;  // what goes out next, be it the job's or the one that holds
      talk.pass(1);
      CHECK(talk.phase() == "paused");
      ++holds;
      CHECK(std::count(talk.board.heard.begin(), talk.board.heard.end(), padded("PN")) == static_cast<int>(holds));
      const std::size_t held = talk.board.heard.size();
      talk.pass(1);
      CHECK(talk.board.heard.size() == held);  // nothing follows while it is held
      talk.driver.command({{"do", "resume"}, {"confirmed", true}}, talk.now_s);
      ++holds;
    }
    talk.pass(40);
    {
      INFO(talk.driver.state(talk.now_s).dump());
      CHECK(talk.driver.state(talk.now_s)["job"]["ended"] == "done");
    }
    std::vector<std::string> job;
    for (std::size_t i = before; i < talk.board.heard.size(); ++i)
      if (talk.board.heard[i] != padded("PN")) job.push_back(talk.board.heard[i]);
    CHECK(talk.board.heard.size() - before == job.size() + holds);
    REQUIRE(job.size() == 201u);  // each once, in order
    for (int i = 0; i < 200; ++i) CHECK(job[static_cast<std::size_t>(i)] == letters_of(i));
  }
}

TEST_CASE("K40.APauseIsNotKeptWaitingByABusyBoard") {
  K40Driver driver({.controller = DriverController::k40});
  const auto answer = [](int status) { return Bytes{std::byte{255}, static_cast<std::byte>(status)}; };
  double now = 0;
  const auto hear = [&](int status, double after = 0.01) {
    driver.take_output();
    driver.received(answer(status), now += after);
    driver.tick(now += 0.03);
  };
  const auto sent = [&](const std::string& letters) {
    const auto output = driver.take_output();
    return std::count(output.begin(), output.end(), k40_transfer(letters));
  };
  driver.opened(now);
  hear(206);
  driver.command({{"do", "home"}, {"confirmed", true}}, now);
  for (int i = 0; i < 60; ++i) hear(206, 0.05);
  driver.load("job.egv", as_bytes(std::string("BTB\nDUD\n")));
  driver.command({{"do", "start"}, {"confirmed", true}}, now);
  hear(206);
  driver.command({{"do", "pause"}}, now);
  hear(238);
  CHECK(sent("PN") == 0);  // "BTB" may still be rejected
  while (now < 6) {
    hear(238, 0.1);
    if (sent("PN") > 0) break;
  }
  REQUIRE(now < 6);  // half a second later it surely is in
  hear(207);
  const auto output = driver.take_output();
  CHECK(std::count(output.begin(), output.end(), k40_transfer("BTB")) == 0);
  CHECK(std::count(output.begin(), output.end(), k40_transfer("PN")) == 1);
}

/// A driver whose board's every answer is the test's, with a job of "BTB", "DUD" and "LRL" begun.
struct K40Scripted {
  using Packets = std::vector<std::string>;

  K40Scripted() {
    driver.opened(now_s);
    hear(206);
    driver.command({{"do", "home"}, {"confirmed", true}}, now_s);
    for (int i = 0; i < 60; ++i) hear(206);
    driver.load("job.egv", as_bytes(std::string("BTB\nDUD\nLRL\n")));
    driver.command({{"do", "start"}, {"confirmed", true}}, now_s);
  }
  /// The packets that went out since the last call.
  Packets sent() {
    Packets packets;
    for (const Bytes& transfer : driver.take_output())
      if (transfer.size() == 34) packets.emplace_back(as_text(transfer).substr(2, 30));
    return packets;
  }
  /// Those that go out upon an answer.
  Packets hear(int status) {
    driver.take_output();
    const Bytes answer{std::byte{255}, static_cast<std::byte>(status)};
    driver.received(answer, now_s += 0.04);
    return sent();
  }
  void resume() { driver.command({{"do", "resume"}, {"confirmed", true}}, now_s); }
  std::string phase() const { return driver.state(now_s)["phase"]; }

  K40Driver driver{DriverOptions{.controller = DriverController::k40}};
  double now_s = 0;
};

TEST_CASE("K40.APauseThatArrivesSpoiledIsSentAgainAndNotTheJob") {
  K40Scripted laser;
  CHECK(laser.hear(206) == K40Scripted::Packets{padded("BTB")});
  CHECK(laser.hear(206) == K40Scripted::Packets{padded("DUD")});
  laser.driver.command({{"do", "pause"}}, laser.now_s);
  CHECK(laser.hear(206) == K40Scripted::Packets{padded("PN")});  // "DUD" is in
  CHECK(laser.hear(207) == K40Scripted::Packets{padded("PN")});
  CHECK(laser.hear(238) == K40Scripted::Packets{});
  CHECK(laser.hear(207) == K40Scripted::Packets{padded("PN")});
  CHECK(laser.hear(206) == K40Scripted::Packets{});
  CHECK(laser.phase() == "paused");
  laser.resume();
  CHECK(laser.sent() == K40Scripted::Packets{padded("PN")});
  CHECK(laser.hear(207) == K40Scripted::Packets{padded("PN")});
  CHECK(laser.hear(206) == K40Scripted::Packets{padded("LRL")});
  CHECK(laser.phase() == "running");
}

TEST_CASE("K40.APauseWaitsForAPacketOfTheJobThatIsSpoiled") {
  K40Scripted laser;
  CHECK(laser.hear(206) == K40Scripted::Packets{padded("BTB")});
  laser.driver.command({{"do", "pause"}}, laser.now_s);
  CHECK(laser.sent() == K40Scripted::Packets{});
  CHECK(laser.hear(207) == K40Scripted::Packets{padded("BTB")});
  CHECK(laser.hear(238) == K40Scripted::Packets{});
  CHECK(laser.hear(207) == K40Scripted::Packets{padded("BTB")});
  CHECK(laser.hear(206) == K40Scripted::Packets{padded("PN")});
  CHECK(laser.hear(206) == K40Scripted::Packets{});
  CHECK(laser.phase() == "paused");
  laser.resume();
  CHECK(laser.sent() == K40Scripted::Packets{padded("PN")});
  CHECK(laser.hear(206) == K40Scripted::Packets{padded("DUD")});
}

TEST_CASE("K40.AStopDoesNotWaitForAPause") {
  for (const bool pause_is_out : {false, true}) {
    CAPTURE(pause_is_out);
    K40Scripted laser;
    CHECK(laser.hear(206) == K40Scripted::Packets{padded("BTB")});
    laser.driver.command({{"do", "pause"}}, laser.now_s);
    if (pause_is_out) {
      CHECK(laser.hear(206) == K40Scripted::Packets{padded("PN")});
    }
    laser.driver.command({{"do", "stop"}}, laser.now_s);
    CHECK(laser.sent() == K40Scripted::Packets{padded("I")});
    laser.hear(206);  // to what was asked before
    CHECK(laser.phase() == "stopping");
    CHECK(laser.hear(207) == K40Scripted::Packets{padded("I")});
    CHECK(laser.hear(206) == K40Scripted::Packets{});
    CHECK(laser.phase() == "idle");
  }
}

}  // namespace
}  // namespace formwright
