// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/queries/crossings.h"

#include "geometry/mesh/adjacency.h"
#include "geometry/queries/ray_caster.h"

namespace formwright {

int count_crossings(const TriangleMesh& mesh, std::span<const int> place_of, Context& context) {
  const RayCaster caster(mesh);
  const Adjacency adjacency(mesh);
  const auto place = [&](int vertex) { return place_of.empty() ? vertex : place_of[static_cast<std::size_t>(vertex)]; };
  int count = 0, visited = 0;
  for (const Edge& edge : adjacency.edges()) {
    if (++visited % 256 == 0) context.check_cancelled();
    const Vec3 from = mesh.V.row(edge.lower), along = mesh.V.row(edge.higher).transpose() - from;
    const double length = along.norm();
    if (!(length > 0)) continue;
    for (const RayHit& hit : caster.all_hits(from, along / length, 0, length)) {
      bool apart = true;
      for (int k = 0; k < 3; ++k) {
        const int other = place(mesh.F(hit.face, k));
        apart = apart && other != place(edge.lower) && other != place(edge.higher);
      }
      count += apart;
    }
  }
  return count;
}

}  // namespace formwright
