// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/k40/k40_driver.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <string>

#include "base/error.h"
#include "machines/k40/k40_talk.h"
#include "machines/notes_of.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

TEST_CASE("K40.JobsArriveWholeThroughSpoiledPackets") {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    K40Talk talk(seed, 0.2);
    talk.pass(1);
    CHECK(talk.driver.state(talk.now_s)["phase"] == "idle");
    std::string egv;
    for (int i = 0; i < 40; ++i) egv += letters_of(i) + "\n";
    egv += "FNSE-\n";
    talk.driver.load("job.egv", as_bytes(egv));
    CHECK_THROWS_AS(talk.driver.command({{"do", "start"}, {"confirmed", true}}, talk.now_s), Error);  // not homed
    talk.driver.command({{"do", "home"}, {"confirmed", true}}, talk.now_s);
    talk.pass(3);
    REQUIRE(talk.driver.state(talk.now_s)["position_known"]);
    const std::size_t before = talk.board.heard.size();
    talk.driver.command({{"do", "start"}, {"confirmed", true}}, talk.now_s);
    talk.pass(10);
    {
      INFO(talk.driver.state(talk.now_s).dump());
      CHECK(talk.driver.state(talk.now_s)["job"]["ended"] == "done");
    }
    REQUIRE(talk.board.heard.size() - before == 41u);
    for (std::size_t i = 0; i < 40; ++i) CHECK(talk.board.heard[before + i] == letters_of(static_cast<int>(i)));
  }
}

TEST_CASE("K40.AJobThatNeverArrivesIsStopped") {
  K40Talk talk;
  talk.start_job();
  talk.board.spoil_next = 1000;
  talk.pass(5);
  CHECK(talk.driver.state(talk.now_s)["job"]["ended"] == "failed");
  CHECK(talk.board.spoiled == 22);  // a packet of the job, then the stop
  const std::string notes = notes_of(talk.driver);
  CHECK(notes.find("shorter cable") != std::string::npos);
  CHECK(notes.find("switch it off") != std::string::npos);
}

TEST_CASE("K40.KeepsInsideItsBed") {
  K40Talk talk;
  talk.pass(1);
  talk.driver.command({{"do", "home"}, {"confirmed", true}}, talk.now_s);
  talk.pass(3);
  CHECK_THROWS_AS(talk.driver.command({{"do", "go_to"}, {"x_mm", 301}, {"y_mm", 10}}, talk.now_s), Error);
  CHECK_THROWS_AS(talk.driver.command({{"do", "jog"}, {"y_mm", 5}}, talk.now_s), Error);  // home is at the back
  talk.driver.command({{"do", "go_to"}, {"x_mm", 25.4}, {"y_mm", 200 - 2.54}}, talk.now_s);
  talk.pass(0.3);
  CHECK(talk.board.heard.back() == padded("IBzzz235R100S1P"));
}

TEST_CASE("K40.AJobThatLeavesTheBedIsRefusedAtItsStart") {
  K40Talk talk;
  talk.pass(1);
  talk.driver.command({{"do", "home"}, {"confirmed", true}}, talk.now_s);
  talk.pass(3);
  const auto refusal = [&](const std::string& egv) -> std::string {
    try {
      talk.driver.load("job.egv", as_bytes(egv));
      talk.driver.command({{"do", "start"}, {"confirmed", true}}, talk.now_s);
    } catch (const Error& error) {
      CHECK(error.where() == "job");
      return error.what();
    }
    return "";
  };
  const auto right = [](int mil) { return "I" + k40_rapid_move(mil, 0).substr(1) + "\n"; };
  CHECK(refusal(right(11900) + "ICV1752241000000003CBRNS1EDB100FNSE-\n").find("to the side") != std::string::npos);
  CHECK(refusal("IRzzzS1P\nILzzzzS1P\n").find("to the front") != std::string::npos);
  CHECK(refusal("ICV1752241000000003CBRNS1EDQaFNSE-\n").find("meaning is not known") != std::string::npos);
  CHECK(refusal("ICV1752241000000003CBRNS1EDB1FNSE-\n").find("meaning is not known") != std::string::npos);
  CHECK(talk.driver.state(talk.now_s)["job"] == nullptr);
  CHECK(refusal(right(11700) + "ICV1752241000000003CBRNS1EDB100FNSE-\n") == "");
  talk.pass(3);
  CHECK(talk.driver.state(talk.now_s)["job"]["ended"] == "done");
  // It ended away from home, and the next move begins there.
  CHECK_THAT(talk.driver.state(talk.now_s)["machine_mm"][0].get<double>(), WithinAbs(11800 * 0.0254, 1e-9));
}

}  // namespace
}  // namespace formwright
