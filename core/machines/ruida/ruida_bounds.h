// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How far a Ruida job (.rd) reaches, read from its own moves. Command numbers as MeerK40t's rdjob.py names them.
#include "base/bytes.h"
#include "machines/gcode/gcode_motion.h"

namespace formwright {

/// In mm from the machine's zero; z is 0.
struct RuidaBounds {
  GcodeBounds worked;   // of all that is burned
  GcodeBounds reached;  // of every place that the file sends the head to
};

/// Throws Error invalid_input ("job") where the file is no Ruida job, is cut off, burns nothing, or does not say where:
/// it starts from a place that is set at the laser's panel, repeats itself as an array, or moves by commands whose
/// place is not in the file.
RuidaBounds ruida_job_bounds(ByteView rd_file);
/// Of all that is burned.
inline GcodeBounds ruida_bounds(ByteView rd_file) { return ruida_job_bounds(rd_file).worked; }

}  // namespace formwright
