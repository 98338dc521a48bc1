// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A manifold mesh whose edges can be collapsed and flipped in place. Half-edges h = 3 f + k as in
// Adjacency; faces and vertices die but are not moved until extracted.
#include <utility>
#include <vector>

#include "geometry/mesh/adjacency.h"
#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

class CollapsibleMesh {
 public:
  /// Needs manifold edges and vertices and faces oriented alike.
  explicit CollapsibleMesh(const Adjacency& adjacency);

  int vertex_count() const { return static_cast<int>(out_.size()); }
  int face_count() const { return static_cast<int>(corner_.size() / 3); }
  bool has_face(int f) const { return corner_[at(3 * f)] >= 0; }
  bool has_vertex(int v) const { return out_[at(v)] >= 0; }
  int from(int h) const { return corner_[at(h)]; }
  int to(int h) const { return corner_[at(next_halfedge(h))]; }
  int apex(int h) const { return corner_[at(previous_halfedge(h))]; }
  int opposite(int h) const { return opposite_[at(h)]; }
  /// A half-edge that leaves v; the boundary one where v is on the boundary.
  int outgoing(int v) const { return out_[at(v)]; }
  bool on_boundary(int v) const { return opposite(out_[at(v)]) < 0; }

  /// Calls visit(h) for every half-edge that leaves v, counter-clockwise.
  template <class Visit>
  void around(int v, Visit&& visit) const {
    const int start = outgoing(v);
    for (int h = start; h >= 0;) {
      visit(h);
      h = opposite(previous_halfedge(h));
      if (h == start) break;
    }
  }
  /// Calls visit(u) for every vertex joined to v.
  template <class Visit>
  void neighbours(int v, Visit&& visit) const {
    const int start = outgoing(v);
    for (int h = start; h >= 0;) {
      visit(to(h));
      const int before = previous_halfedge(h);
      h = opposite(before);
      if (h < 0) visit(from(before));
      if (h == start) break;
    }
  }
  /// The half-edge from a to b, -1 when there is none (a boundary edge has one direction only).
  int find(int a, int b) const;

  /// The link condition (Dey, Edelsbrunner, Guha, Nekhayev 1999): collapsing keeps the topology.
  bool may_collapse(int h);
  /// Merges to(h) into from(h); two faces die, one at the boundary.
  void collapse(int h);

  /// Both faces stay triangles of four different vertices and the new edge is not there yet.
  bool may_flip(int h) const;
  /// Replaces the edge by the one between the two apexes.
  void flip(int h);

 private:
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }
  void glue(int g, int h);
  void set_outgoing(int v, int h);

  std::vector<int> corner_, opposite_, out_;
  std::vector<int> mark_;  // per vertex, for may_collapse
  int current_mark_ = 0;
};

}  // namespace formwright
