// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Where the sheet meets the mould and the base plate. Thesis 4.2.2 tests sheet vertices against the mould's triangles
// on offset surfaces; here the test is continuous in time, by conservative advancement on the distance to the mould,
// which needs neither a watertight mould nor a bound on the step, and the mould's sharp points are tested against the
// sheet's triangles as well.
#include <memory>
#include <optional>
#include <vector>

#include "geometry/queries/point_distance.h"
#include "thermoform/sheet/placement.h"

namespace formwright {

/// A model with its search tree, in its own coordinates; kept between placements.
struct MouldShape {
  TriangleMesh mesh;
  PointDistance distance;
  explicit MouldShape(TriangleMesh shape) : mesh(std::move(shape)), distance(mesh) {}
};

class MouldContact {
 public:
  /// The model `shape` standing at `placement`, on a base plate at z = 0, within the box under the clamp, whose walls
  /// stand at the opening's sides. `tolerance_mm`: what counts as touching.
  MouldContact(std::shared_ptr<const MouldShape> shape, const Placement& placement, const Vec2& opening_mm,
               double tolerance_mm);

  /// Distance of `p` from the mould (not the plate), or nothing when it is more than `limit_mm`.
  std::optional<double> distance_mm(const Vec3& p, double limit_mm) const;

  /// What is known of one moving point: `distance_mm` is a lower bound at `place`.
  struct Known {
    Vec3 place = Vec3::Zero();
    double distance_mm = 0;
    double at(const Vec3& p) const { return distance_mm - (p - place).norm(); }
  };

  /// Asks the mould itself.
  Known survey(const Vec3& p) const;

  /// The first moment (0 to 1) at which a point that goes straight from `from` to `to` comes within `radius_mm` of the
  /// mould or the plate, or reaches a wall; nothing when it stays away.
  std::optional<double> first_touch(const Vec3& from, const Vec3& to, double radius_mm, Known& known) const;

  /// The direction away from whatever a point with `radius_mm` around it touches, or comes nearest to: mould, plate or
  /// wall.
  Vec3 normal(const Vec3& p, double radius_mm) const;

  /// Where a point that touches gets when it is pushed along the surface, whose normal there is `normal`, from `from`
  /// towards `to`: as far as the way is clear, down to the surface again, or nothing when it has none below it any more
  /// (`to` is then where it got). Never nearer than `radius_mm`, or than it was.
  std::optional<Vec3> slide(const Vec3& from, Vec3& to, const Vec3& normal, double radius_mm) const;

  double top_mm() const { return top_mm_; }  // of the mould; 0 without one
  double tolerance_mm() const { return tolerance_mm_; }
  bool has_mould() const { return shape_ != nullptr; }

  /// Points of the mould above the plate at which it is so sharply convex that a flat sheet triangle with edges of
  /// `edge_mm` resting on them would let the mould through by more than `allowed_mm`; about `spacing_mm` apart.
  std::vector<Vec3> sharp_points(double edge_mm, double allowed_mm, double spacing_mm) const;

 private:
  std::shared_ptr<const MouldShape> shape_;
  Placement placement_;
  Eigen::Matrix3d to_model_ = Eigen::Matrix3d::Identity();
  Vec2 wall_mm_;  // half of the opening
  double tolerance_mm_ = 0.01, top_mm_ = 0;
};

}  // namespace formwright
