// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Nearest points on a triangle mesh, and how far one surface lies from another.
#include <limits>
#include <memory>
#include <optional>

#include "base/context.h"
#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

struct NearestPoint {
  int face = -1;
  double distance = 0;  // mm
  Vec3 point;
  Vec3 barycentric;  // of the face's three corners, none negative, sums to 1
};

class PointDistance {
 public:
  /// Copies the mesh into a search tree. Throws Error{invalid_input, "mesh"} on indices out of range,
  /// positions that are not finite, and a mesh without faces.
  explicit PointDistance(const TriangleMesh& mesh);
  ~PointDistance();
  PointDistance(PointDistance&&) noexcept;
  PointDistance& operator=(PointDistance&&) noexcept;

  /// The point of the surface nearest to `query`; of faces at the same distance, the first. Nothing when
  /// it is farther than `limit`. Callable from several threads.
  std::optional<NearestPoint> nearest(const Vec3& query, double limit = std::numeric_limits<double>::infinity()) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// Of the triangle a, b, c; also right when it is a segment or a point.
/// Ericson 2005, "Real-Time Collision Detection", Sec. 5.1.5. Leaves `face` at -1.
NearestPoint nearest_on_triangle(const Vec3& query, const Vec3& a, const Vec3& b, const Vec3& c);

struct SurfaceDistance {
  double maximum = 0, mean = 0, root_mean_square = 0;  // mm, means weighted by area
};

/// Distances from points of `from` to the surface of `to`: all vertices (for the maximum) and a
/// regular pattern on every face, no point of which lies farther than `spacing` (mm) from one of them (at
/// most 1000 x 1000 a face). The maximum is a
/// lower bound of the one-sided Hausdorff distance, short of it by at most `spacing`.
/// Throws Error: invalid_input, cancelled.
SurfaceDistance surface_distance(const TriangleMesh& from, const PointDistance& to, double spacing, Context& context);

/// Larger of the two one-sided maxima.
double hausdorff_distance(const TriangleMesh& a, const TriangleMesh& b, double spacing, Context& context);

}  // namespace formwright
