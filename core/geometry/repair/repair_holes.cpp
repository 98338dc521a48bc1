// SPDX-License-Identifier: GPL-3.0-or-later
// Filling holes: the triangulation of a boundary loop with the least fold, then the least area.
// Barequet & Sharir 1995; Liepa 2003, "Filling Holes in Meshes", Sec. 3.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/index.h"
#include "geometry/mesh/adjacency.h"
#include "geometry/repair/repair_steps.h"

namespace formwright::repair_steps {
namespace {

struct Weight {
  double fold = 0;  // largest 1 - cos of the angle between neighbouring normals
  double area = 0;
  bool operator<(const Weight& other) const { return fold != other.fold ? fold < other.fold : area < other.area; }
};
constexpr double impossible = std::numeric_limits<double>::infinity();

struct Loop {
  const Draft& draft;
  const Adjacency& adjacency;
  std::vector<int> vertex;   // against the direction of the surrounding faces
  std::vector<Vec3> normal;  // of the face beyond the side from vertex i to i + 1
  int size() const { return static_cast<int>(vertex.size()); }
  Vec3 at(int i) const { return draft.position(vertex[index(i)]); }
};

Vec3 unit_normal(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 n = (b - a).cross(c - a);
  const double length = n.norm();
  return length > 0 ? Vec3(n / length) : Vec3(0, 0, 0);
}

/// Triangles (three positions in the loop each); empty when the loop cannot be filled without an edge
/// that the mesh already has.
std::vector<int> triangulate(const Loop& loop, Context& context) {
  const int k = loop.size();
  const auto cell = [k](int i, int j) { return index(i) * index(k) + index(j); };
  std::vector<Weight> weight(index(k) * index(k));
  std::vector<int> apex(index(k) * index(k), -1);
  for (int span = 2; span < k; ++span) {
    context.check_cancelled();
    for (int i = 0; i + span < k; ++i) {
      const int j = i + span;
      Weight best{impossible, impossible};
      const bool outer = i == 0 && j == k - 1;  // the last side of the loop itself
      if (outer || loop.adjacency.find_edge(loop.vertex[index(i)], loop.vertex[index(j)]) < 0)
        for (int middle = i + 1; middle < j; ++middle) {
          const Weight &left = weight[cell(i, middle)], &right = weight[cell(middle, j)];
          if (left.fold == impossible || right.fold == impossible) continue;
          const Vec3 a = loop.at(i), b = loop.at(middle), c = loop.at(j), n = unit_normal(a, b, c);
          if (n.isZero(0)) continue;
          // The neighbour across i-middle is the face beyond the boundary, or the triangle chosen there.
          const auto beside = [&](int p, int q) {
            if (q == p + 1) return loop.normal[index(p)];
            return unit_normal(loop.at(p), loop.at(apex[cell(p, q)]), loop.at(q));
          };
          double fold = std::max({left.fold, right.fold, 1 - n.dot(beside(i, middle)), 1 - n.dot(beside(middle, j))});
          if (outer) fold = std::max(fold, 1 - n.dot(loop.normal[index(k - 1)]));
          const Weight candidate{fold, left.area + right.area + 0.5 * (b - a).cross(c - a).norm()};
          if (candidate < best) {
            best = candidate;
            apex[cell(i, j)] = middle;
          }
        }
      weight[cell(i, j)] = best;
    }
  }
  // Not when it would only lie back on the surface, as over the rim of a flat sheet.
  if (weight[cell(0, k - 1)].fold > 2 - 1e-6) return {};
  std::vector<int> triangles;
  std::vector<std::pair<int, int>> stack{{0, k - 1}};
  while (!stack.empty()) {
    const auto [i, j] = stack.back();
    stack.pop_back();
    if (j - i < 2) continue;
    const int middle = apex[cell(i, j)];
    triangles.insert(triangles.end(), {i, middle, j});
    stack.push_back({i, middle});
    stack.push_back({middle, j});
  }
  return triangles;
}

}  // namespace

FillCount fill_holes(Draft& draft, int max_edges, Context& context) {
  FillCount count;
  const Adjacency adjacency(draft.mesh);
  std::vector<int> corners, old_faces, old_corners;
  // Two holes that share vertices must not both be given the same new edge.
  std::vector<char> taken(index(draft.mesh.vertex_count()), 0);
  for (const std::vector<int>& boundary : boundary_loops(adjacency)) {
    if (static_cast<int>(boundary.size()) > max_edges) continue;
    if (std::any_of(boundary.begin(), boundary.end(), [&](int v) { return taken[index(v)] != 0; })) continue;
    Loop loop{draft, adjacency, {boundary.rbegin(), boundary.rend()}, {}};
    std::vector<int> beyond;  // a boundary half-edge, which starts at loop vertex i + 1, per side
    for (int i = 0; i < loop.size(); ++i) {
      const int from = loop.vertex[index((i + 1) % loop.size())], to = loop.vertex[index(i)];
      const int h = adjacency.halfedges_of_edge(adjacency.find_edge(from, to))[0];
      beyond.push_back(h);
      const auto corner = [&](int k) { return draft.position(draft.mesh.F(h / 3, k)); };
      loop.normal.push_back(unit_normal(corner(0), corner(1), corner(2)));
    }
    const std::vector<int> triangles = triangulate(loop, context);
    if (triangles.empty()) continue;
    ++count.holes;
    count.faces += static_cast<int>(triangles.size() / 3);
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      const int position = triangles[i];
      corners.push_back(loop.vertex[index(position)]);
      // The corner of the surrounding face at this vertex lends its attributes.
      old_corners.push_back(draft.corner_of[index(beyond[index((position + loop.size() - 1) % loop.size())])]);
      if (i % 3 == 0) old_faces.push_back(-1);
    }
    for (const int v : boundary) taken[index(v)] = 1;
  }
  draft.add_faces(corners, old_faces, old_corners);
  return count;
}

}  // namespace formwright::repair_steps
