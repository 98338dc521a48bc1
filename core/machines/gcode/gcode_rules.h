// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a controller must be able to do with a whole program, found before its first line is sent.
#include <array>
#include <optional>

#include "machines/gcode/gcode_program.h"

namespace formwright {

enum class GcodeDialect {
  grbl,            // GRBL 1.1 and what speaks like it: what it answers with an error, grblHAL with few exceptions, too
  marlin,          // a laser or mill on Marlin: a line that it does not know it leaves out, and goes on with the next
  marlin_printer,  // a printer's own jobs home it and use all that its firmware knows
};

struct GcodeRules {
  GcodeDialect dialect = GcodeDialect::grbl;
  bool mist = true;  // does the board take M7? GRBL tells by the letter M in [OPT:...]
};

/// Throws Error invalid_input ("job") naming the first line that the controller would refuse, leave out or take
/// otherwise than RS274 says, or whose path is unknown, and what to do. Printers' jobs pass.
void require_runnable(const GcodeProgram& program, const GcodeRules& rules);

/// Throws Error invalid_input ("job") naming the first line whose path is unknown.
void require_clear_path(const GcodeProgram& program);

/// How far a program reaches that counts from where the head stands is known only when that is the origin. `index`: of
/// the line it starts with; `head_mm`: in work coordinates. Throws Error invalid_input ("start").
void require_head_at_origin(const GcodeProgram& program, int index,
                            const std::optional<std::array<double, 3>>& head_mm);

/// Against the travel of z: its length, and where `lowest_mm` (in work coordinates) is known the place, too. Throws
/// Error invalid_input ("job").
void require_z_reach(const GcodeBounds& bounds, double travel_mm, std::optional<double> lowest_mm);

}  // namespace formwright
