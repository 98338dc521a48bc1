// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A K40 driver in talk with a board that judges every packet.
#include <catch2/catch_test_macros.hpp>

#include <cstdint>
#include <string>
#include <vector>

#include "base/random.h"
#include "machines/k40/k40_driver.h"

namespace formwright {

inline std::string padded(std::string letters) {
  letters.resize(30, 'F');
  return letters;
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
inline std::string letters_of(int number) {
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

}  // namespace formwright
