// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// G-code in GRBL's and Marlin's dialects, as docs/fabrication.md says.
#include "fabrication/laser/laser_options.h"
#include "fabrication/toolpath/toolpath.h"

namespace formwright {

/// A laser's job: dark to where the first path begins, whose x and y are named even where they are 0, and dark at its
/// end. Every position is absolute with three decimals and the path's points are whole micrometres: nothing adds up.
/// Fills the moves' `lines`. Power is 0 on every travel, said again on the first line of every path. Lines are at most
/// 80 bytes long.
Bytes write_laser_gcode(Toolpath& path, const LaserMachineOptions& machine);

/// A mill's job: up to the first height of travel and over to where it begins with the spindle at rest, then with it
/// on; coordinates in all three axes, feeds per move. Of a path in stages only `stage`, which is an index.
Bytes write_mill_gcode(Toolpath& path, const MachineOptions& machine, double spindle_rpm, std::size_t stage = 0);

int line_count(ByteView text);

}  // namespace formwright
