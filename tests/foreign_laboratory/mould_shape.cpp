// SPDX-License-Identifier: GPL-3.0-or-later
#include "foreign_laboratory/mould_shape.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace formwright::foreign_laboratory {
namespace {

using Eigen::Vector2d, Eigen::Vector3d;

Vector3d unit(const Vector3d& direction) {
  const double length = direction.norm();
  return length > 0 ? Vector3d(direction / length) : Vector3d(0, 0, 1);
}

struct Ball {
  Vector3d centre;
  double radius_mm;
};

Distance distance_to(const Ball& ball, const Vector3d& place) {
  const Vector3d from = place - ball.centre;
  return {from.norm() - ball.radius_mm, unit(from)};
}

/// A sphere of 50 mm radius of foot, 45 mm high.
constexpr double dome_height_mm = 45, dome_foot_mm = 50;
Ball dome() {
  const double radius = (dome_foot_mm * dome_foot_mm + dome_height_mm * dome_height_mm) / (2 * dome_height_mm);
  return {{0, 0, dome_height_mm - radius}, radius};
}

/// Balls that all contain the origin, so that rays from there meet the surface once.
const std::array<Ball, 3>& bumps() {
  static const std::array<Ball, 3> balls = {Ball{{-20, -12, 10}, 32}, Ball{{22, -6, 4}, 30}, Ball{{-2, 24, 0}, 28}};
  return balls;
}

/// A convex profile that goes down from a tip for ever, at `half_angle` from the vertical, rounded by `radius_mm`.
struct Slope {
  double height_mm, half_angle, radius_mm;
  double inner_tip_mm() const { return height_mm - radius_mm; }
};
constexpr double degree = 3.14159265358979323846 / 180;
constexpr Slope cone_slope{55, 38 * degree, 8}, pyramid_slope{55, 38 * degree, 5};

/// Of revolution: in the plane through the axis the nearest point is on the line of the side, or the tip.
Distance distance_to_cone(const Slope& slope, const Vector3d& place) {
  const double radius = std::hypot(place.x(), place.y());
  const Vector3d outward = radius > 0 ? Vector3d(place.x() / radius, place.y() / radius, 0) : Vector3d(1, 0, 0);
  const double below = slope.inner_tip_mm() - place.z();
  const double sine = std::sin(slope.half_angle), cosine = std::cos(slope.half_angle);
  if (radius * sine + below * cosine <= 0) {
    const Vector3d from(place.x(), place.y(), -below);
    return {from.norm() - slope.radius_mm, unit(from)};
  }
  return {radius * cosine - below * sine - slope.radius_mm, cosine * outward + sine * Vector3d::UnitZ()};
}

/// Square: by its symmetry only the face towards x > |y|, the ridge above x = y and the tip can be nearest.
Distance distance_to_pyramid(const Slope& slope, const Vector3d& place) {
  Vector3d p(std::abs(place.x()), std::abs(place.y()), place.z() - slope.inner_tip_mm());
  const bool swapped = p.y() > p.x();
  if (swapped) std::swap(p.x(), p.y());
  const double sine = std::sin(slope.half_angle), cosine = std::cos(slope.half_angle);
  const Vector3d normal(cosine, 0, sine);
  const double off = p.dot(normal);
  const Vector3d on_face = p - off * normal;
  Distance found{};
  if (on_face.y() <= on_face.x()) {
    found = {off - slope.radius_mm, normal};
  } else {
    const Vector3d ridge = Vector3d(sine, sine, -cosine).normalized();
    const Vector3d from = p - std::max(0.0, p.dot(ridge)) * ridge;
    found = {from.norm() - slope.radius_mm, unit(from)};
  }
  if (swapped) std::swap(found.outward.x(), found.outward.y());
  if (place.x() < 0) found.outward.x() = -found.outward.x();
  if (place.y() < 0) found.outward.y() = -found.outward.y();
  return found;
}

/// Upright walls that go on below z = 0; edges and corners rounded by `radius_mm`.
struct Block {
  double half_x_mm, half_y_mm, height_mm, radius_mm;
};
constexpr Block box_block{45, 35, 40, 7};
constexpr Block cross_blocks[] = {{55, 22, 40, 7}, {22, 55, 40, 7}};

Distance distance_to(const Block& block, const Vector3d& place) {
  const Vector3d sign(place.x() < 0 ? -1 : 1, place.y() < 0 ? -1 : 1, 1);
  const Vector3d beyond(std::abs(place.x()) - (block.half_x_mm - block.radius_mm),
                        std::abs(place.y()) - (block.half_y_mm - block.radius_mm),
                        place.z() - (block.height_mm - block.radius_mm));
  const Vector3d outside = beyond.cwiseMax(0);
  if (outside.squaredNorm() > 0) return {outside.norm() - block.radius_mm, unit(outside).cwiseProduct(sign)};
  Eigen::Index nearest = 0;
  const double inside = beyond.maxCoeff(&nearest);
  return {inside - block.radius_mm, Vector3d::Unit(nearest).cwiseProduct(sign)};
}

template <class Parts>
Distance distance_to_nearest(const Parts& parts, const Vector3d& place) {
  Distance nearest{1e300, Vector3d::UnitZ()};
  for (const auto& part : parts)
    if (const Distance d = distance_to(part, place); d.mm < nearest.mm) nearest = d;
  return nearest;
}

}  // namespace

Mould mould_of(std::string_view name) {
  for (std::size_t k = 0; k < mould_names.size(); ++k)
    if (mould_names[k] == name) return static_cast<Mould>(k);
  throw std::invalid_argument("mould: '" + std::string(name) +
                              "' is not known; give one of dome, cone, box, pyramid, bumps, cross");
}

Distance distance_to(Mould mould, const Vector3d& place) {
  switch (mould) {
    case Mould::dome: return distance_to(dome(), place);
    case Mould::cone: return distance_to_cone(cone_slope, place);
    case Mould::box: return distance_to(box_block, place);
    case Mould::pyramid: return distance_to_pyramid(pyramid_slope, place);
    case Mould::bumps: return distance_to_nearest(bumps(), place);
    case Mould::cross: return distance_to_nearest(cross_blocks, place);
  }
  throw std::invalid_argument("mould: not one of the list");
}

double mould_height_mm(Mould mould) {
  switch (mould) {
    case Mould::dome: return dome_height_mm;
    case Mould::cone: return cone_slope.height_mm;
    case Mould::box: return box_block.height_mm;
    case Mould::pyramid: return pyramid_slope.height_mm;
    case Mould::bumps: return bumps()[0].centre.z() + bumps()[0].radius_mm;
    case Mould::cross: return cross_blocks[0].height_mm;
  }
  throw std::invalid_argument("mould: not one of the list");
}

}  // namespace formwright::foreign_laboratory
