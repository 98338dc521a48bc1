// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The relief as a height field over its plate: what a mill carves, and the solid a printer prints.
#include <vector>

#include "base/context.h"
#include "relief/base/base_surface.h"
#include "relief/view/view_frame.h"

namespace formwright {

/// Heights over the plane of the plate's front at the nodes of a regular grid; node (0, 0) is the lower left corner.
struct HeightMap {
  int columns = 0, rows = 0;
  double pitch_x_mm = 0, pitch_y_mm = 0;  // the grid spans the plate exactly
  std::vector<float> height_mm;           // rows * columns, row 0 at the bottom; 0 on a bare flat plate
  double floor_mm = 0, top_mm = 0;        // the least and largest height that the base and its bounds allow anywhere

  double width_mm() const { return pitch_x_mm * (columns - 1); }
  double depth_mm() const { return pitch_y_mm * (rows - 1); }
  float& at(int row, int column) {
    return height_mm[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                     static_cast<std::size_t>(column)];
  }
  float at(int row, int column) const {
    return height_mm[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                     static_cast<std::size_t>(column)];
  }
};

struct PlateSize {
  double width_mm, height_mm;
};

/// Upper envelope of the moved mesh above the plate (z < 0), seen straight down on the plate, at every node.
/// `moved` is in view coordinates; `size_mm` per normalised unit. Vertices within a millionth of `top_mm` of the
/// top also raise their nearest node, so that the thickness asked for is reached exactly.
/// Throws Error{invalid_input, "pixel_mm"} for a grid over 64 million nodes.
HeightMap make_height_map(const Positions& moved, const Triangles& F, double size_mm, PlateSize plate, double pixel_mm,
                          double top_mm, Context& context);

/// Where a relief may be: from `above_mm` before its base to `below_mm` behind it, along the plate's normal; on strips
/// along the normal of the strip.
struct AllowedSpace {
  const BaseSurface& base;
  double above_mm, below_mm;
};

/// The mesh over any base, for the functions below.
struct CoveringMesh {
  const Positions& V;  // view coordinates
  const Triangles& F;
  const std::vector<int>* band = nullptr;  // of each triangle, which covers nodes of this band only; null: all
  // Of each vertex, mm, how far it may be before the base and behind it, within the allowed space; null: as far as
  // that.
  const Eigen::VectorXd *above_mm = nullptr, *below_mm = nullptr;
};

/// The same over any base: the envelope where the mesh covers a node, kept within the allowed space there, and the
/// base elsewhere. Nodes that the base does not reach are on the floor.
HeightMap make_height_map(const CoveringMesh& mesh, double size_mm, PlateSize plate, double pixel_mm,
                          const AllowedSpace& space, Context& context);

/// The base alone, as deep as the relief may be carved where the mesh covers it: what a picture shows behind the mesh.
HeightMap make_bed_map(const CoveringMesh& mesh, double size_mm, PlateSize plate, double pixel_mm,
                       const AllowedSpace& space, Context& context);

/// A watertight solid: the height field on a plate `plate_mm` thick below its floor, x right, y up, z towards the
/// viewer, lower left corner of the plate's back at the origin. Flat and smooth parts are covered by larger triangles:
/// a right-triangulated irregular network (Evans, Kirkpatrick, Townsend 2001) within `tolerance_mm` of every node.
TriangleMesh make_solid(const HeightMap& map, double plate_mm, double tolerance_mm, Context& context);

}  // namespace formwright
