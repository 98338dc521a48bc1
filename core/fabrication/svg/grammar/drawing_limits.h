// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What one drawing may take of memory and time, counted where it is taken: a reader of strangers' files keeps within
// 200 times the file's size plus 64 MB, and its time grows with the file's size.
#include <cstddef>
#include <cstdint>
#include <string>

#include "base/context.h"

namespace formwright {

inline constexpr double max_coordinate_mm = 1e6;  // of anything in a drawing, drawn, hidden or clipped away
inline constexpr double max_reach_mm = 20'000;    // of what is drawn
inline constexpr int max_nested_elements = 256;

/// Throws Error{invalid_input, "drawing"}.
[[noreturn]] void refuse_drawing(const std::string& message);

/// Every count throws Error{invalid_input, "drawing"} once there is too much of it, and Error{cancelled}.
class DrawingLimits {
 public:
  DrawingLimits(std::size_t input_bytes, const Context& context);

  void add_points(std::size_t count) {
    points_ += count;
    if (points_ > max_points || points_ + path_points * paths_ > max_room_) refuse_points();
  }
  void add_path() {
    ++paths_;
    add_points(0);
  }
  /// One step is about ten nanoseconds: a byte read, an edge or a rule compared.
  void add_steps(std::size_t count) {
    steps_ += count;
    if (steps_ >= next_look_) look();
  }

 private:
  // A point has 16 bytes. A path's own entry, its place on the heap and the room its list grows by take as much as 18.
  static constexpr std::uint64_t max_points = 4'000'000, path_points = 18;

  [[noreturn]] void refuse_points() const;
  void look();

  const Context& context_;
  std::uint64_t max_room_, max_steps_;  // room in points
  std::uint64_t points_ = 0, paths_ = 0, steps_ = 0, next_look_ = 0;
};

}  // namespace formwright
