// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Fewer vertices, the same shape: edge collapse by quadric error. Garland & Heckbert 1997; Trettner &
// Kobbelt 2020 (probabilistic quadrics); Lindstrom & Turk 1998 (boundary terms). Triangles stay well
// shaped, because cotangent Laplacians follow.
#include <tuple>
#include <vector>

#include "base/context.h"
#include "base/data/parameters.h"
#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

struct SimplifyOptions {
  int target_vertices = 10000;
  bool drop_small_parts = false;

  static constexpr auto parameters =
      std::tuple{parameter("target_vertices", &SimplifyOptions::target_vertices, "Vertices", unit::none, 4, 10000000,
                           "Approximate number of vertices to keep. Fewer load and solve faster and lose fine detail.")
                     .slider(1000, 100000),
                 parameter("drop_small_parts", &SimplifyOptions::drop_small_parts, "Drop small parts",
                           "Leaves out separate parts that are smaller than one triangle of the result.")
                     .advanced()};
};

/// At most target_vertices vertices, or as few as the topology allows: the Euler characteristic, the
/// boundary loops and (unless small ones are dropped) the parts stay. Survivors keep their order. A mesh
/// that is small enough comes back as it is. Deterministic.
/// `new_vertex_of`, when given, gets for every old vertex the new one into which it went, -1 if none.
/// Needs a manifold mesh with faces oriented alike (see repair.h).
/// Throws Error: invalid_input ("mesh", "target_vertices"), cancelled.
TriangleMesh simplify(const TriangleMesh& mesh, const SimplifyOptions& options, Context& context,
                      std::vector<int>* new_vertex_of = nullptr);

}  // namespace formwright
