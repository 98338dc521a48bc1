// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Charts of a surface for its texture: views along the six axes, peeled into layers where one would hide another, laid
// out on one square.
#include <array>
#include <functional>
#include <vector>

#include "base/context.h"
#include "geometry/samples/shapes.h"

namespace formwright::samples {

/// Connected faces that are all seen from one side, none of them behind another.
struct Chart {
  int view = 0;
  std::vector<int> faces;
  Point low{1e30, 1e30, 0}, high{-1e30, -1e30, 0};  // in the picture, mm
  double u = 0, v = 0;                              // place of `low` on the sheet, mm
  double width() const { return high.x - low.x; }
  double height() const { return high.y - low.y; }
};

class Atlas {
 public:
  Atlas(const Model& model, const std::function<Point(const Point&)>& broad_normal, Context& context);

  /// View k looks against axis k / 2 (x, y, z), from its positive side for even k. Two coordinates of the picture and
  /// the depth towards the viewer, right-handed, so that a face seen from its front is counter-clockwise.
  static Point seen(int view, const Point& p);

  std::vector<Chart>& charts() { return charts_; }
  Point vertex(int v) const { return {V_(v, 0), V_(v, 1), V_(v, 2)}; }
  Point corner(int f, int c) const { return vertex(F_(f, c)); }

  /// Rows of charts, tallest first, on a square sheet; returns its side in mm.
  double pack(double gap);

 private:
  void choose_views(const std::function<Point(const Point&)>& broad_normal);
  bool faces_viewer(int f, int view) const;
  // Faces behind others of the same view go to the next layer, until none is hidden.
  void peel();
  // Connected faces of one view and layer make a chart; crumbs join a neighbour that can see them.
  void collect();

  const Positions& V_;
  const Triangles& F_;
  std::vector<std::array<int, 3>> beside_;
  Context& context_;
  std::vector<int> view_, layer_;
  std::vector<Chart> charts_;
};

}  // namespace formwright::samples
