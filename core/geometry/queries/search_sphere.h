// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The sphere about a mesh to which the search trees relate their single-precision boxes, and rays seen
// from its centre.
#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

struct SearchSphere {
  Vec3 centre = Vec3::Zero();  // of the bounding box
  double radius = 0;           // half its diagonal

  /// Far beyond this many radii, round-off of double precision moves a ray by as much as the boxes are widened.
  static constexpr double max_distance_radii = 1e8;
};

/// Throws Error{invalid_input, "mesh"} on 2^28 triangles or more, indices out of range, positions that are not
/// finite, and a radius of 1e30 or more.
SearchSphere search_sphere(const TriangleMesh& mesh);

/// A ray in distances that count from where it passes closest to the centre: however far the origin is, the
/// part within the sphere then has small coordinates. `direction` is unit length.
struct CentredRay {
  CentredRay(const SearchSphere& sphere, const Vec3& origin, const Vec3& towards) : direction(towards) {
    const Vec3 to_centre = sphere.centre - origin;
    start = to_centre.dot(direction);
    foot = direction * start - to_centre;
    const double distance = to_centre.norm();
    misses = foot.squaredNorm() > 1.01 * sphere.radius * sphere.radius + smallest_square;
    is_too_far = distance > SearchSphere::max_distance_radii * sphere.radius;
    tolerance = 1e-7 * sphere.radius + 1e-15 * distance;
  }
  Vec3 direction;
  double start;      // distance of the foot from the origin
  Vec3 foot;         // of the perpendicular, relative to the centre
  bool misses;       // the sphere
  bool is_too_far;   // for boxes in single precision: every triangle has to be tested
  double tolerance;  // how far a hit may lie outside the box of its triangle: round-off from there, generously

 private:
  static constexpr double smallest_square = 1e-300;  // so that the ray through a single point does not miss it
};

}  // namespace formwright
