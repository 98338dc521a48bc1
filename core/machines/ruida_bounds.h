// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How far a Ruida job (.rd) reaches, read from its own moves. Command numbers as MeerK40t's rdjob.py names them.
#include "machines/gcode_program.h"

namespace formwright {

/// Of all that is burned, in mm from the machine's zero; z is 0. Throws Error invalid_input ("job") where the file is
/// no Ruida job, is cut off, burns nothing, or does not say where: it starts from a place that is set at the laser's
/// panel, repeats itself as an array, or moves by commands whose place is not in the file.
GcodeBounds ruida_bounds(ByteView rd_file);

}  // namespace formwright
