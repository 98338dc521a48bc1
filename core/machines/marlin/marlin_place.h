// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Where the head of a Marlin machine is known to be, axis by axis: from the lines it was sent and the places it
// reported.
#include <array>
#include <optional>
#include <string>
#include <string_view>

namespace formwright {

class MarlinPlace {
 public:
  /// A line is about to leave.
  void sending(std::string_view line);
  /// The G28 that was sent last has ended.
  void homed();
  /// The machine reported its place, in work coordinates.
  void reported(const std::array<double, 3>& mm);
  /// The head's place is to become 0 on these axes ("XY"): a line that says so follows.
  void expect_origin(std::string_view axes);
  void lose() { known_ = {}, origin_mm_ = {}, origin_expected_ = false; }
  void forget() { *this = MarlinPlace(); }

  const std::array<bool, 3>& axes_known() const { return known_; }
  bool known() const { return known_[0] && known_[1]; }
  const std::optional<std::array<double, 3>>& position_mm() const { return position_mm_; }
  /// Where work's zero lies in the coordinates of the homed machine; none where it was not homed, or the origin was set
  /// at a place that it had not reported.
  std::optional<double> origin_mm(std::size_t axis) const { return origin_mm_[axis]; }

  /// "Soft endstops: On  Min: X0.00 Y0.00 Z0.00  Max: X200.00 Y200.00 Z200.00" (M211), or none.
  struct Limits {
    std::array<double, 2> low_mm{}, high_mm{};
  };
  static std::optional<Limits> limits_in(const std::string& line);

 private:
  void set_place(std::string_view line);

  std::array<bool, 3> known_{}, homing_{};
  std::array<std::optional<double>, 3> origin_mm_;
  std::optional<std::array<double, 3>> position_mm_, reported_mm_;
  bool fresh_ = false;            // nothing that moves was sent since reported_mm_
  bool origin_expected_ = false;  // position_mm_ is ahead of what the machine tells
};

}  // namespace formwright
