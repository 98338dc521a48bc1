// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/forest/pieces/forest_view.h"

#include <Eigen/Geometry>
#include <cmath>
#include <string>

#include "base/error.h"

namespace formwright {

ForestView::ForestView(const ForestViewpoint& viewpoint)
    : eye_(viewpoint.eye_mm),
      distance_mm_((viewpoint.look_at_mm - viewpoint.eye_mm).norm()),
      width_mm_(viewpoint.width_mm),
      model_direction_(viewpoint.direction),
      model_up_(viewpoint.up) {
  look_ = (viewpoint.look_at_mm - viewpoint.eye_mm) / distance_mm_;
  right_ = look_.cross(Vec3::UnitZ()).normalized();
  up_ = right_.cross(look_);
  plan_.eye = eye_.head<2>();
  plan_.forward = look_.head<2>().normalized();
  plan_.distance_mm = distance_mm_ * look_.head<2>().norm();
}

ReliefOptions ForestView::relief_options(ReliefOptions options) const {
  options.projection = Projection::perspective;
  options.width_mm = width_mm_;
  options.distance_mm = distance_mm_;
  options.direction = model_direction_;
  options.up = model_up_;
  options.appearance = Appearance::detail;
  return options;
}

Vec3 ForestView::to_world(const Vec3& p, double kappa) const {
  return eye_ + width_mm_ * (p.x() * right_ + p.y() * up_ + (p.z() + 1 / kappa) * look_);
}

Positions ForestView::to_world(const Positions& view_positions, double kappa) const {
  Positions world(view_positions.rows(), 3);
  for (Eigen::Index i = 0; i < world.rows(); ++i)
    world.row(i) = to_world(Vec3(view_positions.row(i).transpose()), kappa).transpose();
  return world;
}

RayPoint ForestView::ray_point(const Vec3& world) const {
  const Vec2 p = world.head<2>();
  const double ahead = plan_.ahead(p);
  return {plan_.aside(p) / ahead, (world.z() - eye_.z()) / ahead, ahead};
}

Vec3 ForestView::world(const RayPoint& p) const {
  const Vec2 place = plan_.at(p.aside, p.ahead);
  return {place.x(), place.y(), eye_.z() + p.above * p.ahead};
}

Vec3 ForestView::ray_direction(double aside, double above) const {
  const Vec2 d = plan_.direction(aside);
  return Vec3(d.x(), d.y(), above).normalized();
}

Vec3 ForestView::picture_ray(double x, double y) const {
  return (look_ + width_mm_ / distance_mm_ * (x * right_ + y * up_)).normalized();
}

Vec2 range_of_tangents(const ForestView& view, const ViewFrame& frame, int number) {
  constexpr double nearest_share = 0.02;  // of the distance of what is looked at
  Vec2 range(INFINITY, -INFINITY);
  for (Eigen::Index i = 0; i < frame.P.rows(); ++i) {
    const RayPoint p = view.ray_point(view.to_world(Vec3(frame.P.row(i).transpose()), frame.kappa));
    if (!(p.ahead > nearest_share * view.plan().distance_mm))
      throw Error(ErrorCode::invalid_input, "scene",
                  "Viewpoint " + std::to_string(number) +
                      " looks too steeply at its model: bring its eye nearer to the height of what it looks at, or "
                      "move it away.");
    range = {std::min(range[0], p.aside), std::max(range[1], p.aside)};
  }
  return range;
}

}  // namespace formwright
