// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Places on the front of the solid that will be made, at which its light is computed.
#include "relief/height_map.h"
#include "relief/light/irradiance.h"

namespace formwright {

struct LitRelief {
  int columns = 0, rows = 0;  // node (0, 0) is the lower left corner of the plate
  double pitch_x_mm = 0, pitch_y_mm = 0;
  SurfacePoints nodes;  // rows * columns, row by row from the bottom; x right, y up, z towards the viewer

  /// Bilinear between the four nearest nodes of `values` (rows * columns), at a point of the plate; beyond its edge as
  /// at the edge.
  double at(const std::vector<double>& values, double x_mm, double y_mm) const;
};

/// Nodes about `pitch_mm` apart, from edge to edge of a plate whose middle is the origin, each where a ray straight on
/// meets `solid`; at the bottom of its box where none does. Normals are from central differences, but
/// one-sided beside a wall, so that no edge is smeared over the flat parts next to it. `clearance_mm`: see
/// SurfacePoints. Throws Error: invalid_input "light_pixel_mm" for more than a million nodes; cancelled.
LitRelief make_lit_relief(const LitObject& solid, PlateSize plate, double pitch_mm, double clearance_mm,
                          Context& context);

/// Its front as a mesh, two triangles between four nodes.
TriangleMesh front_mesh(const LitRelief& relief);

}  // namespace formwright
