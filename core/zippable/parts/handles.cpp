// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/parts/handles.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <queue>

#include "base/error.h"
#include "geometry/mesh/adjacency.h"
#include "geometry/paths/geodesic_distance.h"

namespace formwright {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

struct Loop {
  double length = infinite;
  std::vector<int> vertices;
};

int root_of(std::vector<int>& parent, int i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

/// The shortest of the generators that a tree of shortest paths from `root` gives. Openings count as faces; paths keep
/// off them.
Loop shortest_loop(const TriangleMesh& mesh, const Adjacency& adjacency, int root) {
  const int n = mesh.vertex_count(), m = mesh.face_count();
  std::vector<double> distance(n, infinite);
  std::vector<int> before(n, -1);
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  distance[root] = 0;
  queue.emplace(0, root);
  while (!queue.empty()) {
    const auto [d, v] = queue.top();
    queue.pop();
    if (d > distance[v]) continue;
    for (const int w : adjacency.neighbours(v)) {
      if (adjacency.is_boundary_vertex(w)) continue;
      const double reach = d + (mesh.V.row(w) - mesh.V.row(v)).norm();
      if (reach < distance[w]) distance[w] = reach, before[w] = v, queue.emplace(reach, w);
    }
  }
  const auto loop_length = [&](int e) {
    const auto [a, b] = adjacency.edges()[e];
    return distance[a] + distance[b] + (mesh.V.row(a) - mesh.V.row(b)).norm();
  };
  std::vector<int> order;
  for (int e = 0; e < adjacency.edge_count(); ++e) {
    const auto [a, b] = adjacency.edges()[e];
    if (before[a] != b && before[b] != a) order.push_back(e);
  }
  std::vector<double> length(adjacency.edge_count(), 0);
  for (const int e : order) length[e] = loop_length(e);
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return length[a] != length[b] ? length[a] > length[b] : a < b; });
  const auto openings = boundary_loops(adjacency);
  std::vector<int> opening_of(n, -1);
  for (std::size_t i = 0; i < openings.size(); ++i)
    for (const int v : openings[i]) opening_of[v] = static_cast<int>(i);
  std::vector<int> parent(m + openings.size());
  std::iota(parent.begin(), parent.end(), 0);
  Loop best;
  for (const int e : order) {
    const auto halfedges = adjacency.halfedges_of_edge(e);
    const int left = halfedges[0] / 3,
              right = halfedges.size() == 2 ? halfedges[1] / 3 : m + opening_of[adjacency.edges()[e].lower];
    const int a = root_of(parent, left), b = root_of(parent, right);
    if (a != b) {
      parent[a] = b;
      continue;
    }
    if (!(length[e] < best.length)) continue;
    // The two paths to the root, without what they share.
    const auto path_up = [&](int v) {
      std::vector<int> path;
      for (; v >= 0; v = before[v]) path.push_back(v);
      return path;
    };
    std::vector<int> one = path_up(adjacency.edges()[e].lower), other = path_up(adjacency.edges()[e].higher);
    while (one.size() > 1 && other.size() > 1 && one[one.size() - 2] == other[other.size() - 2])
      one.pop_back(), other.pop_back();
    best.vertices = one;
    best.vertices.insert(best.vertices.end(), other.rbegin() + 1, other.rend());
    best.length = length[e];
  }
  best.length = 0;
  for (std::size_t i = 0; i < best.vertices.size(); ++i)
    best.length += (mesh.V.row(best.vertices[i]) - mesh.V.row(best.vertices[(i + 1) % best.vertices.size()])).norm();
  if (best.vertices.size() < 3) best.length = infinite;
  return best;
}

/// Gives the faces on the right of the walk, a loop or from one opening to another, vertices of their own.
void cut_along(TriangleMesh& mesh, const Adjacency& adjacency, const std::vector<int>& loop, bool closed,
               std::vector<int>& source_of) {
  const std::size_t count = loop.size();
  std::vector<char> wall(adjacency.edge_count(), 0);
  for (std::size_t i = 0; i + (closed ? 0 : 1) < count; ++i)
    wall[adjacency.find_edge(loop[i], loop[(i + 1) % count])] = 1;
  const Eigen::Index old = mesh.V.rows();
  mesh.V.conservativeResize(old + static_cast<Eigen::Index>(count), 3);
  Triangles faces = mesh.F;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t from = closed || i + 1 < count ? i : i - 1;
    const int v = loop[i], copy = static_cast<int>(old) + static_cast<int>(i);
    mesh.V.row(copy) = mesh.V.row(v);
    source_of.push_back(source_of[v]);
    // The half-edge that runs against the loop belongs to the face on its right.
    int start = -1;
    for (const int h : adjacency.outgoing(loop[(from + 1) % count]))
      if (adjacency.to(h) == loop[from]) start = h;
    std::vector<int> stack{start / 3};
    while (!stack.empty()) {
      const int f = stack.back();
      stack.pop_back();
      for (int h = 3 * f; h < 3 * f + 3; ++h) {
        if (adjacency.from(h) != v || faces(f, h % 3) == copy) continue;
        faces(f, h % 3) = copy;
        for (const int side : {h, previous_halfedge(h)})
          if (!wall[adjacency.edge_of(side)] && adjacency.opposite(side) >= 0)
            stack.push_back(adjacency.opposite(side) / 3);
      }
    }
  }
  mesh.F = faces;
}

}  // namespace

OpenedSurface cut_handles(const TriangleMesh& mesh, Context& context) {
  OpenedSurface result;
  result.mesh = mesh;
  result.source_of.resize(mesh.vertex_count());
  std::iota(result.source_of.begin(), result.source_of.end(), 0);
  for (;;) {
    const Adjacency adjacency(result.mesh);
    const int handles = genus(adjacency);
    if (handles == 0) return result;
    // Roots spread over the surface: each the farthest from those before.
    Loop best;
    std::vector<int> roots;
    for (int v = 0; v < result.mesh.vertex_count() && roots.empty(); ++v)
      if (!adjacency.is_boundary_vertex(v)) roots.push_back(v);
    for (int i = 0; i < 12 && i < static_cast<int>(roots.size()); ++i) {
      context.check_cancelled();
      Loop loop = shortest_loop(result.mesh, adjacency, roots[i]);
      // From a vertex of the loop itself the loop gets shorter still.
      for (int again = 0; again < 3 && loop.length < infinite; ++again) {
        const Loop shorter = shortest_loop(result.mesh, adjacency, loop.vertices[loop.vertices.size() / 2]);
        if (!(shorter.length < loop.length)) break;
        loop = shorter;
      }
      if (loop.length < best.length) best = std::move(loop);
      Eigen::VectorXd distance = geodesic_distance_mm(result.mesh, adjacency, roots);
      for (int v = 0; v < result.mesh.vertex_count(); ++v)
        if (adjacency.is_boundary_vertex(v) || distance[v] == infinite) distance[v] = -1;
      Eigen::Index farthest = 0;
      if (distance.maxCoeff(&farthest) > 0) roots.push_back(static_cast<int>(farthest));
    }
    TriangleMesh cut = result.mesh;
    std::vector<int> source_of = result.source_of;
    bool opened = best.length < infinite;
    if (opened) {
      cut_along(cut, adjacency, best.vertices, true, source_of);
      const Adjacency after(cut);
      opened = after.is_manifold() && face_components(after).count == 1 && genus(after) == handles - 1;
    }
    if (!opened)
      throw Error(ErrorCode::invalid_input, "mesh",
                  "A handle of the model has too few triangles to be cut open: subdivide the model first.");
    std::vector<int> given;
    for (const int v : best.vertices) given.push_back(result.source_of[v]);
    result.cuts.push_back(std::move(given));
    result.mesh = std::move(cut);
    result.source_of = std::move(source_of);
  }
}

bool join_nearest_openings(OpenedSurface& surface, Context& context) {
  const Adjacency adjacency(surface.mesh);
  const auto openings = boundary_loops(adjacency);
  std::vector<int> opening_of(surface.mesh.vertex_count(), -1);
  for (std::size_t i = 0; i < openings.size(); ++i)
    for (const int v : openings[i]) opening_of[v] = static_cast<int>(i);
  std::vector<int> best;
  double shortest = infinite;
  for (std::size_t i = 0; i + 1 < openings.size(); ++i) {
    context.check_cancelled();
    std::vector<double> distance(surface.mesh.vertex_count(), infinite);
    std::vector<int> before(surface.mesh.vertex_count(), -1);
    using Entry = std::pair<double, int>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    for (const int v : openings[i]) distance[v] = 0, queue.emplace(0, v);
    while (!queue.empty()) {
      const auto [d, v] = queue.top();
      queue.pop();
      if (d > distance[v] || d >= shortest) continue;
      if (opening_of[v] >= 0 && opening_of[v] != static_cast<int>(i)) {
        shortest = d;
        best.assign(1, v);
        while (before[best.back()] >= 0) best.push_back(before[best.back()]);
        break;
      }
      for (const int w : adjacency.neighbours(v)) {
        const double reach = d + (surface.mesh.V.row(w) - surface.mesh.V.row(v)).norm();
        if (reach < distance[w]) distance[w] = reach, before[w] = v, queue.emplace(reach, w);
      }
    }
  }
  if (best.size() < 2) return false;
  TriangleMesh cut = surface.mesh;
  std::vector<int> source_of = surface.source_of;
  cut_along(cut, adjacency, best, false, source_of);
  const Adjacency after(cut);
  if (!after.is_manifold() || face_components(after).count != 1 || boundary_loops(after).size() + 1 != openings.size())
    return false;
  surface.mesh = std::move(cut);
  surface.source_of = std::move(source_of);
  surface.slits.emplace_back();
  for (const int v : best) surface.slits.back().push_back(surface.mesh.V.row(v).transpose());
  return true;
}

}  // namespace formwright
