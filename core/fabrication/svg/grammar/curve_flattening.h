// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Curves as polylines that keep to them within a tolerance.
#include <Eigen/Geometry>
#include <vector>

#include "fabrication/svg/grammar/drawing_limits.h"
#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

/// One subpath after the other, through `to_mm`, as polylines in mm; the tolerance holds after the map. Throws
/// Error{invalid_input, "drawing"}: farther than max_coordinate_mm, too many points.
class CurveFlattener {
 public:
  struct Subpath {
    std::vector<Vec2> points_mm;
    bool closed = false;
  };
  CurveFlattener(const Eigen::Affine2d& to_mm, double tolerance_mm, DrawingLimits& limits)
      : to_mm_(to_mm), tolerance_mm_(tolerance_mm), limits_(limits) {}

  void move_to(const Vec2& p);
  void line_to(const Vec2& p);
  /// Uniform steps h of the parameter, whose chords keep within h^2/8 max|B''| of the curve.
  void cubic_to(const Vec2& control_1, const Vec2& control_2, const Vec2& p);
  /// As SVG's A: half axes, turn of the first one, larger and positive-angle choice (SVG 1.1, F.6).
  void arc_to(double rx, double ry, double turn_degrees, bool large, bool sweep, const Vec2& p);
  /// A whole ellipse from its rightmost point on, in the direction of growing angles.
  void ellipse(const Vec2& centre, double rx, double ry);
  void close();

  /// Subpaths of at least two different points; the flattener is empty afterwards.
  std::vector<Subpath> take();

 private:
  void add(const Vec2& p);
  void begin_if_closed();
  Vec2 in_reach(const Vec2& p) const;  // in mm
  int arc_steps(double largest_radius, double angle) const;

  Eigen::Affine2d to_mm_;
  double tolerance_mm_;
  DrawingLimits& limits_;
  std::vector<Subpath> subpaths_;
  Vec2 start_{0, 0}, current_{0, 0};
  bool open_ = false;
};

}  // namespace formwright
