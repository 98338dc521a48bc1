// SPDX-License-Identifier: GPL-3.0-or-later
// Vectors were made with MeerK40t 0.9.9 (its checksum, distances and scrambling), which shares no code with ours.
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <algorithm>
#include <deque>

#include "base/error.h"
#include "base/random.h"
#include "machines/k40/k40_driver.h"
#include "machines/notes_of.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

std::string padded(std::string letters) {
  letters.resize(30, 'F');
  return letters;
}

TEST_CASE("K40.ChecksumsAreOneWire") {
  CHECK(one_wire_crc(padded("IPP")) == 228);
  CHECK(one_wire_crc(padded("IS2P")) == 15);
  CHECK(one_wire_crc(padded("I")) == 130);
  CHECK(one_wire_crc(padded("PN")) == 243);
  CHECK(one_wire_crc(padded("IBzzaRl052S1P")) == 250);
}

TEST_CASE("K40.TransfersAreExact") {
  const Bytes transfer = k40_transfer("IPP");
  REQUIRE(transfer.size() == 34u);
  CHECK(transfer[0] == std::byte{0xa6});
  CHECK(transfer[1] == std::byte{0});
  CHECK(as_text(transfer).substr(2, 30) == padded("IPP"));
  CHECK(transfer[32] == std::byte{0xa6});
  CHECK(transfer[33] == std::byte{228});
}

TEST_CASE("K40.MovesAreWrittenInItsLetters") {
  CHECK(k40_rapid_move(1, 0) == "IBaS1P");
  CHECK(k40_rapid_move(25, -26) == "IByL|aS1P");
  CHECK(k40_rapid_move(-51, 52) == "IT|zR052S1P");
  CHECK(k40_rapid_move(1000, 300) == "IBzzz235Rz|tS1P");
  CHECK(k40_rapid_move(-254, 255) == "IT254RzS1P");
}

TEST_CASE("K40.ReadsEgvFiles") {
  const auto packets = k40_packets(
      "Document type : LHYMICRO-GL file\nFile version: 1.0.01\nCreator-Software: X\n\n%0%0%0%0%IBzzzS1P\nICV1752241000000003GAACBaRaFNSE-\n");
  REQUIRE(packets.size() == 3u);
  CHECK(packets[0] == "IBzzzS1P");
  CHECK(packets[1] == "ICV1752241000000003GAACBaRaFNS");
  CHECK(packets[2] == "E");
  CHECK_THROWS_AS(k40_packets("G1 X5\n"), Error);
  CHECK_THROWS_AS(k40_packets(""), Error);
}

/// The board's side: judges every transfer, is busy now and then, and hears badly.
class VirtualBoard {
 public:
  VirtualBoard(std::uint64_t seed, double spoil) : random_(seed), spoil_(spoil) {}
  /// The answer to a status question, nothing for packets.
  Bytes transfer(ByteView bytes) {
    if (bytes.size() == 1 && bytes[0] == std::byte{0xa0}) {
      int status = status_;
      if (busy_ > 0) status = 238, --busy_;
      else if (finished_in_ > 0 && --finished_in_ == 0) status = status_ = 236;
      return {std::byte{255}, static_cast<std::byte>(status), std::byte{0}, std::byte{0}, std::byte{0}, std::byte{1}};
    }
    CHECK(bytes.size() == 34u);
    CHECK(bytes[0] == std::byte{0xa6});
    CHECK(bytes[32] == std::byte{0xa6});
    std::string letters(as_text(bytes).substr(2, 30));
    if (random_.uniform() < spoil_ || spoil_next > 0) letters[random_.below(30)] ^= 1, ++spoiled;
    if (spoil_next > 0) --spoil_next;
    if (one_wire_crc(letters) != std::to_integer<unsigned char>(bytes[33])) {
      status_ = 207;
      return {};
    }
    status_ = 206;
    heard.push_back(letters);
    if (letters.find("FNSE") != std::string::npos) finished_in_ = 5;
    if (random_.uniform() < 0.3) busy_ = 3;
    return {};
  }
  std::vector<std::string> heard;
  int spoil_next = 0, spoiled = 0;  // packets

 private:
  Random random_;
  double spoil_;
  int status_ = 206, busy_ = 0, finished_in_ = 0;
};

/// A packet's worth of letters that differ and move nothing: the laser on and off as the number's bits.
std::string letters_of(int number) {
  std::string letters;
  for (int bit = 0; bit < 30; ++bit) letters += (number >> bit) & 1 ? 'D' : 'U';
  return letters;
}

struct K40Talk {
  explicit K40Talk(std::uint64_t seed = 1, double spoil = 0)
      : board(seed, spoil), driver({.controller = DriverController::k40, .bed_x_mm = 300, .bed_y_mm = 200}) {
    driver.opened(0);
  }
  void pass(double seconds) {
    for (const double end = now_s + seconds; now_s < end; now_s += 0.01) {
      for (const Bytes& packet : driver.take_output())
        if (const Bytes answer = board.transfer(packet); !answer.empty()) driver.received(answer, now_s);
      driver.tick(now_s);
    }
  }
  void start_job() {
    pass(1);
    driver.command({{"do", "home"}, {"confirmed", true}}, now_s);
    pass(3);
    driver.load("job.egv", as_bytes(std::string(30 * 500, 'B')));
    driver.command({{"do", "start"}, {"confirmed", true}}, now_s);
    pass(0.3);
  }
  std::string phase() const { return driver.state(now_s)["phase"]; }

  VirtualBoard board;
  K40Driver driver;
  double now_s = 0;
};

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
