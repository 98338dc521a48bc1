// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// RD: what Ruida controllers run (RDC644x family), in micrometres, swizzled with their usual key.
#include "fabrication/laser/laser_options.h"
#include "fabrication/toolpath/toolpath.h"

namespace formwright {

/// Every change of power or speed is a layer of the file, at most 128. Minimum and maximum power are the same.
/// Positions in the controller's coordinates (`machine.origin`): whole micrometres, absolute where a path begins, so
/// that nothing adds up. Throws Error{invalid_input, "controller"} for more layers.
Bytes write_ruida(const Toolpath& path, const LaserMachineOptions& machine);

/// As bytes go over the wire and lie in files, and back.
std::byte swizzled(std::byte plain);
std::byte unswizzled(std::byte wire);

}  // namespace formwright
