// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Areas, normals, volume, angles: what one reads off a triangle mesh without solving anything.
#include <Eigen/Geometry>

#include "geometry/mesh/adjacency.h"
#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

/// Axis-aligned box; empty (lower > upper) until something is put in.
struct BoundingBox {
  Vec3 lower = Vec3::Constant(1e300);
  Vec3 upper = Vec3::Constant(-1e300);

  bool empty() const { return lower.x() > upper.x(); }
  Vec3 size() const { return empty() ? Vec3(0, 0, 0) : Vec3(upper - lower); }
  Vec3 centre() const { return empty() ? Vec3(0, 0, 0) : Vec3(lower + 0.5 * (upper - lower)); }
  double diagonal() const { return size().norm(); }
  /// Strictly: not on its border.
  bool surrounds(const Vec3& point) const {
    return (lower.array() < point.array()).all() && (point.array() < upper.array()).all();
  }
  void add(const Vec3& point) {
    lower = lower.cwiseMin(point);
    upper = upper.cwiseMax(point);
  }
};

/// Of all vertices, referenced or not.
BoundingBox bounding_box(const TriangleMesh& mesh);

/// m x 3, unit length; (0, 0, 0) for a face without area.
Positions face_normals(const TriangleMesh& mesh);

/// m, in mm^2.
Eigen::VectorXd face_areas(const TriangleMesh& mesh);

/// n x 3, unit length: the sum of the adjacent faces' area vectors, normalised. Where that sum
/// vanishes (isolated vertices, folded fans) the row is (0, 0, 0).
Positions vertex_normals(const TriangleMesh& mesh);

/// In mm^2.
double surface_area(const TriangleMesh& mesh);

/// Enclosed volume in mm^3, positive when the faces point outwards. Summed about the centre of the
/// bounding box, so that a mesh far from the origin loses no digits. Meaningful for closed meshes.
double signed_volume(const TriangleMesh& mesh);

/// Over the sides of all faces (an interior edge counts twice); 0 for a mesh without faces.
double mean_edge_length(const TriangleMesh& mesh);

/// m x 3: interior angle in radians at each corner; 0 where two corners coincide.
Positions corner_angles(const TriangleMesh& mesh);

/// Per edge of `adjacency` (built from this mesh): the angle in radians from one face's normal to the
/// other's, positive where the surface is convex, 0 where it is flat, in (-pi, pi]. 0 at edges that do
/// not join exactly two faces oriented alike, and beside faces without area.
Eigen::VectorXd dihedral_angles(const TriangleMesh& mesh, const Adjacency& adjacency);

}  // namespace formwright
