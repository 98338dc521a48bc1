// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// One part of a base with its relief as a watertight solid.
#include "relief/parts/part_front.h"

namespace formwright {

struct PartSolidOptions {
  double size_mm = 1;  // per normalised unit
  double thickness_mm = 0, carve_depth_mm = 0;
  double pixel_mm = 0;
  double plate_mm = 3;      // behind the deepest place of an open part
  double tolerance_mm = 0;  // of heights, for larger triangles
  int number = 0;           // sunk into the back, with a mark that points up; 0: a plain back
};

struct PartSolid {
  TriangleMesh mesh;  // where it belongs: mm, x right, y up, z towards the viewer, the middle of the plate's front at 0
  double volume_mm3 = 0;
  bool numbered = false;  // there was a flat back with room for the number
  bool watertight = false;
};

/// A part where it belongs, as PartSolid::mesh has it, its faces outwards.
TriangleMesh part_in_scene(const BaseParts& parts, int part, double size_mm);

/// A closed part keeps its own sides and back: what stands before it is joined to it and what is carved taken away, by
/// exact booleans. An open one gets a flat back, and sides that lie in the rays past its edge. What is raised or
/// carved by less than 0.02 mm is left as the part has it, and the relief ends 0.01 mm within what is seen.
/// `relief`: as part_front has it. Empty where nothing is seen of the part.
/// Throws Error: invalid_input ("pixel_mm"; "base_mesh": a part that crosses itself), could_not_solve, cancelled.
PartSolid part_solid(const BaseParts& parts, int part, const TriangleMesh& relief, const PartSolidOptions& options,
                     Context& context);

}  // namespace formwright
