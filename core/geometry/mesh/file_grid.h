// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Solids that stay closed in files whose numbers have 32 bits.
#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

/// Moved to a grid on which files with float32 numbers hold every place exactly, also relative to another place of the
/// grid: nothing merges only when it is written. What becomes a line or a point goes. A finer grid where places of
/// different parts meet; the mesh itself where no grid keeps it closed.
TriangleMesh on_file_grid(const TriangleMesh& mesh);

}  // namespace formwright
