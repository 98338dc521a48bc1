// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// EGV: what K40 lasers with an M2 Nano board run (LHYMICRO-GL), in steps of a thousandth of an inch.
#include <string>

#include "fabrication/toolpath/toolpath.h"

namespace formwright {

/// x to the right and y down from the bed's upper left corner, whatever `machine.origin` says: these boards home there.
/// Positions are rounded one by one, so that nothing adds up; straight lines become runs of steps along an axis or a
/// diagonal (Bresenham). The board has no power: the dial on the machine sets it. A change of speed ends one program
/// and begins the next ("FNSE-": wait for the board to be finished before sending on). A header of text lines as the
/// maker's software writes it.
Bytes write_egv(const Toolpath& path, const MachineOptions& machine);

/// "CV..." of an M2 board: the period of its steps in ticks of its clock, with the delay of diagonals. 0.1 to 240 mm/s.
std::string egv_speed_code(double speed_mm_per_s);

}  // namespace formwright
