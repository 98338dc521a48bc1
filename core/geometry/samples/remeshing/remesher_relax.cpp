// SPDX-License-Identifier: GPL-3.0-or-later
// Steps of Remesher that move vertices: over the surface to even triangles, and onto the shape.
#include "geometry/samples/remeshing/remesher.h"

#include <bit>
#include <cmath>
#include <cstdint>

#include "base/index.h"
#include "base/parallel.h"

namespace formwright::samples {

Point Remesher::limited(const Point& from, const Point& to) const {
  const Point step = to - from;
  const double l2 = length2(step), maximum = 0.3 * scale_;
  return l2 <= maximum * maximum ? to : from + step * (maximum / std::sqrt(l2));
}

void Remesher::relax(double step, bool chord) {
  const int vertices = s_.vertex_slots(), faces = s_.halfedge_slots() / 3;
  normals_.resize(index(faces));
  parallel_for(index(faces), grain, [&](std::size_t from, std::size_t to) {
    for (std::size_t f = from; f < to; ++f) {
      const int h = static_cast<int>(3 * f);
      if (s_.alive(h))
        normals_[f] = normal_of(s_.point(s_.start(h)), s_.point(s_.start(h + 1)), s_.point(s_.start(h + 2)));
    }
  });
  moved_.resize(index(vertices));
  if (!chord) slopes_.clear();
  slopes_.resize(index(vertices));
  parallel_for(index(vertices), grain, [&](std::size_t from, std::size_t to) {
    context_.check_cancelled();
    for (std::size_t v = from; v < to; ++v)
      if (s_.vertex_alive(static_cast<int>(v)) && static_cast<int>(v) != ghost_)
        moved_[v] = relaxed(static_cast<int>(v), step, slopes_[v]);
  });
  for (int v = 0; v < vertices; ++v)
    if (s_.vertex_alive(v) && v != ghost_) s_.move(v, moved_[index(v)]);
}

Point Remesher::relaxed(int v, double step, Point& slope) const {
  const Point& p = s_.point(v);
  const std::uint32_t patches = s_.patches(v);
  const int meeting = std::popcount(patches), begin = s_.out(v);
  if (meeting > 2) return p;
  Point centre{0, 0, 0}, normal{0, 0, 0};
  double total = 0;
  int h = begin;
  do {
    if (meeting == 2) {
      if (s_.is_feature(h)) {
        centre += s_.point(s_.end(h));
        total += 1;
      }
    } else {
      // Centroids of the triangles around, by area: evens out sizes as well as angles.
      const Point& n = normals_[index(h / 3)];
      const double area = length(n);
      centre += (p + s_.point(s_.end(h)) + s_.point(s_.start(s_.previous(h)))) * (area / 3);
      normal += n;
      total += area;
    }
    h = s_.rotate(h);
  } while (h != begin);
  if (total <= 0) return p;
  Point move = centre / total - p;
  if (meeting == 1) {
    const double n2 = length2(normal);
    if (n2 > 0) move -= normal * (dot(move, normal) / n2);
    move = move * 1.3;  // the centroid includes p itself: over-relax
  }
  const Point there = limited(p, p + move);
  return limited(there, shape_.project(there, patches, step * scale_, slope));
}

void Remesher::polish() {
  const int vertices = s_.vertex_slots();
  slopes_.clear();
  slopes_.resize(index(vertices));
  for (double step : {1e-2, 1e-3, 1e-3}) {
    parallel_for(index(vertices), grain, [&](std::size_t from, std::size_t to) {
      context_.check_cancelled();
      for (std::size_t i = from; i < to; ++i) {
        const int v = static_cast<int>(i);
        if (!s_.vertex_alive(v) || v == ghost_) continue;
        const Point p = s_.point(v);
        Point q = shape_.project(p, s_.patches(v), step * edge_, slopes_[i]);
        const double maximum = 0.1 * edge_;
        if (distance2(p, q) > maximum * maximum) q = p + (q - p) * (maximum / length(q - p));
        s_.move(v, q);
      }
    });
  }
}

}  // namespace formwright::samples
