// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// G-code in GRBL's and Marlin's dialects, as docs/fabrication.md says.
#include "fabrication/laser_options.h"
#include "fabrication/toolpath.h"

namespace formwright {

/// A laser's job. Every position is absolute with three decimals and the path's points are whole micrometres: nothing
/// adds up. Fills the moves' `lines`. Power is 0 on every travel, said again on the first line of every path. Lines are
/// at most 80 bytes long.
Bytes write_laser_gcode(Toolpath& path, const LaserMachineOptions& machine);

/// A mill's job: the spindle on, coordinates in all three axes, feeds per move. Once move `tool_change` (0: none) has
/// lifted the tool over the stock, the spindle stops and the job waits (M0).
Bytes write_mill_gcode(Toolpath& path, const MachineOptions& machine, double spindle_rpm, std::size_t tool_change);

int line_count(ByteView text);

}  // namespace formwright
