// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh/adjacency.h"

#include <algorithm>
#include <limits>

#include "base/error.h"
#include "base/index.h"

namespace formwright {
namespace {

/// Turns counts stored at [row + 1] into the first position of every row.
void accumulate(std::vector<int>& first) {
  for (std::size_t i = 1; i < first.size(); ++i) first[i] += first[i - 1];
}

/// Sorts by the second vertex, keeping half-edges of equal vertices in order. Almost every bucket has
/// about six entries, for which insertion beats everything; a hub of a fan may have thousands.
struct Candidate {
  int higher, halfedge;
};
void sort_bucket(Candidate* begin, Candidate* end) {
  if (end - begin > 48) {
    std::sort(begin, end, [](const Candidate& a, const Candidate& b) {
      return a.higher != b.higher ? a.higher < b.higher : a.halfedge < b.halfedge;
    });
    return;
  }
  for (Candidate* i = begin; i < end; ++i) {
    const Candidate moving = *i;
    Candidate* j = i;
    for (; j > begin && (j - 1)->higher > moving.higher; --j) *j = *(j - 1);
    *j = moving;
  }
}

}  // namespace

Adjacency::Adjacency(const TriangleMesh& mesh) : vertex_count_(mesh.vertex_count()) {
  if (mesh.face_count() > std::numeric_limits<int>::max() / 6)
    throw Error(ErrorCode::invalid_input, "mesh", "The mesh has too many triangles; simplify it first.");
  from_.assign(mesh.F.data(), mesh.F.data() + mesh.F.size());
  for (const int v : from_)
    if (v < 0 || v >= vertex_count_)
      throw Error(ErrorCode::invalid_input, "mesh",
                  "A triangle names vertex " + std::to_string(v) + ", but the mesh has " +
                      std::to_string(vertex_count_) + " vertices; export the mesh again.");
  build_edges();
  build_rings();
}

void Adjacency::build_edges() {
  const int halfedges = static_cast<int>(from_.size());
  std::vector<int> first(index(vertex_count_) + 1, 0);
  for (int h = 0; h < halfedges; ++h) ++first[index(std::min(from(h), to(h))) + 1];
  accumulate(first);
  std::vector<Candidate> candidates(from_.size());
  {
    std::vector<int> slot(first.begin(), first.end() - 1);
    for (int h = 0; h < halfedges; ++h) {
      const int a = from(h), b = to(h);
      candidates[index(slot[index(std::min(a, b))]++)] = {std::max(a, b), h};
    }
  }

  opposite_.assign(from_.size(), -1);
  edge_of_.resize(from_.size());
  edges_.reserve(from_.size() / 2 + 16);
  edge_halfedges_.first.reserve(from_.size() / 2 + 17);
  edge_halfedges_.items.resize(from_.size());
  boundary_vertex_.assign(index(vertex_count_), 0);
  first_edge_.resize(index(vertex_count_) + 1);
  for (int lower = 0; lower < vertex_count_; ++lower) {
    first_edge_[index(lower)] = static_cast<int>(edges_.size());
    const int begin = first[index(lower)], end = first[index(lower) + 1];
    sort_bucket(candidates.data() + begin, candidates.data() + end);
    for (int i = begin; i < end;) {
      const int higher = candidates[index(i)].higher;
      const int edge = static_cast<int>(edges_.size());
      edges_.push_back({lower, higher});
      edge_halfedges_.first.push_back(i);
      int j = i;
      for (; j < end && candidates[index(j)].higher == higher; ++j) {
        edge_halfedges_.items[index(j)] = candidates[index(j)].halfedge;
        edge_of_[index(candidates[index(j)].halfedge)] = edge;
      }
      const int h = candidates[index(i)].halfedge;
      if (j - i == 1) {
        ++boundary_edge_count_;
        boundary_vertex_[index(lower)] = boundary_vertex_[index(higher)] = 1;
      } else if (j - i > 2) {
        ++nonmanifold_edge_count_;
      } else if (const int g = candidates[index(i) + 1].halfedge; from(h) == from(g) || lower == higher) {
        ++inconsistent_edge_count_;
      } else {
        opposite_[index(h)] = g;
        opposite_[index(g)] = h;
      }
      i = j;
    }
  }
  edge_halfedges_.first.push_back(static_cast<int>(from_.size()));
  first_edge_[index(vertex_count_)] = static_cast<int>(edges_.size());
}

void Adjacency::build_rings() {
  outgoing_.first.assign(index(vertex_count_) + 1, 0);
  for (const int v : from_) ++outgoing_.first[index(v) + 1];
  accumulate(outgoing_.first);
  outgoing_.items.resize(from_.size());
  std::vector<int> slot(outgoing_.first.begin(), outgoing_.first.end() - 1);
  for (std::size_t h = 0; h < from_.size(); ++h) outgoing_.items[index(slot[index(from_[h])]++)] = static_cast<int>(h);

  neighbours_.first.assign(index(vertex_count_) + 1, 0);
  for (const Edge& edge : edges_) {
    if (edge.lower == edge.higher) continue;
    ++neighbours_.first[index(edge.lower) + 1];
    ++neighbours_.first[index(edge.higher) + 1];
  }
  accumulate(neighbours_.first);
  neighbours_.items.resize(index(neighbours_.first.back()));
  slot.assign(neighbours_.first.begin(), neighbours_.first.end() - 1);
  // Edges ascend, so each ring comes out sorted: first the lower neighbours, then the higher ones.
  for (const Edge& edge : edges_) {
    if (edge.lower == edge.higher) continue;
    neighbours_.items[index(slot[index(edge.lower)]++)] = edge.higher;
    neighbours_.items[index(slot[index(edge.higher)]++)] = edge.lower;
  }
}

int Adjacency::find_edge(int a, int b) const {
  const int lower = std::min(a, b), higher = std::max(a, b);
  const auto begin = edges_.begin() + first_edge_[index(lower)], end = edges_.begin() + first_edge_[index(lower) + 1];
  const auto found = std::lower_bound(begin, end, higher, [](const Edge& edge, int v) { return edge.higher < v; });
  return found != end && found->higher == higher ? static_cast<int>(found - edges_.begin()) : -1;
}

std::vector<int> Adjacency::nonmanifold_vertices() const {
  std::vector<int> result;
  for (int v = 0; v < vertex_count_; ++v) {
    const auto out = outgoing(v);
    if (out.empty()) continue;
    // Turn from the first corner both ways; a single fan meets every corner.
    std::size_t met = 1;
    int h = opposite(previous_halfedge(out[0]));
    for (; h >= 0 && h != out[0] && met <= out.size(); h = opposite(previous_halfedge(h))) ++met;
    if (h < 0)
      for (int g = opposite(out[0]); g >= 0 && met <= out.size(); g = opposite(next_halfedge(g))) ++met;
    if (met != out.size()) result.push_back(v);
  }
  return result;
}

bool Adjacency::is_manifold() const {
  return nonmanifold_edge_count_ == 0 && inconsistent_edge_count_ == 0 && nonmanifold_vertices().empty();
}

std::vector<std::vector<int>> boundary_loops(const Adjacency& adjacency) {
  std::vector<std::vector<int>> loops;
  if (adjacency.boundary_edge_count() == 0) return loops;
  const int halfedges = 3 * adjacency.face_count();
  const auto on_boundary = [&](int h) { return adjacency.is_boundary_edge(adjacency.edge_of(h)); };
  std::vector<char> walked(index(halfedges), 0);
  for (int start = 0; start < halfedges; ++start) {
    if (walked[index(start)] || !on_boundary(start)) continue;
    std::vector<int> loop;
    int h = start;
    do {
      walked[index(h)] = 1;
      loop.push_back(adjacency.from(h));
      h = next_halfedge(h);
      // Turn about the far end, through its faces, to the boundary edge that leaves it.
      while (!on_boundary(h)) {
        const int across = adjacency.opposite(h);
        if (across < 0)
          throw Error(ErrorCode::invalid_input, "mesh",
                      "The boundary cannot be followed because the mesh is not manifold; repair it first.");
        h = next_halfedge(across);
      }
    } while (h != start && !walked[index(h)]);
    std::rotate(loop.begin(), std::min_element(loop.begin(), loop.end()), loop.end());
    loops.push_back(std::move(loop));
  }
  std::sort(loops.begin(), loops.end());
  return loops;
}

namespace {

/// Disjoint sets whose root is the lowest member.
struct DisjointSets {
  std::vector<int> parent;
  explicit DisjointSets(int count) : parent(index(count)) {
    for (std::size_t i = 0; i < parent.size(); ++i) parent[i] = static_cast<int>(i);
  }
  int root(int i) {
    while (parent[index(i)] != i) i = parent[index(i)] = parent[index(parent[index(i)])];
    return i;
  }
  void join(int a, int b) {
    a = root(a);
    b = root(b);
    if (a != b) parent[index(std::max(a, b))] = std::min(a, b);
  }
  Components numbered() {
    Components components;
    components.of.resize(parent.size());
    for (std::size_t i = 0; i < parent.size(); ++i) {
      const int r = root(static_cast<int>(i));
      components.of[i] = r == static_cast<int>(i) ? components.count++ : components.of[index(r)];
    }
    return components;
  }
};

}  // namespace

Components vertex_components(const Adjacency& adjacency) {
  DisjointSets sets(adjacency.vertex_count());
  for (const Edge& edge : adjacency.edges()) sets.join(edge.lower, edge.higher);
  return sets.numbered();
}

Components face_components(const Adjacency& adjacency) {
  DisjointSets sets(adjacency.face_count());
  for (int e = 0; e < adjacency.edge_count(); ++e) {
    const auto along = adjacency.halfedges_of_edge(e);
    for (std::size_t i = 1; i < along.size(); ++i) sets.join(along[0] / 3, along[i] / 3);
  }
  return sets.numbered();
}

int euler_characteristic(const Adjacency& adjacency) {
  int used = 0;
  for (int v = 0; v < adjacency.vertex_count(); ++v) used += adjacency.outgoing(v).empty() ? 0 : 1;
  return used - adjacency.edge_count() + adjacency.face_count();
}

int genus(const Adjacency& adjacency) {
  if (adjacency.face_count() == 0) return 0;
  const int loops = static_cast<int>(boundary_loops(adjacency).size());
  return (2 * face_components(adjacency).count - euler_characteristic(adjacency) - loops) / 2;
}

}  // namespace formwright
