// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/k40/egv_bounds.h"

#include <cstdint>

#include "machines/driver/machine_driver.h"

namespace formwright {
namespace {

/// The board as far as its place goes. Outside a program distances add up until N, S or P lets them be gone; within one
/// ("compact") every letter lets those before it be gone.
class Board {
 public:
  void take(char letter) {
    if (letter == 'I') {
      finished_ = compact_ = homes_next_ = false;
      steps_ = {};
    }
    if (finished_) return;  // until the next I
    if (letter >= '0' && letter <= '9') return digit(letter);
    end_of_number();
    if (compact_) go();
    if (letter == '|' || (letter >= 'a' && letter <= 'z')) return distance(letter);
    after_bar_ = false;
    command(letter);
  }
  EgvBounds bounds() {
    end_of_number();
    go();
    bounds_.end_mm = {mm_per_mil * static_cast<double>(at_[0]), mm_per_mil * static_cast<double>(at_[1])};
    return bounds_;
  }

 private:
  enum class Number { distance, mode, raster_step, ignored };

  void digit(char letter) {
    if (number_ != Number::ignored && digits_ >= 3) lost();
    value_ = 10 * value_ + (letter - '0');
    ++digits_;
    if (number_ == Number::distance && digits_ == 3) {
      add(value_);
      value_ = digits_ = 0;
    }
    if (number_ == Number::ignored) value_ = 0;
  }
  void end_of_number() {
    if (number_ == Number::distance && digits_ > 0) lost();
    if (number_ == Number::mode && digits_ > 0) mode_ = value_;
    if (number_ == Number::raster_step && digits_ > 0) raster_step_ = value_;
    number_ = Number::distance;
    value_ = digits_ = 0;
  }
  void expect(Number number) { number_ = number; }

  void distance(char letter) {
    if (letter == '|') add(25);
    else if (letter == 'z') add(after_bar_ ? 26 : 255);
    else add(letter - 'a' + 1);
    after_bar_ = letter == '|';
  }
  void add(std::int64_t steps) {
    if (!on_[0] && !on_[1]) lost();
    for (std::size_t axis = 0; axis < 2; ++axis)
      if (on_[axis]) steps_[axis] += steps;
  }

  void command(char letter) {
    switch (letter) {
      case 'B': return turn(0, false);
      case 'T': return turn(0, true);
      case 'R': return turn(1, false);
      case 'L': return turn(1, true);
      case 'M': on_ = {true, true}; return;
      case 'D': laser_ = true; return;
      case 'U': laser_ = false; return;
      case 'V': raster_step_ = 0; return expect(Number::ignored);
      case 'W': return expect(Number::ignored);
      case 'G': return expect(Number::raster_step);
      case 'C':
      case 'I': return;
      case 'F': ends_ = true, enters_ = false; return;
      case '@': ends_ = enters_ = false; return;
      case 'N':
        go();
        laser_ = compact_ = false;
        return;
      case 'S':
        laser_ = false;
        go();
        mode_ = -1;
        return expect(Number::mode);
      case 'E': return execute();
      case 'P': return halt();
      default: lost();
    }
  }

  /// Rows of a raster are a step apart: the board takes it by itself where the head turns round.
  void turn(std::size_t axis, bool back) {
    const bool rows = horizontal_ == (axis == 0);
    if (back_[axis] != back && rows && compact_) steps_[1 - axis] += raster_step_;
    back_[axis] = back;
    on_ = {axis == 0, axis == 1};
  }
  void execute() {
    if (mode_ < 0) {
      compact_ = compact_ || enters_;
      finished_ = ends_;
      const std::size_t axis = horizontal_ ? 0 : 1;
      back_[axis] = !back_[axis];
      on_ = {axis == 0, axis == 1};
    } else if (mode_ > 0) {
      compact_ = true;
      if (mode_ == 1) horizontal_ = on_[0];
    }
    ends_ = false;
    enters_ = true;
    laser_ = false;
  }
  /// The second P in a row sends the head home.
  void halt() {
    laser_ = false;
    if (homes_next_) {
      at_ = {};
      steps_ = {};
      finished_ = true;
      see(bounds_.reached);
    } else go();
    homes_next_ = !homes_next_;
  }

  void go() {
    if (steps_[0] == 0 && steps_[1] == 0) return;
    const bool burns = compact_ && laser_;
    if (burns) see(bounds_.worked);
    see(bounds_.reached);
    for (std::size_t axis = 0; axis < 2; ++axis) at_[axis] += back_[axis] ? -steps_[axis] : steps_[axis];
    steps_ = {};
    if (burns) see(bounds_.worked);
    see(bounds_.reached);
  }
  void see(GcodeBounds& bounds) const {
    bounds.add({mm_per_mil * static_cast<double>(at_[0]), mm_per_mil * static_cast<double>(at_[1]), 0});
  }
  [[noreturn]] static void lost() {
    machines_detail::refuse("job",
                            "The job has letters whose meaning is not known here, so how far it reaches cannot be "
                            "found: make it again for this controller (EGV for an M2 Nano).");
  }

  EgvBounds bounds_;
  std::array<std::int64_t, 2> at_{}, steps_{};  // steps: right, front
  std::array<bool, 2> back_{}, on_{};
  bool laser_ = false, compact_ = false, finished_ = false, homes_next_ = false, after_bar_ = false;
  bool ends_ = false, enters_ = true;  // what the next E without a mode does
  bool horizontal_ = false;
  Number number_ = Number::distance;
  int digits_ = 0;
  std::int64_t value_ = 0, mode_ = -1, raster_step_ = 0;
};

}  // namespace

EgvBounds egv_bounds(const std::vector<std::string>& packets) {
  Board board;
  for (const std::string& packet : packets)
    for (const char letter : packet) board.take(letter);
  return board.bounds();
}

}  // namespace formwright
