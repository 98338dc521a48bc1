// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Intrinsic Delaunay triangulation by edge flips: Bobenko & Springborn 2007; Fisher, Springborn,
// Bobenko, Schroeder 2007. The surface and its vertices stay; the edges become straight lines *within*
// the surface, known by their lengths only.
#include <vector>

#include "base/context.h"
#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

/// Triangles glued along half-edges (h = 3 f + k as in Adjacency). Two vertices may be joined by
/// several edges, and an edge may return to its own vertex.
struct IntrinsicTriangulation {
  int vertex_count = 0;
  std::vector<int> from;       // 3 m: vertex at the start of each half-edge
  std::vector<int> opposite;   // 3 m: the half-edge on the other side, -1 at the boundary
  std::vector<double> length;  // 3 m, mm; equal on both sides
  int flips = 0;               // edges flipped so far
  double lengthened_by = 0;    // mm added to every edge so that no triangle is flat, 0 for ordinary meshes

  int face_count() const { return static_cast<int>(from.size() / 3); }
};

/// The mesh's own edges. Where triangles are flat to round-off, all edges are lengthened alike by just
/// enough (intrinsic mollification: Sharp & Crane 2020, Sec. 4.5).
/// Throws Error{invalid_input, "mesh"} unless edges are manifold and faces oriented alike.
IntrinsicTriangulation intrinsic_triangulation(const TriangleMesh& mesh);

/// Flips edges until the angles across every inner edge sum to at most 180 degrees.
/// Throws Error: invalid_input (as above), could_not_solve (flips do not end), cancelled.
IntrinsicTriangulation intrinsic_delaunay(const TriangleMesh& mesh, Context& context);

/// Cotangent of the angle opposite side `a` of a triangle with sides a, b, c (mm).
double cotangent_from_lengths(double a, double b, double c);

/// Area of a triangle with sides a, b, c, accurate for slivers (Kahan 2014); 0 where no such triangle exists.
double area_from_lengths(double a, double b, double c);

}  // namespace formwright
