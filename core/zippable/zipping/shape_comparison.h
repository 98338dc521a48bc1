// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How far a shape is from another one with the same vertices, wherever it lies, and where it runs through itself.
#include <Eigen/Core>
#include <vector>

#include "base/context.h"
#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

/// x -> linear x + shift; linear is orthogonal.
struct RigidMotion {
  Eigen::Matrix3d linear = Eigen::Matrix3d::Identity();
  Vec3 shift = Vec3::Zero();
  Positions operator()(const Positions& x) const { return (x * linear.transpose()).rowwise() + shift.transpose(); }
};

/// The motion that brings `from` onto `to` with the least mean squared distance under `weight` (Kabsch 1976); a
/// mirroring where `mirrored`.
RigidMotion best_motion(const Positions& from, const Positions& to, const Eigen::VectorXd& weight, bool mirrored);

struct ShapeComparison {
  RigidMotion motion;                                        // onto the prediction, the better of both kinds
  bool mirrored = false;                                     // inside out
  Eigen::VectorXd distance_mm;                               // per vertex
  double mean_mm = 0, percentile_95_mm = 0, largest_mm = 0;  // weighted, but for the last
};

ShapeComparison compare_shapes(const Positions& shape, const Positions& predicted, const Eigen::VectorXd& weight);

}  // namespace formwright
