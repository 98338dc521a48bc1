// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Shapes laid onto as few sheets as they go, each as far to the left and then as low as it fits, the largest first.
//
// Sheets are bitmaps whose cells a shape takes wherever it, grown by half the spacing, might touch them: what does not
// share a cell keeps the spacing, whatever the shape, hollows of spirals included. (libnest2d, the packaged library,
// brings Clipper, NLopt and Boost's R-tree along for solutions that depend on its time limit.)
#include <vector>

#include "base/context.h"
#include "fabrication/planar/polygon.h"

namespace formwright {

struct NestingOptions {
  double bed_x_mm = 600, bed_y_mm = 300;  // of one sheet
  double margin_mm = 5;                   // kept free along its edges
  double spacing_mm = 2;                  // between shapes
  bool keep_direction = false;            // long side along x, in either direction; otherwise it turns freely
};

/// A shape's point p lies at turn * p + shift_mm of its sheet.
struct Nested {
  int sheet = 0;
  Eigen::Matrix2d turn = Eigen::Matrix2d::Identity();
  Vec2 shift_mm{0, 0};

  Vec2 operator()(const Vec2& p) const { return turn * p + shift_mm; }
};

struct Nesting {
  std::vector<Nested> places;  // per shape
  int sheet_count = 0;
  double cell_mm = 0;
};

/// The side of a bitmap's cell: a shape fits its sheet when it has three of them to spare.
double nesting_cell_mm(const NestingOptions& options);

/// Directions that lay the shape with this convex hull into a rectangle of `x_mm` by `y_mm`: angles by which to turn
/// it, in radians, at most four; the tightest first. Empty: it does not fit.
std::vector<double> fitting_turns(const Polygon& hull, double x_mm, double y_mm, bool keep_direction);

/// Places simple polygons. Throws Error: invalid_input ("bed_x_mm": one of them does not fit a sheet), cancelled.
Nesting nest(const std::vector<Polygon>& shapes, const NestingOptions& options, Context& context);

}  // namespace formwright
