// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Faces of more than three corners, concave ones too, by clipping ears (Meisters 1975) in the polygon's own plane.
#include <array>
#include <span>
#include <vector>

#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

/// Keeps its buffers from one polygon to the next; not shared between threads.
class PolygonTriangulator {
 public:
  /// Triangles of a polygon with n >= 3 corners in order, as n - 2 triples of numbers into `corners`, wound like the
  /// polygon. The plane is the mean one (Newell), so corners may stray from it a little. Among the ears the one of
  /// the best shape goes first, so no corner collects a fan of slivers; a quadrangle takes its shorter diagonal.
  /// A keyhole (a hole joined by two coincident edges) is fine. For a polygon that crosses itself there is no
  /// right answer: n - 2 triangles come out all the same. Coordinates must be below 1e100 in size.
  /// The result is valid until the next call.
  std::span<const std::array<int, 3>> triangulate(std::span<const Vec3> corners);

 private:
  struct Candidate {
    double quality;
    int corner, stamp;
    bool operator<(const Candidate& other) const {  // of equally good ones the first corner's comes first
      return quality != other.quality ? quality < other.quality : corner > other.corner;
    }
  };

  void quadrangle(std::span<const Vec3> corners);
  void project(std::span<const Vec3> corners);
  void classify();
  void build_grid();
  double quality(int corner) const;
  bool blocked(int corner);
  void consider(int corner);
  void clip(int corner);

  std::vector<std::array<int, 3>> triangles_;
  std::vector<Vec2> points_;
  std::vector<int> previous_, next_, stamp_;
  std::vector<char> alive_, reflex_;
  std::vector<Candidate> heap_;
  int alive_count_ = 0;
  // Point-in-triangle tests before ears are taken unchecked: about a second of them for all polygons together, and as
  // many again for each corner as real polygons need.
  static constexpr std::int64_t max_tests = 200'000'000, tests_per_corner = 2000;
  std::int64_t tests_left_ = max_tests;

  // Reflex corners, the only ones that can lie in an ear, by cell of a uniform grid.
  int grid_columns_ = 1, grid_rows_ = 1;
  Vec2 grid_origin_, grid_scale_;
  std::vector<int> grid_start_, grid_items_;
};

}  // namespace formwright
