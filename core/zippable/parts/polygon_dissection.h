// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Triangulations without inner vertices: a polygon given by its boundary walk alone, cut along chords, the pieces
// filled with the triangles whose sides are shortest in sum (dynamic programming: Barequet & Sharir 1995).
#include <array>
#include <functional>
#include <vector>

namespace formwright {

struct Chord {
  int from, to;  // places on the walk, from < to
};

/// Drops chords that cross one that stands before them, repeat one, or join neighbours on the walk of `count` vertices.
std::vector<Chord> without_crossings(const std::vector<Chord>& chords, int count);

/// The polygons into which chords that do not cross divide a polygon of `count` vertices; each ascending, together
/// `chords + 1`.
std::vector<std::vector<int>> dissect(int count, const std::vector<Chord>& chords);

/// Triangles of entries of `polygon`, oriented like it, cheapest in sum: `side(a, b)` is the cost of a diagonal,
/// `triangle(a, b, c)` that of a triangle.
std::vector<std::array<int, 3>> cheapest_triangulation(const std::vector<int>& polygon,
                                                       const std::function<double(int, int)>& side,
                                                       const std::function<double(int, int, int)>& triangle);

}  // namespace formwright
