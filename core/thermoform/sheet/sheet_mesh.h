// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The flat sheet in the clamp's opening, as a grid of triangles.
#include <vector>

#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

struct SheetMesh {
  TextureCoordinates flat_mm;  // n x 2, centred on the opening
  Triangles F;                 // counter-clockwise seen from above
  std::vector<char> clamped;   // n: on the rim
  int columns = 0, rows = 0;   // of vertices
};

/// Squares cut along diagonals that alternate like a chessboard's fields, so that the mesh has all the symmetries of
/// the opening: with an even number of cells each way, mirroring it in x or y, and for a square opening turning it by
/// 90 degrees, maps triangles to triangles. About `triangles` of them, at least 8.
SheetMesh make_sheet_mesh(const Vec2& opening_mm, int triangles);

}  // namespace formwright
