// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How far a K40's job reaches, read from the letters that its board gets (LHYMICRO-GL), as MeerK40t's
// lihuiyu/parser.py reads them.
#include <array>
#include <string>
#include <vector>

#include "machines/gcode/gcode_motion.h"

namespace formwright {

/// The board counts in thousandths of an inch.
inline constexpr double mm_per_mil = 0.0254;

/// In mm from where the job begins, which is home, the bed's upper left corner: x to the right, y towards the front;
/// z is 0.
struct EgvBounds {
  GcodeBounds worked;   // of all that is burned; may be empty
  GcodeBounds reached;  // of every place that the head goes to, the first and the last among them
  std::array<double, 2> end_mm{};
};

/// `packets` as k40_packets cuts them. Throws Error invalid_input ("job") where a letter's meaning is not known, so
/// that nobody can say where the job goes.
EgvBounds egv_bounds(const std::vector<std::string>& packets);

}  // namespace formwright
