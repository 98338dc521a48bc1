// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/view/view_frame.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "base/format.h"

namespace formwright {
namespace {

constexpr double nearest_front = 0.1;  // of the viewing distance; nearer, the picture is mostly one bump

struct Extent {
  double x_min, x_max, y_min, y_max;
  double width() const { return x_max - x_min; }
  double height() const { return y_max - y_min; }
};

/// What the model covers on the plane z = 0 seen from `distance` (infinite: straight on).
Extent seen_extent(const Positions& P, double distance) {
  Extent e{1e300, -1e300, 1e300, -1e300};
  for (Eigen::Index i = 0; i < P.rows(); ++i) {
    const double shrink = std::isinf(distance) ? 1.0 : distance / (distance + P(i, 2));
    e.x_min = std::min(e.x_min, P(i, 0) * shrink);
    e.x_max = std::max(e.x_max, P(i, 0) * shrink);
    e.y_min = std::min(e.y_min, P(i, 1) * shrink);
    e.y_max = std::max(e.y_max, P(i, 1) * shrink);
  }
  return e;
}

Eigen::Matrix3d view_axes(const ReliefOptions& options) {
  const Vec3 direction(options.direction[0], options.direction[1], options.direction[2]);
  const Vec3 up(options.up[0], options.up[1], options.up[2]);
  if (!(direction.norm() > 0))
    throw Error(ErrorCode::invalid_input, "direction",
                "The looking direction has no length: give three numbers that are not all 0.");
  if (!(up.norm() > 0))
    throw Error(ErrorCode::invalid_input, "up",
                "The up direction has no length: give three numbers that are not all 0.");
  const Vec3 forward = direction.stableNormalized();
  const Vec3 right = forward.cross(up.stableNormalized());
  if (right.norm() < 1e-6)
    throw Error(ErrorCode::invalid_input, "up", "Up lies along the looking direction: choose another up direction.");
  Eigen::Matrix3d axes;
  axes.row(0) = right.normalized();
  axes.row(1) = right.normalized().cross(forward);
  axes.row(2) = forward;
  return axes;
}

/// The distance, in model lengths, from which distance : seen width has the wanted ratio. The ratio grows
/// with the distance from 0 (viewpoint at the nearest vertex) without end, so bisection always finds it.
double distance_for_ratio(const Positions& P, double ratio, const ReliefOptions& options) {
  const double front = P.col(2).minCoeff();
  const auto ratio_at = [&](double distance) { return distance / seen_extent(P, distance).width(); };
  const double nearest = -front / (1 - nearest_front);
  if (front < 0 && ratio_at(nearest) > ratio) {
    const double minimum = ratio_at(nearest);
    const std::string where = options.distance_mm ? "distance_mm" : "field_of_view_deg";
    const std::string fix =
        options.distance_mm
            ? "give a distance of at least " + with_digits(std::ceil(minimum * options.width_mm), 4) + " mm"
            : "give a field of view of at most " +
                  with_digits(std::floor(2 * std::atan(0.5 / minimum) * 180 / std::numbers::pi * 10) / 10, 4) + "°";
    throw Error(
        ErrorCode::invalid_input, where,
        "The viewpoint lies inside the model or too close to it: " + fix + ", or look from far (orthographic).");
  }
  double low = std::max(nearest, 0.0), high = std::max(2 * low, seen_extent(P, INFINITY).width());
  while (ratio_at(high) < ratio) high *= 2;
  for (int i = 0; i < 200 && high - low > 1e-15 * high; ++i) {
    const double middle = 0.5 * (low + high);
    (ratio_at(middle) < ratio ? low : high) = middle;
  }
  return high;
}

}  // namespace

ViewFrame make_view_frame(const TriangleMesh& mesh, const ReliefOptions& options) {
  ViewFrame frame;
  frame.axes = view_axes(options);
  const Vec3 lowest = mesh.V.colwise().minCoeff(), highest = mesh.V.colwise().maxCoeff();
  const Vec3 first_centre = 0.5 * (lowest + highest);
  Positions P = (mesh.V.rowwise() - first_centre.transpose()) * frame.axes.transpose();
  // Centre the depth on its range, then (twice, because perspective couples them) the picture on the plate.
  Vec3 shift(0, 0, 0.5 * (P.col(2).minCoeff() + P.col(2).maxCoeff()));
  P.col(2).array() -= shift.z();

  double distance = INFINITY;
  const double diagonal = (highest - lowest).norm();
  const int passes = options.projection == Projection::perspective ? 30 : 1;
  for (int pass = 0; pass < passes; ++pass) {
    if (options.projection == Projection::perspective) {
      const Extent straight = seen_extent(P, INFINITY);
      if (!(straight.width() > 1e-9 * diagonal)) break;
      const double ratio = options.distance_mm ? *options.distance_mm / options.width_mm
                                               : 0.5 / std::tan(options.field_of_view_deg * std::numbers::pi / 360);
      distance = distance_for_ratio(P, ratio, options);
    }
    const Extent e = seen_extent(P, distance);
    const double dx = 0.5 * (e.x_min + e.x_max), dy = 0.5 * (e.y_min + e.y_max);
    shift.x() += dx;
    shift.y() += dy;
    P.col(0).array() -= dx;
    P.col(1).array() -= dy;
    if (std::abs(dx) + std::abs(dy) < 1e-14 * diagonal) break;
  }

  const Extent e = seen_extent(P, distance);
  if (!(e.width() > 1e-9 * diagonal) || !(e.height() > 1e-9 * diagonal))
    throw Error(ErrorCode::invalid_input, "direction",
                "The model is only a line when seen from this direction: choose another looking direction.");
  frame.scale = 1 / e.width();
  frame.P = P * frame.scale;
  frame.kappa = std::isinf(distance) ? 0.0 : 1 / (distance * frame.scale);
  frame.image_height = e.height() * frame.scale;
  frame.centre = first_centre + frame.axes.transpose() * shift;
  return frame;
}

Positions ViewFrame::moved(const Eigen::VectorXd& u) const {
  Positions Q = P;
  for (Eigen::Index i = 0; i < P.rows(); ++i) {
    Q.row(i) += u[i] * kappa * P.row(i);
    Q(i, 2) += u[i];
  }
  return Q;
}

Eigen::VectorXd ViewFrame::depth(const Eigen::VectorXd& u) const {
  return P.col(2).array() + u.array() * (1 + kappa * P.col(2).array());
}

Positions ViewFrame::to_model(const Positions& view_positions, double size) const {
  return ((view_positions * size) * axes).rowwise() + (centre * scale * size).transpose();
}

Vec3 ViewFrame::to_model(const Vec3& view_position, double size) const {
  return axes.transpose() * (view_position * size) + centre * scale * size;
}

Vec3 ViewFrame::ray_direction(const Vec3& p) const {
  return Vec3(kappa * p.x(), kappa * p.y(), 1 + kappa * p.z()).normalized();
}

}  // namespace formwright
