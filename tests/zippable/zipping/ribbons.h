// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Ribbons whose zipped shape is known: a cylinder or a cone cut along a helix and unrolled.
#include <cmath>
#include <numbers>

#include "geometry/test_meshes.h"
#include "zippable/zipping/ribbon_pattern.h"

namespace formwright::test {

struct HelixShape {
  double turn_mm = 100, height_mm = 60;  // around and along, in the unrolled surface
  int turns = 2, around = 16;            // of the helix; columns a turn
  int shift = 0;                         // columns by which one side of the zipper is sewn on wrongly
};

/// `flat` and `space` map the unrolled surface (x around, y along) into the plane and onto the surface.
template <class Flat, class Space>
RibbonDesign helix_ribbon(const HelixShape& shape, const Flat& flat, const Space& space) {
  const int zipper = shape.turns * shape.around, columns = zipper + shape.around;
  RibbonDesign design;
  const auto add = [&](double x, double y, int sample, bool left) {
    RibbonEdgePlace place;
    place.flat_mm = flat(x, y);
    place.predicted_mm = space(x, y);
    if (sample >= 0 && sample <= zipper - shape.shift) place.sample = sample, place.piece = 0, place.left = left;
    design.places.push_back(place);
    return static_cast<int>(design.places.size()) - 1;
  };
  const double column_mm = shape.turn_mm / shape.around, rise_mm = shape.height_mm / zipper;
  std::vector<int> upper, lower;
  for (int i = 0; i <= columns; ++i) {
    const double x = column_mm * i;
    if (i < columns) upper.push_back(i <= zipper ? add(x, rise_mm * i, i, true) : add(x, shape.height_mm, -1, true));
    if (i > 0)
      lower.push_back(i >= shape.around ? add(x, rise_mm * (i - shape.around), i - shape.around - shape.shift, false)
                                        : add(x, 0, -1, true));
  }
  lower.insert(lower.begin(), upper.front());  // the strip begins and ends in a point
  upper.push_back(lower.back());
  std::vector<std::array<int, 3>> faces;
  for (std::size_t i = 0; i + 1 < upper.size(); ++i) {
    if (i > 0) faces.push_back({lower[i], lower[i + 1], upper[i]});
    if (i + 2 < upper.size()) faces.push_back({upper[i], lower[i + 1], upper[i + 1]});
  }
  design.triangles.resize(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t f = 0; f < faces.size(); ++f)
    design.triangles.row(static_cast<Eigen::Index>(f)) << faces[f][0], faces[f][1], faces[f][2];
  return design;
}

inline RibbonDesign cylinder_ribbon(const HelixShape& shape) {
  const double radius = shape.turn_mm / (2 * std::numbers::pi);
  return helix_ribbon(
      shape, [](double x, double y) { return Vec2(x, y); },
      [&](double x, double y) { return Vec3(radius * std::cos(x / radius), radius * std::sin(x / radius), y); });
}

/// The lower rim is `slant_mm` from the tip; half the opening angle is 30 degrees.
inline RibbonDesign cone_ribbon(const HelixShape& shape, double slant_mm) {
  const auto distance = [&](double y) { return slant_mm - y; };
  const double sine = 0.5, cosine = std::sqrt(0.75), turn = 2 * std::numbers::pi * sine;
  return helix_ribbon(
      shape,
      [&](double x, double y) {
        const double angle = x / shape.turn_mm * turn;
        return Vec2(distance(y) * Vec2(std::cos(angle), std::sin(angle)));
      },
      [&](double x, double y) {
        const double angle = 2 * std::numbers::pi * x / shape.turn_mm;
        return Vec3(distance(y) * Vec3(sine * std::cos(angle), sine * std::sin(angle), -cosine));
      });
}

}  // namespace formwright::test
