// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/queries/search_sphere.h"

#include "base/error.h"
#include "geometry/mesh/measures.h"

namespace formwright {

SearchSphere search_sphere(const TriangleMesh& mesh) {
  if (mesh.face_count() >= (1 << 28))
    throw Error(ErrorCode::invalid_input, "mesh",
                "The mesh has more triangles than can be searched; simplify it first.");
  BoundingBox bounds;
  for (int f = 0; f < mesh.face_count(); ++f)
    for (int k = 0; k < 3; ++k) {
      const int v = mesh.F(f, k);
      if (v < 0 || v >= mesh.vertex_count())
        throw Error(ErrorCode::invalid_input, "mesh",
                    "A triangle names a vertex that does not exist; export the mesh again.");
      if (!mesh.V.row(v).allFinite())
        throw Error(ErrorCode::invalid_input, "mesh", "A corner of a triangle is not a number; export the mesh again.");
      bounds.add(mesh.V.row(v));
    }
  if (mesh.face_count() == 0) return {};
  SearchSphere sphere{bounds.centre(), 0.5 * bounds.diagonal()};
  if (!(sphere.radius < 1e30))
    throw Error(ErrorCode::invalid_input, "mesh", "The mesh is too large for single precision; check its unit.");
  return sphere;
}

}  // namespace formwright
