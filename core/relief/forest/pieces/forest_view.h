// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A viewpoint of the forest and its model: from the axes of the solved relief (ViewFrame) to those of the floor and
// back.
#include "relief/forest/plan/forest_scene.h"
#include "relief/forest/plan/plan_view.h"
#include "relief/view/relief_options.h"
#include "relief/view/view_frame.h"

namespace formwright {

/// A point by the ray that it lies on: tangents to the right of and above straight ahead, horizontally, and the
/// distance ahead in the floor plan.
struct RayPoint {
  double aside = 0, above = 0, ahead = 0;
};

class ForestView {
 public:
  explicit ForestView(const ForestViewpoint& viewpoint);

  const Vec3& eye() const { return eye_; }
  double distance_mm() const { return distance_mm_; }  // of what is looked at
  double width_mm() const { return width_mm_; }
  /// Without its range of tangents.
  const PlanView& plan() const { return plan_; }

  /// `options` with the viewpoint's size, distance and directions.
  ReliefOptions relief_options(ReliefOptions options) const;

  /// From view coordinates of the relief, whose unit is the width, with the given kappa.
  Vec3 to_world(const Vec3& view_position, double kappa) const;
  Positions to_world(const Positions& view_positions, double kappa) const;

  RayPoint ray_point(const Vec3& world) const;
  Vec3 world(const RayPoint& p) const;
  /// Unit length, from the eye.
  Vec3 ray_direction(double aside, double above) const;
  /// The ray through a place of the picture, in widths from its middle to the right and upwards.
  Vec3 picture_ray(double x, double y) const;

 private:
  Vec3 eye_, right_, up_, look_;
  double distance_mm_, width_mm_;
  std::array<double, 3> model_direction_, model_up_;
  PlanView plan_;
};

/// Smallest and largest tangent of the model's vertices. Throws Error{invalid_input, "scene"} if not all of them lie
/// ahead of viewpoint `number` in the floor plan: it looks too steeply.
Vec2 range_of_tangents(const ForestView& view, const ViewFrame& frame, int number);

}  // namespace formwright
