// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A solid as an ordered list of strokes on a distance field: add clay, carve, raise or press. Each stroke
// acts inside a ball only, so a point evaluates the few strokes whose balls reach its cell of a grid.
#include <functional>
#include <memory>
#include <vector>

#include "geometry/samples/sculpting/point.h"
#include "geometry/samples/sculpting/primitives.h"

namespace formwright::samples {

using Field = std::function<double(const Point&)>;

/// What the surface extraction and the remesher need to know of a shape.
struct ImplicitShape {
  Field field;                 // mm, negative inside, gradient near 1 at the surface
  Box bounds;                  // encloses the surface with some room
  double lipschitz = 1.5;      // |f(p) - f(q)| <= lipschitz |p - q| wherever |f| is small
  double largest_cell_mm = 2;  // a coarser grid could miss limbs or merge them
};

class Sculpture {
 public:
  /// Lengths of strokes are in `unit_mm` millimetres; `bounds` in units encloses everything.
  Sculpture(double unit_mm, const Box& bounds);

  /// Smooth union with a solid that lies inside the ball (centre, radius).
  void unite(double softness, const Point& centre, double radius, Field solid);
  /// Smooth removal of such a solid.
  void carve(double softness, const Point& centre, double radius, Field solid);
  /// Pushes the surface outwards by `height` (a field that vanishes outside the ball), at most by `greatest`.
  void raise(const Point& centre, double radius, Field height, double greatest = 1e30);

  // The usual strokes, each also at the mirror image in x when `twin`.
  void add_ellipsoid(double softness, const Frame& frame, const Point& radii, bool twin = false);
  void carve_ellipsoid(double softness, const Frame& frame, const Point& radii, bool twin = false);
  void add_cone(double softness, const Point& a, const Point& b, double ra, double rb, bool twin = false);
  /// Bell-shaped swelling (or dent, for a negative height) of semi-axes `radii`.
  void swell(double height, const Frame& frame, const Point& radii, bool twin = false);
  /// Ridge (height > 0) or crease (height < 0) of half-width `width` along a polyline; both fade to
  /// nothing over the first and last `fade` of its length.
  void line(double height, double width, const std::vector<Point>& path, double fade = 0.2, bool twin = false);

  /// The path moved onto the surface as it is now, along its normals.
  std::vector<Point> dropped(std::vector<Point> path) const;

  /// Builds the grid; no stroke may follow.
  void finish();

  /// The field in mm at a point in mm.
  double operator()(const Point& p_mm) const;
  /// The same in units, usable before finish() too (slow then): what lies under later strokes.
  double at(const Point& p) const;
  Point normal_at(const Point& p, double step) const;

 private:
  enum class Operation : unsigned char { unite, carve, raise };
  struct Stroke {
    Operation operation;
    double softness;  // of a raise: its greatest height
    Point centre;
    double radius;
    Field field;
  };
  double apply(const Stroke& stroke, const Point& p, double d) const;
  double unit_mm_;
  Box bounds_;
  double margin_ = 0;  // where the field is larger than this it is only a bound
  double cell_ = 1;
  int cells_[3] = {0, 0, 0};
  std::vector<Stroke> strokes_;
  std::vector<int> first_;  // per cell, into entries_
  std::vector<int> entries_;
};

/// Samples of a Catmull-Rom curve through `knots`, `per_span` pieces each.
std::vector<Point> curve(const std::vector<Point>& knots, int per_span = 6);

/// A strip of clay along a curve: a lock of hair, a fold, a limb.
struct Tube {
  std::vector<Point> path;
  std::vector<double> radius;  // per path point
  std::vector<Point> up;       // per path point, unit normals of what it lies on; may be empty
  double flatness = 1;         // height over width of the section along `up`
  double strands = 0;          // grooves across the width
  double groove = 0;           // their depth, as a fraction of the local radius
  double phase = 0;

  double operator()(const Point& p) const;
  /// Ball around the tube.
  void enclose(Point& centre, double& ball_radius) const;
};

}  // namespace formwright::samples
