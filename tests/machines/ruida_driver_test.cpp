// SPDX-License-Identifier: GPL-3.0-or-later
// Vectors were made with MeerK40t 0.9.9 (its checksum, distances and scrambling), which shares no code with ours.
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include "base/error.h"
#include "base/random.h"
#include "machines/ruida/ruida_driver.h"
#include "machines/notes_of.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

TEST_CASE("Ruida.ScramblesAndSums") {
  const unsigned char plain[] = {0xda, 0, 5, 0x7e, 0xcc, 0xd8, 1, 0x2a},
                      swizzled[] = {0xd4, 0x89, 0x0d, 0xf7, 0xc6, 0xd2, 0x09, 0xa3};
  for (std::size_t i = 0; i < 8; ++i) {
    CHECK(ruida_swizzled(plain[i]) == swizzled[i]);
    CHECK(ruida_unswizzled(swizzled[i]) == plain[i]);
  }
  for (int b = 0; b < 256; ++b) CHECK(ruida_unswizzled(ruida_swizzled(static_cast<unsigned char>(b))) == b);
  const Bytes datagram = ruida_datagram("\xd8\x01");
  CHECK(datagram == Bytes{std::byte{0}, std::byte{0xdb}, std::byte{0xd2}, std::byte{0x09}});
}

TEST_CASE("Ruida.CutsFilesBetweenCommands") {
  Random random(3);
  Bytes file;
  std::string plain;
  for (int i = 0; i < 2000; ++i) {
    plain += static_cast<char>(0x80 + random.below(100));
    for (std::size_t k = random.below(12); k > 0; --k) plain += static_cast<char>(random.below(128));
  }
  for (const char c : plain) file.push_back(std::byte{ruida_swizzled(static_cast<unsigned char>(c))});
  std::string back;
  for (const Bytes& datagram : ruida_datagrams(file)) {
    CHECK(datagram.size() <= 1470u);
    unsigned sum = 0;
    for (std::size_t i = 2; i < datagram.size(); ++i) sum += std::to_integer<unsigned>(datagram[i]);
    CHECK((sum & 0xffff) == (std::to_integer<unsigned>(datagram[0]) << 8 | std::to_integer<unsigned>(datagram[1])));
    CHECK(ruida_unswizzled(std::to_integer<unsigned char>(datagram[2])) >= 0x80);
    for (std::size_t i = 2; i < datagram.size(); ++i)
      back += static_cast<char>(ruida_unswizzled(std::to_integer<unsigned char>(datagram[i])));
  }
  CHECK(back == plain);
  CHECK_THROWS_AS(ruida_datagrams(as_bytes("G1 X5\n")), Error);
}

/// The controller's side, which loses datagrams.
class VirtualRuida {
 public:
  VirtualRuida(std::uint64_t seed, double lose) : random_(seed), lose_(lose) {}
  std::vector<Bytes> receive(ByteView datagram) {
    std::string plain;
    for (const std::byte byte : datagram.subspan(2))
      plain += static_cast<char>(ruida_unswizzled(std::to_integer<unsigned char>(byte)));
    stops += plain == "\xd8\x01";
    if (random_.uniform() < lose_) return {};
    if (lose_next > 0) {
      --lose_next;
      return {};
    }
    if (refuses) return {Bytes{std::byte{ruida_swizzled(0xcf)}}};
    std::vector<Bytes> replies;
    if (plain == last_) replies = last_replies_;  // a repetition of what had arrived
    else {
      replies.push_back({std::byte{0xc6}});
      if (plain[0] == '\xda') {
        std::string reply = std::string("\xda\x01") + plain.substr(2, 2);
        const std::int64_t value = plain[2] == 4 && plain[3] == 0 ? 0 : 123456;
        for (int shift = 28; shift >= 0; shift -= 7) reply += static_cast<char>(value >> shift & 0x7f);
        Bytes bytes;
        for (const char c : reply) bytes.push_back(std::byte{ruida_swizzled(static_cast<unsigned char>(c))});
        replies.push_back(bytes);
      } else {
        heard += plain;
      }
    }
    last_ = plain[0] == '\xda' ? "" : plain;
    last_replies_ = replies;
    if (random_.uniform() < lose_) return {};
    return replies;
  }
  std::string heard;
  int lose_next = 0, stops = 0;  // datagrams; those that are lost count as well
  bool refuses = false;

 private:
  Random random_;
  double lose_;
  std::string last_;
  std::vector<Bytes> last_replies_;
};

struct RuidaTalk {
  explicit RuidaTalk(double lose = 0) : laser(1, lose), driver({.controller = DriverController::ruida}) {
    driver.opened(0);
  }
  void pass(double seconds) {
    for (const double end = now_s + seconds; now_s < end; now_s += 0.01) {
      for (const Bytes& packet : driver.take_output())
        for (const Bytes& reply : laser.receive(packet)) driver.received(reply, now_s);
      driver.tick(now_s);
    }
  }
  std::string phase() const { return driver.state(now_s)["phase"]; }

  VirtualRuida laser;
  RuidaDriver driver;
  double now_s = 0;
};

TEST_CASE("Ruida.JobsArriveInOrderOverALossyNetwork") {
  RuidaTalk talk(0.1);
  talk.pass(5);
  CHECK(talk.driver.state(talk.now_s)["connection"] == "ready");
  CHECK_THAT(talk.driver.state(talk.now_s)["machine_mm"][0].get<double>(), WithinAbs(123.456, 1e-9));
  Bytes file;
  std::string plain;
  plain += "\xd8\x10";
  for (int i = 0; i < 900; ++i) {
    plain += i % 2 ? '\xa8' : '\x88';
    for (const int um : {100 * i, 50 * i})
      for (int shift = 28; shift >= 0; shift -= 7) plain += static_cast<char>(um >> shift & 0x7f);
  }
  for (const char c : plain) file.push_back(std::byte{ruida_swizzled(static_cast<unsigned char>(c))});
  talk.driver.load("job.rd", file);
  CHECK_THROWS_AS(talk.driver.command({{"do", "start"}, {"confirmed", true}}, talk.now_s), Error);
  talk.driver.command({{"do", "home"}, {"confirmed", true}}, talk.now_s);
  talk.pass(15);
  {
    INFO(talk.driver.state(talk.now_s).dump());
    REQUIRE(talk.driver.state(talk.now_s)["position_known"]);
  }
  talk.laser.heard.clear();
  talk.driver.command({{"do", "start"}, {"confirmed", true}}, talk.now_s);
  talk.pass(40);
  {
    INFO(talk.driver.state(talk.now_s).dump());
    CHECK(talk.driver.state(talk.now_s)["job"]["ended"] == "done");
  }
  CHECK(talk.laser.heard == plain);
}

TEST_CASE("Ruida.AJobThatLeavesTheBedIsRefusedAtItsStart") {
  RuidaTalk talk;
  talk.pass(2);
  talk.driver.command({{"do", "home"}, {"confirmed", true}}, talk.now_s);
  talk.pass(15);
  REQUIRE(talk.driver.state(talk.now_s)["position_known"]);
  const auto refusal = [&](const char* head, std::vector<std::array<int, 3>> moves) -> std::string {
    std::string plain = head;
    for (const auto& [code, x_um, y_um] : moves) {
      plain += static_cast<char>(code);
      for (const int um : {x_um, y_um})
        for (int shift = 28; shift >= 0; shift -= 7) plain += static_cast<char>(um >> shift & 0x7f);
    }
    Bytes file;
    for (const char c : plain) file.push_back(std::byte{ruida_swizzled(static_cast<unsigned char>(c))});
    try {
      talk.driver.load("job.rd", file);
      talk.driver.command({{"do", "start"}, {"confirmed", true}}, talk.now_s);
    } catch (const Error& error) {
      CHECK(error.where() == "job");
      return error.what();
    }
    return "";
  };
  CHECK(refusal("\xd8\x10", {{0x88, 0, 0}, {0xa8, 400100, 5000}}).find("leave the bed in x") != std::string::npos);
  CHECK(refusal("\xd8\x10", {{0x88, 0, -200}, {0xa8, 5000, 5000}}).find("leave the bed in y") != std::string::npos);
  // Travel counts, too.
  CHECK(refusal("\xd8\x10", {{0x88, 0, 0}, {0xa8, 5000, 5000}, {0x88, 0, 410000}}).find("leave the bed in y") !=
        std::string::npos);
  CHECK(refusal("\xd8\x12", {{0x88, 0, 0}, {0xa8, 5000, 5000}}).find("set at the laser's panel") != std::string::npos);
  CHECK(talk.driver.state(talk.now_s)["job"] == nullptr);
  CHECK(refusal("\xd8\x10", {{0x88, 0, 0}, {0xa8, 400000, 400000}}) == "");
}

TEST_CASE("Ruida.AStopThatIsLostIsSentAgain") {
  RuidaTalk talk;
  talk.pass(2);
  talk.laser.lose_next = 2;
  talk.driver.command({{"do", "stop"}}, talk.now_s);
  talk.pass(0.5);
  CHECK(talk.laser.heard == "");
  CHECK(talk.phase() == "stopping");
  talk.pass(4);
  CHECK(talk.laser.heard == "\xd8\x01");
  CHECK(talk.phase() == "idle");
}

TEST_CASE("Ruida.TheAnswerToWhatWasUnderWayDoesNotConfirmAStop") {
  RuidaDriver driver({.controller = DriverController::ruida});
  const Bytes taken{std::byte{ruida_swizzled(0xcc)}}, stop = ruida_datagram("\xd8\x01");
  driver.opened(0);
  driver.take_output();  // a question is under way
  driver.command({{"do", "stop"}}, 0.1);
  CHECK(driver.take_output() == std::vector<Bytes>{stop});
  driver.received(taken, 0.2);
  CHECK(driver.state(0.2)["phase"] == "stopping");
  driver.tick(1.3);
  CHECK(driver.take_output() == std::vector<Bytes>{stop});
  driver.received(taken, 1.4);
  CHECK(driver.state(1.4)["phase"] == "idle");
}

TEST_CASE("Ruida.AStopThatIsRefusedIsSaid") {
  RuidaTalk talk;
  talk.pass(2);
  talk.laser.refuses = true;
  talk.driver.command({{"do", "stop"}}, talk.now_s);
  talk.pass(3);
  CHECK(notes_of(talk.driver).find("refuses to stop") != std::string::npos);
  CHECK(talk.phase() != "stopping");
  const int stops = talk.laser.stops;
  CHECK(stops >= 5);
  CHECK(stops <= 6);  // the first answer may have been to a question
  talk.pass(3);
  CHECK(talk.laser.stops == stops);
}

TEST_CASE("Ruida.AStopThatIsNotAnsweredIsSaid") {
  RuidaTalk talk;
  talk.pass(2);
  talk.laser.lose_next = 1000;
  talk.driver.command({{"do", "stop"}}, talk.now_s);
  talk.pass(8);
  CHECK(talk.laser.stops == 5);
  CHECK(notes_of(talk.driver).find("does not answer the stop") != std::string::npos);
  CHECK(talk.driver.state(talk.now_s)["connection"] == "silent");
}

TEST_CASE("Ruida.SaysSoWhenNothingAnswers") {
  RuidaTalk talk(1);
  talk.pass(10);
  CHECK(talk.driver.state(talk.now_s)["connection"] == "silent");
}

}  // namespace
}  // namespace formwright
