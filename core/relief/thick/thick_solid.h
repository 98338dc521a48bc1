// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A relief that is no height field (thesis, Fig. 3.10): its surface with a wall, on a plate.
#include "base/context.h"
#include "geometry/mesh/triangle_mesh.h"
#include "relief/height_map.h"

namespace formwright {

struct ThickSolidOptions {
  double size_mm = 100;  // of a normalised length of view coordinates: the relief's width
  PlateSize plate{100, 100};
  double plate_mm = 3;
  double wall_mm = 2;
  double above_mm = 5, below_mm = 0;    // how far the relief may be before the plate's front and behind it
  double pixel_mm = 0.2;                // of the grid of rays that the front is sampled with
  double tolerance_mm = 0.005;          // how far the front's larger triangles may leave its nodes
  int max_front_triangles = 3'000'000;  // 0.6 kB each while the solid is joined and cut
};

struct ThickSolid {
  TriangleMesh mesh;  // mm, lying on its back as make_solid has it; closed
  double volume_mm3 = 0;
  double opening_mm = 0;  // gaps narrower than twice this are filled
  int hollows = 0;        // closed spaces within the solid
  int loose_parts = 0;    // that touch neither the plate nor what is joined to it
};

/// A flat plate joined with every place that is within `wall_mm` of the surface or enclosed by it, cut to what lies
/// behind the surface as seen from the viewpoint. So the picture is that of the surface to `pixel_mm`, nothing stands
/// out farther than the surface does, along every line of sight the wall is at least `wall_mm` thick, and what no line
/// of sight meets first stays open.
///
/// The front is the nearest surface along a grid of rays from the viewpoint. It is sampled straight down after the
/// homography (x, y, z) -> (x, y, z) / (1 + kappa z), which makes the rays parallel and keeps planes planes, and is
/// brought back by its inverse. Then: front solid ∩ (wall ∪ plate), by exact booleans, within the plate's sides.
/// @param moved  view coordinates; what is seen beside the plate is cut off
/// Throws Error: invalid_input ("pixel_mm" as make_height_map and beyond max_front_triangles, "wall_mm" as
/// thick_surface), could_not_solve, cancelled.
ThickSolid thick_solid(const Positions& moved, const Triangles& F, double kappa, const ThickSolidOptions& options,
                       Context& context);

}  // namespace formwright
