// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What lines of G-code do: the modal state that they leave behind, and how far they reach. Meanings are those of
// RS274/NGC as GRBL 1.1 takes them (gnea/grbl, gcode.c and motion_control.c); Marlin's are the same where both have a
// word.
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "machines/gcode/gcode_words.h"

namespace formwright {

/// Modal state (RS274/NGC) that lines leave behind. Lengths in mm, whatever the units of the line.
struct GcodeState {
  bool inches = false, relative = false;
  int plane = 17, work_system = 54;
  int motion = 0;   // G0, G1, G2, G3; 80: none
  int spindle = 5;  // M3, M4, M5
  std::array<double, 3> position_mm{0, 0, 0};
  std::array<bool, 3> moved{};  // has the program said where this axis goes?
  bool from_here = false;       // did it count x or y from where the head stood, before it had said where that is?
  double feed_mm_per_min = 0;
  double power = 0;  // S
  bool mist = false, flood = false;
};

/// Of the places that a program names, in work coordinates.
struct GcodeBounds {
  std::array<double, 3> low_mm{0, 0, 0}, high_mm{0, 0, 0};
  std::array<bool, 3> named{};  // axes that the program moves; low_mm and high_mm of the others are 0
  bool empty = true;            // it names no axis
  void add(std::size_t axis, double place_mm);
  /// On all three axes.
  void add(const std::array<double, 3>& point_mm);
};

struct GcodeReach {
  GcodeBounds bounds;
  bool fires = false;  // is the laser or spindle ever turned on?
};

/// Lets one line act; `reach` may be null. Answers why nobody can say where the line leads, as a sentence's end that
/// names the fix; "" where it is clear. What the line leaves behind is then without meaning.
std::string run_gcode_line(const std::vector<GcodeWord>& words, GcodeState& state, GcodeReach* reach);

/// The axes of a plane: arcs turn from the first towards the second; the third is the helix's.
std::array<std::size_t, 3> axes_of_plane(int plane);

}  // namespace formwright
