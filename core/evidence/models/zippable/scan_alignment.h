// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Laying a scan, which has coordinates of its own, onto a simulated shape.
#include "geometry/queries/point_distance.h"
#include "zippable/zipping/shape_comparison.h"

namespace formwright {

/// Of ScannedShape::aligned from a start that is near.
inline constexpr int rounds_of_alignment = 20;

/// A shape whose points can be asked for: `mesh` oriented outwards.
class ScannedShape {
 public:
  /// `offset_mm`: how far outside of the mesh a scan sees its surface. Throws Error{could_not_solve} where the shape
  /// has no finite place.
  ScannedShape(const TriangleMesh& mesh, double offset_mm);

  /// The motion that brings `points` (n x 3) nearest to the surface, from `start`: point to plane (Chen and Medioni
  /// 1992), points far off count less (Huber). Throws cancelled.
  RigidMotion aligned(const Positions& points, const RigidMotion& start, int max_rounds, const Context& context) const;

  /// The same from anywhere, mirrored too: cloth zips up as well inside out, which is the mirror image.
  RigidMotion found(const Positions& points, const Context& context) const;

  /// Distances of moved points from the surface that a scan sees, > 0 outside.
  Eigen::VectorXd distances_mm(const Positions& points, const RigidMotion& motion) const;

  const PointDistance& nearest() const { return nearest_; }

 private:
  struct Contact {
    Vec3 normal;
    double distance_mm;
  };
  Contact contact(const Vec3& point) const;

  TriangleMesh mesh_;
  double offset_mm_;
  PointDistance nearest_;
};

/// At most `count` of the rows, spread evenly over them.
Positions evenly_chosen(const Positions& points, Eigen::Index count);

}  // namespace formwright
