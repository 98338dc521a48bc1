// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/svg/grammar/drawing_limits.h"

#include "base/error.h"

namespace formwright {
namespace {

constexpr std::uint64_t base_room = 1'400'000, room_per_byte = 8;  // in points of 16 bytes
constexpr std::uint64_t base_steps = 50'000'000, steps_per_byte = 100, steps_between_looks = 1'000'000;

}  // namespace

void refuse_drawing(const std::string& message) { throw Error(ErrorCode::invalid_input, "drawing", message); }

DrawingLimits::DrawingLimits(std::size_t input_bytes, const Context& context)
    : context_(context),
      max_room_(base_room + room_per_byte * input_bytes),
      max_steps_(base_steps + steps_per_byte * input_bytes) {}

void DrawingLimits::refuse_points() const {
  if (points_ > max_points)
    refuse_drawing("The drawing has over 4 million points: simplify its curves or split it into several files.");
  refuse_drawing(
      "The drawing becomes far larger than its file: simplify its curves, repeat fewer copies (<use>) or make its dashes longer.");
}

void DrawingLimits::look() {
  context_.check_cancelled();
  if (steps_ > max_steps_)
    refuse_drawing(
        "The drawing repeats, styles or clips too much to be read: save it as plain SVG with fewer copies (<use>), style rules and clips.");
  next_look_ = steps_ + steps_between_looks;
}

}  // namespace formwright
