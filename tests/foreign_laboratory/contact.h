// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The mould on its rising base plate, as an obstacle for points of the sheet. A point that would end a step nearer than
// half the sheet's thickness gets the velocity that ends the step at that distance; along the surface it is held back
// by Coulomb friction with the same momentum ([TF89], kinematic contact). Nothing holds
// a point that is pulled off.
#include <Eigen/Core>

#include "foreign_laboratory/faults.h"
#include "foreign_laboratory/mould_shape.h"

namespace formwright::foreign_laboratory {

class MouldOnPlate {
 public:
  /// The mould stands where `faults` has it. Friction is 1 / slip; without slip what touches sticks.
  MouldOnPlate(Mould mould, const Faults& faults);

  /// To the mould or the plate, whichever is nearer; the plate at height `plate_z_mm`.
  Distance distance_from(const Eigen::Vector3d& place, double plate_z_mm) const;

  struct Step {
    double seconds, plate_z_mm, plate_mm_per_s;  // the plate at the end of the step
  };
  /// Changes the velocity with which a point leaves `place`, so that it ends the step at least `clearance_mm` away.
  /// Gives the distance then left beyond the clearance from which the point came: 0 where it touches.
  double constrain(const Eigen::Vector3d& place, double clearance_mm, const Step& step,
                   Eigen::Vector3d& velocity) const;

 private:
  Mould mould_;
  double friction_;  // infinite: sticks
  Eigen::Matrix3d turn_;
  double scale_;
  Eigen::Vector3d shift_;
};

}  // namespace formwright::foreign_laboratory
