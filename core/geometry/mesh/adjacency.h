// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Who touches whom in a triangle mesh. Half-edge h = 3 f + k runs from corner k of face f to corner
// k + 1; every table is sorted, so that equal meshes give equal tables, and is built in O(n + m).
#include <span>
#include <vector>

#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

/// Lists of integers, one a row, stored end to end.
struct IndexLists {
  std::vector<int> first;  // row count + 1
  std::vector<int> items;

  int size() const { return first.empty() ? 0 : static_cast<int>(first.size()) - 1; }
  std::span<const int> operator[](int row) const {
    const auto begin = static_cast<std::size_t>(first[static_cast<std::size_t>(row)]);
    const auto end = static_cast<std::size_t>(first[static_cast<std::size_t>(row) + 1]);
    return {items.data() + begin, end - begin};
  }
};

/// The corner after and before, within the same face.
constexpr int next_halfedge(int h) { return h % 3 == 2 ? h - 2 : h + 1; }
constexpr int previous_halfedge(int h) { return h % 3 == 0 ? h + 2 : h - 1; }

struct Edge {
  int lower, higher;  // vertices, lower < higher (equal only in a face that repeats a vertex)
};

class Adjacency {
 public:
  /// Any triangles, manifold or not. Throws Error{invalid_input, "mesh"} when a face names a vertex
  /// that does not exist.
  explicit Adjacency(const TriangleMesh& mesh);

  int vertex_count() const { return vertex_count_; }
  int face_count() const { return static_cast<int>(from_.size() / 3); }
  int edge_count() const { return static_cast<int>(edges_.size()); }

  int from(int h) const { return from_[static_cast<std::size_t>(h)]; }
  int to(int h) const { return from(next_halfedge(h)); }

  /// The half-edge on the other side where exactly two faces meet and run in opposite directions; otherwise -1:
  /// at the boundary, where three or more faces meet, and where two faces are oriented against each other.
  int opposite(int h) const { return opposite_[static_cast<std::size_t>(h)]; }

  /// Undirected edges, ascending by (lower, higher).
  const std::vector<Edge>& edges() const { return edges_; }
  int edge_of(int h) const { return edge_of_[static_cast<std::size_t>(h)]; }

  /// Half-edges along an edge, ascending: one at the boundary, two inside, more where not manifold.
  std::span<const int> halfedges_of_edge(int e) const { return edge_halfedges_[e]; }
  bool is_boundary_edge(int e) const { return edge_halfedges_[e].size() == 1; }

  /// Index of the edge between two vertices, -1 when there is none. O(log degree).
  int find_edge(int a, int b) const;

  /// Half-edges that leave a vertex (one for each face there), ascending.
  std::span<const int> outgoing(int v) const { return outgoing_[v]; }
  /// Vertices joined to v by an edge (the one-ring), ascending.
  std::span<const int> neighbours(int v) const { return neighbours_[v]; }
  const IndexLists& one_rings() const { return neighbours_; }
  bool is_boundary_vertex(int v) const { return boundary_vertex_[static_cast<std::size_t>(v)] != 0; }

  int boundary_edge_count() const { return boundary_edge_count_; }
  int nonmanifold_edge_count() const { return nonmanifold_edge_count_; }    // three or more faces
  int inconsistent_edge_count() const { return inconsistent_edge_count_; }  // two faces, same direction

  /// Vertices whose faces form more than one fan, ascending.
  std::vector<int> nonmanifold_vertices() const;

  /// Edges and vertices manifold (with boundary), faces oriented alike.
  bool is_manifold() const;
  /// Manifold and without boundary.
  bool is_closed() const { return boundary_edge_count_ == 0 && is_manifold(); }

 private:
  void build_edges();
  void build_rings();

  int vertex_count_ = 0;
  int boundary_edge_count_ = 0, nonmanifold_edge_count_ = 0, inconsistent_edge_count_ = 0;
  std::vector<int> from_, opposite_, edge_of_, first_edge_;  // first_edge_: per lower vertex, n + 1
  std::vector<Edge> edges_;
  IndexLists edge_halfedges_, outgoing_, neighbours_;
  std::vector<char> boundary_vertex_;
};

/// Closed walks of vertices along the boundary in the direction of the faces (the surface lies left).
/// Each begins at its lowest vertex; loops ascend by that vertex. Needs edges that are manifold and
/// oriented alike; at a vertex with several fans the walk stays within one fan.
std::vector<std::vector<int>> boundary_loops(const Adjacency& adjacency);

struct Components {
  std::vector<int> of;  // per item, numbered from 0 in order of each part's first item
  int count = 0;
};

/// Parts connected by edges, per vertex; a vertex without a face is a part of its own.
Components vertex_components(const Adjacency& adjacency);

/// Parts connected across edges, per face (faces that share only a vertex stay apart).
Components face_components(const Adjacency& adjacency);

/// V - E + F over the vertices that faces use.
int euler_characteristic(const Adjacency& adjacency);

/// Handles of all parts together: sum of (2 - chi - loops) / 2. Needs a manifold, oriented mesh.
int genus(const Adjacency& adjacency);

}  // namespace formwright
