// SPDX-License-Identifier: GPL-3.0-or-later
#include "thermoform/sheet/placement.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/format.h"
#include "base/error.h"
#include "geometry/mesh/measures.h"

namespace formwright {
namespace {

constexpr double min_size_mm = 10, usual_size_mm = 100, margin_mm = 5;

/// A rotation that takes the model's up to z, and, for the up of most files (y), the model's front (+z) to -y, towards
/// whoever stands before the machine.
Eigen::Matrix3d standing(const std::array<double, 3>& up_option) {
  Vec3 up(up_option[0], up_option[1], up_option[2]);
  if (!(up.norm() > 1e-12))
    throw Error(ErrorCode::invalid_input, "up", "The up direction must not be 0, 0, 0: 0, 1, 0 and 0, 0, 1 are usual.");
  up.normalize();
  // The front: +z of the model, or -y where that is up (then the model is z-up already, and stays as it is).
  Vec3 front = std::abs(up.z()) < 0.9 ? Vec3(0, 0, 1) : Vec3(0, up.z() > 0 ? -1 : 1, 0);
  front = (front - front.dot(up) * up).normalized();
  Eigen::Matrix3d rotation;
  rotation.row(0) = up.cross(-front).transpose() * -1.0;
  rotation.row(1) = -front.transpose();
  rotation.row(2) = up.transpose();
  return rotation;
}

/// What leaves the margin to the clamp on every side. A clamp that is narrower than two margins leaves a tenth of its
/// opening.
double scale_that_fits(const Vec3& size_mm, const Vec2& opening_mm) {
  double scale = std::numeric_limits<double>::infinity();
  for (const int axis : {0, 1})
    scale = std::min(scale, std::max(opening_mm[axis] - 2 * margin_mm, 0.1 * opening_mm[axis]) / size_mm[axis]);
  return scale;
}

std::string millimetres(double value) { return with_digits(value, 3) + " mm"; }

}  // namespace

TriangleMesh Placement::operator()(const TriangleMesh& mesh) const {
  TriangleMesh placed{(mesh.V * linear.transpose()).eval(), mesh.F};
  placed.V.rowwise() += translation.transpose();
  return placed;
}

Placement place(const TriangleMesh& mesh, const PlacementOptions& options, const Vec2& opening_mm) {
  Placement placement;
  const double angle = options.turn_deg * std::numbers::pi / 180;
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(angle, Vec3::UnitZ()).toRotationMatrix();
  const Eigen::Matrix3d upright = standing(options.up);
  // The size is that of the model before it is turned, so that turning does not scale it.
  BoundingBox straight, turned;
  for (Eigen::Index i = 0; i < mesh.V.rows(); ++i) {
    const Vec3 p = upright * mesh.V.row(i).transpose();
    straight.add(p);
    turned.add(turn * p);
  }
  const double extent = straight.size().maxCoeff();
  if (!(extent > 0) || !std::isfinite(extent))
    throw Error(ErrorCode::invalid_input, "mould", "The model has no extent: choose another file.");
  if (options.size_mm) {
    placement.scale = *options.size_mm / extent;
  } else if (const double fits = scale_that_fits(straight.size(), opening_mm); extent < min_size_mm || fits < 1) {
    placement.scale = std::min(usual_size_mm / extent, fits);
    placement.notes.push_back("The file's own size, " + millimetres(extent) +
                              ", does not suit the machine: the longest side is now " +
                              millimetres(placement.scale * extent) + ".");
  }
  placement.linear = placement.scale * turn * upright;
  const Vec3 centre = turned.centre() * placement.scale;
  placement.translation =
      Vec3(options.x_mm - centre.x(), options.y_mm - centre.y(), -turned.lower.z() * placement.scale - options.sink_mm);
  const double height = turned.size().z() * placement.scale;
  if (options.sink_mm >= height)
    throw Error(ErrorCode::invalid_input, "sink_mm",
                "The model is " + millimetres(height) +
                    " high, so that nothing of it would stand above the plate: sink it less.");
  return placement;
}

}  // namespace formwright
