// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch_test_macros.hpp>

#include <cstdint>
#include <string>

#include "machines/k40/k40_driver.h"
#include "machines/k40/k40_talk.h"
#include "machines/notes_of.h"

namespace formwright {
namespace {

TEST_CASE("K40.StopOvertakesAndNothingFollows") {
  K40Talk talk;
  talk.pass(1);
  talk.driver.command({{"do", "home"}, {"confirmed", true}}, talk.now_s);
  talk.pass(3);
  talk.driver.load("job.egv", as_bytes(std::string(30 * 500, 'B')));
  talk.driver.command({{"do", "start"}, {"confirmed", true}}, talk.now_s);
  talk.pass(0.3);
  talk.driver.command({{"do", "stop"}}, talk.now_s);
  talk.pass(1);
  CHECK(talk.board.heard.back() == padded("I"));
  CHECK(talk.board.heard.size() < 100u);
  CHECK_FALSE(talk.driver.state(talk.now_s)["position_known"]);
  CHECK(talk.driver.state(talk.now_s)["job"]["ended"] == "stopped");
}

TEST_CASE("K40.AStopThatArrivesSpoiledIsSentAgain") {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    K40Talk talk(seed);
    talk.start_job();
    talk.board.spoil_next = 2;
    talk.driver.command({{"do", "stop"}}, talk.now_s);
    CHECK(talk.phase() == "stopping");
    talk.pass(1);
    CHECK(talk.board.spoiled == 2);
    CHECK(talk.board.heard.back() == padded("I"));
    CHECK(talk.phase() == "idle");
  }
}

TEST_CASE("K40.AnAnswerFromBeforeTheStopDoesNotConfirmIt") {
  K40Driver driver({.controller = DriverController::k40});
  const auto answer = [](int status) { return Bytes{std::byte{255}, static_cast<std::byte>(status)}; };
  driver.opened(0);
  driver.take_output();  // the board is asked
  driver.command({{"do", "stop"}}, 0.01);
  driver.received(answer(206), 0.02);
  CHECK(driver.state(0.02)["phase"] == "stopping");
  driver.tick(0.1);
  driver.take_output();
  driver.received(answer(207), 0.11);
  CHECK(driver.state(0.11)["phase"] == "stopping");
  CHECK(driver.take_output().at(0) == k40_transfer("I"));
  driver.received(answer(206), 0.12);
  CHECK(driver.state(0.12)["phase"] == "idle");
}

TEST_CASE("K40.AStopThatNeverArrivesIsSaid") {
  K40Talk talk;
  talk.start_job();
  talk.board.spoil_next = 1000;
  talk.driver.command({{"do", "stop"}}, talk.now_s);
  talk.pass(3);
  CHECK(talk.board.spoiled == 11);  // and not for ever
  CHECK(notes_of(talk.driver).find("switch it off") != std::string::npos);
  CHECK(talk.driver.state(talk.now_s)["job"]["ended"] == "stopped");
  CHECK(talk.phase() == "idle");
  // It can be used again when its cable is better.
  talk.board.spoil_next = 0;
  talk.driver.command({{"do", "home"}, {"confirmed", true}}, talk.now_s);
  talk.pass(3);
  CHECK(talk.driver.state(talk.now_s)["position_known"]);
}

}  // namespace
}  // namespace formwright
