// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Shared by booleans*.cpp alone: it drags in CGAL.
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>

#include <array>
#include <vector>

#include "geometry/booleans/booleans.h"

namespace formwright {

using ExactKernel = CGAL::Exact_predicates_exact_constructions_kernel;
using ExactPoint = ExactKernel::Point_3;

/// Triangles over exact points, as in TriangleMesh.
struct ExactSolid::Surface {
  std::vector<ExactPoint> points;
  std::vector<std::array<int, 3>> faces;
};

using ExactSurface = ExactSolid::Surface;

ExactSurface exact_surface(const TriangleMesh& mesh);
/// Each coordinate through its exact value, so that every platform rounds to the same bits.
TriangleMesh rounded(const ExactSurface& surface);

/// Drops points without a face, and gives every fan of faces around a point one of its own: a manifold where every edge
/// has two faces.
void separate_fans(ExactSurface& surface);

/// The part of a surface on one side of a plane, without a cap; faces that lie in the plane go.
ExactSurface clipped(const ExactSurface& surface, int axis, double offset_mm, bool upper, const Context& context);

/// Edges without a neighbour, in the direction of their faces.
std::vector<std::array<int, 2>> border_edges(const ExactSurface& surface);

/// No edge has more than two faces.
bool edges_manifold(const ExactSurface& surface);

/// Triangles that fill what `edges`, closed loops in the plane of `axis`, enclose (odd nesting); they face along +axis.
/// Throws Error{could_not_solve} where loops cross.
std::vector<std::array<int, 3>> planar_filling(const std::vector<ExactPoint>& points,
                                               const std::vector<std::array<int, 2>>& edges, int axis);

/// Throws Error{invalid_input, where} if faces with a corner above `height_mm` meet where they should not, unless they
/// belong to different parts: then returns true.
bool parts_overlap(const TriangleMesh& mesh, double height_mm, std::string_view where, Context& context);

}  // namespace formwright
