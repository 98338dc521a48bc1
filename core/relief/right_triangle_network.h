// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Larger triangles over a regular grid where it is flat: a right-triangulated irregular network (Evans, Kirkpatrick,
// Townsend 2001). Triangles are right isosceles, named by their corners: a and b at the ends of the hypotenuse, c at
// the right angle; splitting joins c to the middle of a b.
#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>
#include <vector>

#include "base/context.h"

namespace formwright {

struct GridNode {
  int x, y;
};

/// `Deviation`: (a, b, middle) -> float, how far the middle node lies from halfway between a and b.
template <class Deviation>
class RightTriangleNetwork {
 public:
  /// Of at least two columns and two rows. Every node lies within `tolerance` of the triangle that covers it.
  RightTriangleNetwork(int columns, int rows, float tolerance, Deviation deviation)
      : columns_(columns), rows_(rows), tolerance_(tolerance), deviation_(std::move(deviation)) {
    const auto longest = static_cast<unsigned>(std::max(columns, rows) - 1);
    size_ = static_cast<int>(std::bit_ceil(longest));
    bound_.assign(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), 0.0f);
  }

  /// Children before their parents: in squares of every size, from small to large, first the four triangles over the
  /// sides, then the two over the diagonal, which runs to the middle of the square of twice the size.
  void find_bounds(Context& context) {
    for (int side = 2; side <= size_; side *= 2) {
      for_squares(side, context, [&](int x, int y) {
        const GridNode middle{x + side / 2, y + side / 2};
        const GridNode corner[4] = {{x, y}, {x + side, y}, {x + side, y + side}, {x, y + side}};
        for (int k = 0; k < 4; ++k) raise_bound(corner[k], corner[(k + 1) % 4], middle, side > 2);
      });
      for_squares(side, context, [&](int x, int y) {
        GridNode a{x, y}, b{x + side, y + side}, c{x + side, y}, d{x, y + side};
        if ((x / side + y / side) % 2 != 0) {
          std::swap(a, c);
          std::swap(b, d);
        }
        raise_bound(a, b, c, true);
        raise_bound(a, b, d, true);
      });
    }
  }

  std::vector<GridNode> corners;  // three a triangle, counter-clockwise with x right and y up; filled by collect

  void collect() {
    descend({0, 0}, {size_, size_}, {size_, 0});
    descend({size_, size_}, {0, 0}, {0, size_});
  }

 private:
  /// Those that lie on the map at least in part.
  template <class Visit>
  void for_squares(int side, Context& context, Visit&& visit) const {
    for (int y = 0; y < rows_ - 1; y += side) {
      context.check_cancelled();
      for (int x = 0; x < columns_ - 1; x += side) visit(x, y);
    }
  }
  void raise_bound(GridNode a, GridNode b, GridNode c, bool has_children) {
    const GridNode m = between(a, b);
    if (outside(a, b, c) || beyond(m)) return;
    float& bound = bound_at(m);
    if (crosses_edge(a, b, c)) {
      bound = INFINITY;
      return;
    }
    // The children leave the parent's plane by `own` at most, and what they drop lies near their planes.
    const float own = deviation_(a, b, m);
    const float theirs = has_children ? std::max(bound_at(between(a, c)), bound_at(between(b, c))) : 0.0f;
    bound = std::max(bound, own + theirs);
  }
  static GridNode between(GridNode a, GridNode b) { return {(a.x + b.x) / 2, (a.y + b.y) / 2}; }
  float& bound_at(GridNode p) {
    return bound_[static_cast<std::size_t>(p.y) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(p.x)];
  }
  bool beyond(GridNode p) const { return p.x >= columns_ || p.y >= rows_; }
  bool outside(GridNode a, GridNode b, GridNode c) const {
    return std::min({a.x, b.x, c.x}) >= columns_ - 1 || std::min({a.y, b.y, c.y}) >= rows_ - 1;
  }
  bool crosses_edge(GridNode a, GridNode b, GridNode c) const {
    return std::max({a.x, b.x, c.x}) > columns_ - 1 || std::max({a.y, b.y, c.y}) > rows_ - 1;
  }
  void descend(GridNode a, GridNode b, GridNode c) {
    if (outside(a, b, c)) return;
    const GridNode m = between(a, b);
    // Beyond the map's edge there are no bounds: a triangle that reaches there is split.
    if (std::abs(a.x - c.x) + std::abs(a.y - c.y) > 1 && (beyond(m) || bound_at(m) > tolerance_)) {
      descend(c, a, m);
      descend(b, c, m);
      return;
    }
    // a -> b -> c turns clockwise for one half and counter-clockwise for the other nowhere: both start alike.
    const long turn = static_cast<long>(b.x - a.x) * (c.y - a.y) - static_cast<long>(b.y - a.y) * (c.x - a.x);
    corners.push_back(a);
    corners.push_back(turn > 0 ? b : c);
    corners.push_back(turn > 0 ? c : b);
  }

  int columns_, rows_;
  float tolerance_;
  Deviation deviation_;
  int size_ = 1;
  std::vector<float> bound_;
};

}  // namespace formwright
