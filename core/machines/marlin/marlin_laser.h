// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How Marlin turns a laser or spindle on and off, read from its sources (gcode/control/M3-M5.cpp,
// feature/spindle_laser.h, module/stepper.cpp of 2.1):
//
//   standard    M3 S, M4 S: on at once, on every move and at rest, until M5.
//   continuous  M3 I: the power of every G1 travels with it, G0 is dark; at rest the last power stays on.
//   dynamic     M4 I: the same, but dark whenever no move is under way.
//
// "M5" ends the standard mode and leaves an inline one with its last power, "M5 I" ends the inline ones. Versions
// before 2.1 know no I (or, built with LASER_POWER_INLINE, another one): what they take "M4 I" for is "M4" at the power
// they start with, unless the line says S0.
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/data/json.h"
#include "machines/driver/driver_options.h"
#include "machines/gcode/gcode_program.h"

namespace formwright {

enum class MarlinPower { off, standard, continuous, dynamic };
MarlinPower marlin_power_after(std::string_view line, MarlinPower before);
/// The mode that the program's lines before `index` leave.
MarlinPower marlin_power_before(const GcodeProgram& program, int index);

/// What a program makes use of anywhere.
struct MarlinLaserUse {
  bool standard = false, continuous = false, dynamic = false, fan = false;
};
MarlinLaserUse marlin_laser_use(const GcodeProgram& program);

/// May the line, or what follows it, shine?
bool marlin_may_light(std::string_view line);
/// "M4 I" as "M4 I S0", so that no version starts with a power of its own; other lines as they are.
std::string marlin_line_as_sent(std::string_view line);
/// Major and minor, where the firmware says them: {2, 1} of "Marlin 2.1.2" and "Marlin bugfix-2.1.x".
std::optional<std::pair<int, int>> marlin_version(std::string_view firmware);

/// docs/machines.md, "State". `firmware`: as M115 tells it.
std::string marlin_when_connection_ends(MachineTool tool, const MarlinLaserUse& use, const std::string& firmware);
Json marlin_warnings(const MarlinLaserUse& use, const std::string& firmware, bool m5_unknown);

}  // namespace formwright
