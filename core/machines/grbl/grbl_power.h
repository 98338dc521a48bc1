// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a job asks of a laser's power, and how it is sent so that a machine left alone goes dark.
//
// With $32=1 and M4 a GRBL laser's power goes with the head's speed and is nothing at rest; with M3 it stays as it is
// when the planner runs dry behind a cut (grbl/doc/markdown/laser_mode.md).
#include <array>
#include <string>
#include <string_view>

#include "machines/gcode/gcode_program.h"

namespace formwright {

struct LaserPower {
  double max_power = 0;    // S
  int max_power_line = 0;  // of the file, the first that asks for it
  bool constant = false;   // is M3 used?
  int rest_line = 0;       // of the file, the first that burns at rest: G4 behind a cut with M3. 0: none
};
LaserPower laser_power_of(const GcodeProgram& program);

/// Of x and y, those that the program moves and has not placed when its first cut begins: it would begin wherever the
/// head stands. Programs that count from there (G91) are another matter: GcodeProgram::from_here.
std::array<bool, 2> unplaced_at_first_cut(const GcodeProgram& program);

/// Of the file, the first line that turns on mist (M7), for which not every board has an output; 0 without one.
int first_mist_line(const GcodeProgram& program);

/// The line with M4 where it says M3: of the same length, with the same path.
std::string with_dynamic_power(std::string_view line);

}  // namespace formwright
