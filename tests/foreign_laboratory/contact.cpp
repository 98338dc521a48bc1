// SPDX-License-Identifier: GPL-3.0-or-later
#include "foreign_laboratory/contact.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace formwright::foreign_laboratory {

using Eigen::Vector3d;

namespace {

/// About the vertical, then leaning about a horizontal axis through the middle of its base.
Eigen::Matrix3d turn_of(const Faults& faults) {
  constexpr double per_degree = std::numbers::pi / 180;
  const Vector3d lean(-faults.mould_lean_back_deg, faults.mould_lean_right_deg, 0);  // the axis, as long as the angle
  const Eigen::Matrix3d about_vertical =
      Eigen::AngleAxisd(per_degree * faults.mould_rotation_deg, Vector3d::UnitZ()).toRotationMatrix();
  if (lean.norm() == 0) return about_vertical;
  return Eigen::AngleAxisd(per_degree * lean.norm(), lean.normalized()).toRotationMatrix() * about_vertical;
}

}  // namespace

MouldOnPlate::MouldOnPlate(Mould mould, const Faults& faults)
    : mould_(mould),
      friction_(faults.slip > 0 ? 1 / faults.slip : std::numeric_limits<double>::infinity()),
      turn_(turn_of(faults)),
      scale_(1 + faults.mould_scale),
      shift_(faults.mould_shift_x_mm, faults.mould_shift_y_mm, 0) {}

Distance MouldOnPlate::distance_from(const Vector3d& place, double plate_z_mm) const {
  const Vector3d from = place - shift_ - Vector3d(0, 0, plate_z_mm);
  const Distance plate{from.z(), Vector3d::UnitZ()};
  Distance mould = foreign_laboratory::distance_to(mould_, turn_.transpose() * from / scale_);
  mould.mm *= scale_;
  if (plate.mm < mould.mm) return plate;
  mould.outward = turn_ * mould.outward;
  return mould;
}

double MouldOnPlate::constrain(const Vector3d& place, double clearance_mm, const Step& step, Vector3d& velocity) const {
  // A point in the corner between mould and plate meets first the one, then the other.
  constexpr int max_surfaces = 2;
  double left = 0;
  for (int k = 0; k < max_surfaces; ++k) {
    const Distance d = distance_from(place + step.seconds * velocity, step.plate_z_mm);
    if (k == 0) left = std::max(0.0, d.mm - clearance_mm);
    if (d.mm >= clearance_mm) break;
    const double pressed = (clearance_mm - d.mm) / step.seconds;
    velocity += pressed * d.outward;
    const Vector3d relative = velocity - Vector3d(0, 0, step.plate_mm_per_s);
    const Vector3d along = relative - relative.dot(d.outward) * d.outward;
    const double speed = along.norm();
    if (speed > 0) velocity -= std::min(1.0, friction_ * pressed / speed) * along;
  }
  return left;
}

}  // namespace formwright::foreign_laboratory
