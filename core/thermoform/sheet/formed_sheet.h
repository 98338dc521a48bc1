// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What the simulation hands to printing, mould making and comparison.
#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

/// The formed sheet within the clamp opening: its middle surface in machine coordinates (placement.h). Faces are
/// counter-clockwise seen from outside, the side away from the model; the same faces over `sheet_mm` tile the opening.
struct FormedSheet {
  TriangleMesh mesh;  // n vertices, mm
  TextureCoordinates
      sheet_mm;  // n x 2: where each vertex was on the flat sheet, centred on it, x and y as the machine's
  Eigen::VectorXd thickness_mm;  // n
  Eigen::VectorXd stretch;       // n: area now over area then
  Eigen::VectorXd
      contact_s;  // n: when the vertex touched, counted from the start; -1 where it never did; 0 in the clamp
};

}  // namespace formwright
