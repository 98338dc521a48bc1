// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Better shaped triangles on the same surface, after a simplification: edges flipped towards Delaunay and vertices
// moved along the surface towards the middle of their neighbours, in turn (Botsch & Kobbelt 2004, with error quadrics
// in place of a projection).
#include <vector>

#include "base/context.h"
#include "geometry/mesh/collapsible_mesh.h"
#include "geometry/mesh/quadric.h"

namespace formwright {

/// Shape of a triangle, 1 for equilateral, 0 for flat: 4 sqrt(3) area / sum of squared sides; Bank & Smith 1997.
/// `cross` is (b - a) x (c - a).
double triangle_shape(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& cross);

/// What may be done at a vertex.
enum class Freedom : char { none, flip, move };

/// Per vertex: its place, the planes of the faces that went into it, its freedom. An edge flips when all four vertices
/// may; a vertex of the boundary never moves, and none to where its planes are further than `max_error` (in the
/// quadric's measure) unless they were before. Throws Error{cancelled}.
void improve_triangles(CollapsibleMesh& mesh, std::vector<Vec3>& position, const std::vector<Quadric>& quadric,
                       const std::vector<Freedom>& freedom, double max_error, const Context& context);

}  // namespace formwright
