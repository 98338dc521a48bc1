// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A viewpoint in the floor plan. Rays are named by their tangent t to the right of straight ahead, and places on a ray
// by their distance b ahead, measured along the looking direction: e + b (forward + t right).
#include <algorithm>

#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

struct PlanView {
  Vec2 eye{0, 0}, forward{0, 1};  // forward: unit length
  double from = -1, to = 1;       // tangents of the model's left and right edge
  double distance_mm = 0;         // ahead, of what is looked at

  Vec2 right() const { return {forward.y(), -forward.x()}; }
  double ahead(const Vec2& p) const { return forward.dot(p - eye); }
  double aside(const Vec2& p) const { return right().dot(p - eye); }
  double tangent(const Vec2& p) const { return aside(p) / ahead(p); }
  Vec2 direction(double t) const { return forward + t * right(); }
  Vec2 at(double t, double b) const { return eye + b * direction(t); }
  /// Distance ahead at which the ray meets the line through `a` and `c`.
  double meets_line(double t, const Vec2& a, const Vec2& c) const {
    const Vec2 along = c - a, d = direction(t);
    return ((a - eye).x() * along.y() - (a - eye).y() * along.x()) / (d.x() * along.y() - d.y() * along.x());
  }
};

}  // namespace formwright
