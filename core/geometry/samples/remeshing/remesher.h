// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The steps of remesh(): one surface on its way to even triangles.
#include <cstddef>
#include <vector>

#include "base/context.h"
#include "geometry/samples/remeshing/remesh.h"

namespace formwright::samples {

class Remesher {
 public:
  /// `ghost`: the vertex that closes a surface with a boundary; -1 for a closed surface.
  Remesher(const Surface& surface, const std::vector<int>& patch, const TargetShape& shape, int target, int ghost,
           Context& context);

  Surface run(std::vector<int>& patch);

 private:
  static constexpr std::size_t grain = 2048;

  static double cotangent(const Point& apex, const Point& p, const Point& q) {
    const Point u = p - apex, v = q - apex;
    const double twice_area = length(cross(u, v));
    return twice_area > 1e-300 ? dot(u, v) / twice_area : 1e6;
  }

  static Point normal_of(const Point& a, const Point& b, const Point& c) { return cross(b - a, c - a); }

  // a . b > minimum |a| |b|
  static bool agree(const Point& a, const Point& b, double minimum) {
    const double d = dot(a, b), product = length2(a) * length2(b);
    return d > 0 && d * d > minimum * minimum * product;
  }

  // A surface with a boundary is closed by triangles to one vertex, the ghost, which has no place in space.
  bool touches_ghost(int h) const {
    return ghost_ >= 0 && (s_.start(h) == ghost_ || s_.end(h) == ghost_ || s_.start(s_.previous(h)) == ghost_);
  }
  // An edge that may be looked at: alive and between two real vertices.
  bool real(int h) const { return s_.alive(h) && (ghost_ < 0 || (s_.start(h) != ghost_ && s_.end(h) != ghost_)); }

  // Once in a while within a loop over half-edges.
  void poll(int h) const {
    if ((h & 0x3fff) == 0) context_.check_cancelled();
  }

  Point limited(const Point& from, const Point& to) const;

  // ---- how many edges there are, and how long (remesher_edges.cpp)
  double longest_edge() const;
  void split_long(double factor) { split_longer_than(factor * edge_); }
  void split_longer_than(double length);
  void split_at_middle(int h);
  void collapse_short(double factor);
  bool try_collapse(int h, double longest);
  // Moving `v` (an end of h) to p turns no remaining triangle over and makes no edge too long.
  bool survives(int h, int v, const Point& p, double limit) const;
  // Collapses the shortest edge of triangles with an angle below about 24 degrees.
  void dissolve_slivers();
  // Splits the longest or collapses the shortest edges until the count is right.
  void match_count();

  // ---- which diagonal (remesher_flips.cpp)
  // The edge may turn: not a feature, not folded, the other diagonal free and its triangles sound.
  bool can_flip(int h) const;
  void flip_by_valence();
  void flip_to_delaunay();

  // ---- where vertices lie (remesher_relax.cpp)
  void relax(double step, bool chord);
  Point relaxed(int v, double step, Point& slope) const;
  void polish();

  HalfedgeSurface s_;
  const TargetShape& shape_;
  int target_, ghost_;
  Context& context_;
  double edge_;       // wanted mean length
  double scale_ = 0;  // the length now, on the way there
  std::vector<Point> normals_, moved_, slopes_;
};

}  // namespace formwright::samples
