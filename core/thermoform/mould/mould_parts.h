// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A mould cut into parts that a printer takes, with keys that line them up again, laid out on its bed.
#include <array>
#include <string>
#include <vector>

#include "base/context.h"
#include "geometry/booleans/booleans.h"
#include "thermoform/mould/mould_options.h"

namespace formwright {

struct MouldPart {
  TriangleMesh mesh;          // as printed: on z = 0, placed on the bed beside the others
  std::array<int, 3> cell{};  // where it belongs: counted along x, y, z of the machine
  int pins = 0, sockets = 0;
  double volume_mm3 = 0;
  Vec3 size_mm = Vec3::Zero();
};

struct MouldParts {
  std::vector<MouldPart> parts;       // by cell: z slowest, x fastest
  std::array<int, 3> cells{1, 1, 1};  // cuts + 1 along each axis
  int keys = 0;
  std::vector<std::string> sentences;
};

/// Cuts `solid` (machine coordinates) into the fewest equal slabs along each axis whose parts, pins included, fit the
/// printer (0: no limit), also turned by 90 degrees on the bed where that saves parts. A negative is printed upside
/// down, its opening upwards. Throws Error: invalid_input with `where` = "printer_x_mm"... (more than 64 parts),
/// could_not_solve, cancelled.
MouldParts split_mould(const ExactSolid& solid, const ThermoformMouldOptions& options, Context& context);

}  // namespace formwright
