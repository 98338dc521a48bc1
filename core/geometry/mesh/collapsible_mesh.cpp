// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh/collapsible_mesh.h"

#include <array>

namespace formwright {

CollapsibleMesh::CollapsibleMesh(const Adjacency& adjacency)
    : corner_(at(3 * adjacency.face_count())),
      opposite_(at(3 * adjacency.face_count())),
      out_(at(adjacency.vertex_count()), -1),
      mark_(at(adjacency.vertex_count()), 0) {
  for (int h = 0; h < 3 * adjacency.face_count(); ++h) {
    corner_[at(h)] = adjacency.from(h);
    opposite_[at(h)] = adjacency.opposite(h);
    int& out = out_[at(adjacency.from(h))];
    if (out < 0 || adjacency.opposite(h) < 0) out = h;
  }
}

int CollapsibleMesh::find(int a, int b) const {
  int found = -1;
  around(a, [&](int h) {
    if (to(h) == b) found = h;
  });
  return found;
}

bool CollapsibleMesh::may_collapse(int h) {
  const int a = from(h), b = to(h), g = opposite(h);
  if (g >= 0 && on_boundary(a) && on_boundary(b)) return false;
  ++current_mark_;
  neighbours(a, [&](int u) { mark_[at(u)] = current_mark_; });
  int common = 0;
  neighbours(b, [&](int u) { common += mark_[at(u)] == current_mark_ ? 1 : 0; });
  if (common != (g >= 0 ? 2 : 1)) return false;
  for (const int side : {h, g}) {
    if (side < 0) continue;
    // The two other sides of the face that vanishes are glued; not when both are boundary (the apex
    // would hang free), nor when they lead to the same apex (a tetrahedron would fold flat).
    const int n = opposite(next_halfedge(side)), p = opposite(previous_halfedge(side));
    if (n < 0 && p < 0) return false;
    if (n >= 0 && p >= 0 && apex(n) == apex(p)) return false;
  }
  return true;
}

void CollapsibleMesh::glue(int g, int h) {
  if (g >= 0) opposite_[at(g)] = h;
  if (h >= 0) opposite_[at(h)] = g;
}

void CollapsibleMesh::set_outgoing(int v, int h) {
  // Turns clockwise to the boundary, if there is one.
  const int start = h;
  while (opposite(h) >= 0) {
    h = next_halfedge(opposite(h));
    if (h == start) break;
  }
  out_[at(v)] = h;
}

void CollapsibleMesh::collapse(int h) {
  const int a = from(h), b = to(h), g = opposite(h);
  std::array<int, 16> local;
  int count = 0;
  std::vector<int> more;
  around(b, [&](int out) {
    if (count < 16) local[static_cast<std::size_t>(count++)] = out;
    else more.push_back(out);
  });
  for (int i = 0; i < count; ++i) corner_[at(local[static_cast<std::size_t>(i)])] = a;
  for (const int out : more) corner_[at(out)] = a;

  std::array<int, 2> apexes{-1, -1}, beside{-1, -1};
  int outgoing_a = -1;
  for (std::size_t side = 0; side < 2; ++side) {
    const int s = side == 0 ? h : g;
    if (s < 0) continue;
    const int n = opposite(next_halfedge(s)), p = opposite(previous_halfedge(s));
    apexes[side] = apex(s);
    // A half-edge along the glued edge, in the face beyond: it runs from or to the apex.
    const int kept = n >= 0 ? n : p;
    const bool from_apex = from(kept) == apexes[side];
    beside[side] = from_apex ? kept : next_halfedge(kept);
    outgoing_a = from_apex ? next_halfedge(kept) : kept;
    glue(n, p);
  }
  for (const int s : {h, g}) {
    if (s < 0) continue;
    for (int k = 0; k < 3; ++k) corner_[at(s - s % 3 + k)] = -1;
  }
  out_[at(b)] = -1;
  set_outgoing(a, outgoing_a);
  for (std::size_t side = 0; side < 2; ++side)
    if (apexes[side] >= 0) set_outgoing(apexes[side], beside[side]);
}

bool CollapsibleMesh::may_flip(int h) const {
  const int g = opposite(h);
  if (g < 0) return false;
  const int c = apex(h), d = apex(g);
  if (c == d) return false;
  bool joined = false;
  neighbours(c, [&](int u) { joined = joined || u == d; });
  return !joined;
}

void CollapsibleMesh::flip(int h) {
  // Faces (a, b, c) and (b, a, d) become (d, c, a) and (c, d, b), as in intrinsic_delaunay.cpp.
  const int g = opposite(h);
  const int h1 = next_halfedge(h), h2 = previous_halfedge(h), g1 = next_halfedge(g), g2 = previous_halfedge(g);
  const int a = from(h), b = to(h), c = apex(h), d = apex(g);
  const int oh1 = opposite(h1), oh2 = opposite(h2), og1 = opposite(g1), og2 = opposite(g2);
  corner_[at(h)] = d;
  corner_[at(h1)] = c;
  corner_[at(h2)] = a;
  corner_[at(g)] = c;
  corner_[at(g1)] = d;
  corner_[at(g2)] = b;
  glue(h1, oh2);  // c -> a
  glue(h2, og1);  // a -> d
  glue(g1, og2);  // d -> b
  glue(g2, oh1);  // b -> c
  if (oh2 < 0) opposite_[at(h1)] = -1;
  if (og1 < 0) opposite_[at(h2)] = -1;
  if (og2 < 0) opposite_[at(g1)] = -1;
  if (oh1 < 0) opposite_[at(g2)] = -1;
  set_outgoing(a, h2);
  set_outgoing(b, g2);
  set_outgoing(c, h1);
  set_outgoing(d, g1);
}

}  // namespace formwright
