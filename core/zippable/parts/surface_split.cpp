// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/parts/surface_split.h"

#include <algorithm>
#include <array>

#include "base/error.h"

namespace formwright {
namespace {

constexpr double nearest_share = 0.1;  // of an edge: how close to its end a new vertex may lie

/// V - E + F of what lies wholly within a set of vertices; a disc when that is 1.
int euler_within(const Adjacency& adjacency, const std::vector<int>& vertices, const std::vector<int>& mark, int own) {
  int euler = 0;
  for (const int v : vertices) {
    ++euler;
    for (const int w : adjacency.neighbours(v))
      if (w > v && mark[w] == own) --euler;
    for (const int h : adjacency.outgoing(v)) {
      const int a = adjacency.to(h), b = adjacency.from(previous_halfedge(h));
      if (a > v && b > v && mark[a] == own && mark[b] == own) ++euler;
    }
  }
  return euler;
}

}  // namespace

LabelledSurface split_at_levels(const TriangleMesh& mesh, const Adjacency& adjacency, const std::vector<int>& label,
                                const std::function<double(int, int)>& level, std::vector<int>& face_of) {
  LabelledSurface result;
  std::vector<int> crossing(adjacency.edge_count(), -1);
  std::vector<Vec3> points;
  const int n = mesh.vertex_count();
  for (int e = 0; e < adjacency.edge_count(); ++e) {
    const auto [a, b] = adjacency.edges()[e];
    if (label[a] == label[b]) continue;
    const double wanted = level(a, b), t = std::clamp(wanted, nearest_share, 1 - nearest_share);
    if (wanted == 0 || wanted == 1) {
      crossing[e] = wanted == 0 ? a : b;
      continue;
    }
    crossing[e] = n + static_cast<int>(points.size());
    points.push_back(((1 - t) * mesh.V.row(a) + t * mesh.V.row(b)).transpose());
  }
  std::vector<std::array<int, 3>> faces;
  face_of.clear();
  int current = 0;
  const auto add = [&](int a, int b, int c, int of) {
    if (a == b || b == c || c == a) return;  // beside a vertex that the border goes through
    faces.push_back({a, b, c});
    result.face_label.push_back(of);
    face_of.push_back(current);
  };
  const auto point = [&](int v) { return v < n ? Vec3(mesh.V.row(v).transpose()) : points[v - n]; };
  for (int f = 0; f < mesh.face_count(); ++f) {
    current = f;
    std::array<int, 3> v{}, m{};
    int changes = 0;
    for (int k = 0; k < 3; ++k) {
      v[k] = mesh.F(f, k);
      m[k] = crossing[adjacency.edge_of(3 * f + k)];
      changes += m[k] >= 0;
    }
    if (changes == 0) {
      add(v[0], v[1], v[2], label[v[0]]);
    } else if (changes == 2) {
      int k = 0;  // the corner that is alone lies between the two sides that are crossed
      while (m[(k + 1) % 3] >= 0) ++k;
      const int a = v[k], b = v[(k + 1) % 3], c = v[(k + 2) % 3], ab = m[k], ca = m[(k + 2) % 3];
      add(a, ab, ca, label[a]);
      if ((point(ab) - point(c)).squaredNorm() < (point(ca) - point(b)).squaredNorm()) {
        add(ab, b, c, label[b]), add(ab, c, ca, label[b]);
      } else {
        add(ab, b, ca, label[b]), add(b, c, ca, label[b]);
      }
    } else {
      const int middle = n + static_cast<int>(points.size());
      points.push_back((point(m[0]) + point(m[1]) + point(m[2])) / 3);
      for (int k = 0; k < 3; ++k) {
        add(v[k], m[k], middle, label[v[k]]);
        add(v[k], middle, m[(k + 2) % 3], label[v[k]]);
      }
    }
  }
  result.mesh.V.resize(n + static_cast<Eigen::Index>(points.size()), 3);
  result.mesh.V.topRows(n) = mesh.V;
  for (std::size_t i = 0; i < points.size(); ++i) result.mesh.V.row(n + static_cast<Eigen::Index>(i)) = points[i];
  result.mesh.F.resize(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t i = 0; i < faces.size(); ++i)
    for (int k = 0; k < 3; ++k) result.mesh.F(static_cast<Eigen::Index>(i), k) = faces[i][k];
  return result;
}

LabelledSurface split_by_smallest_field(const TriangleMesh& mesh, const std::vector<int>& label,
                                        const Eigen::MatrixXd& field, const std::vector<char>& keep_to) {
  const Adjacency adjacency(mesh);
  std::vector<int> face_of;
  return split_at_levels(
      mesh, adjacency, label,
      [&](int a, int b) {
        if (!keep_to.empty() && (keep_to[a] || keep_to[b])) return keep_to[a] ? 0.0 : 1.0;
        // How much better the own label is than the other one, at either end.
        const double at_a = field(a, label[b]) - field(a, label[a]), at_b = field(b, label[a]) - field(b, label[b]);
        return at_a + at_b > 0 ? std::clamp(at_a / (at_a + at_b), nearest_share, 1 - nearest_share) : 0.5;
      },
      face_of);
}

TriangleMesh kept_faces(const TriangleMesh& mesh, const std::vector<char>& keep, std::vector<int>& vertex_of) {
  vertex_of.assign(mesh.vertex_count(), -1);
  int faces = 0, vertices = 0;
  for (int f = 0; f < mesh.face_count(); ++f) {
    if (!keep[f]) continue;
    ++faces;
    for (int k = 0; k < 3; ++k) vertex_of[mesh.F(f, k)] = 0;
  }
  for (int& v : vertex_of)
    if (v == 0) v = vertices++;
  TriangleMesh result;
  result.V.resize(vertices, 3);
  for (int v = 0; v < mesh.vertex_count(); ++v)
    if (vertex_of[v] >= 0) result.V.row(vertex_of[v]) = mesh.V.row(v);
  result.F.resize(faces, 3);
  int next = 0;
  for (int f = 0; f < mesh.face_count(); ++f) {
    if (!keep[f]) continue;
    for (int k = 0; k < 3; ++k) result.F(next, k) = vertex_of[mesh.F(f, k)];
    ++next;
  }
  return result;
}

std::vector<double> puncture(LabelledSurface& surface, const std::vector<int>& vertices, double radius_mm) {
  const TriangleMesh& mesh = surface.mesh;
  const Adjacency adjacency(mesh);
  std::vector<char> usable(mesh.vertex_count(),
                           1);  // inside its label, off every opening and away from other punctures
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    const auto around = adjacency.outgoing(v);
    if (adjacency.is_boundary_vertex(v)) usable[v] = 0;
    for (const int h : around)
      if (surface.face_label[h / 3] != surface.face_label[around.front() / 3]) usable[v] = 0;
  }
  std::vector<int> mark(mesh.vertex_count(), 0);  // 1 + the puncture that a vertex lies in
  std::vector<double> radii;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const int centre = vertices[i], own = static_cast<int>(i) + 1;
    if (!usable[centre])
      throw Error(ErrorCode::invalid_input, "mesh",
                  "A hole lies on the border of its part or beside another hole: move it inside the part.");
    const auto distance = [&](int v) { return (mesh.V.row(v) - mesh.V.row(centre)).norm(); };
    double min_ring = 1e300;
    for (const int w : adjacency.neighbours(centre)) min_ring = std::min(min_ring, distance(w));
    for (double radius = radius_mm;; radius *= 0.5) {
      const bool last = radius <= min_ring;
      std::vector<int> inside{centre};
      mark[centre] = own;
      bool clear = true;
      for (std::size_t k = 0; k < inside.size() && clear; ++k)
        for (const int w : adjacency.neighbours(inside[k])) {
          clear = clear && usable[w];
          if (clear && mark[w] == 0 && distance(w) < radius) mark[w] = own, inside.push_back(w);
        }
      if (last || (clear && euler_within(adjacency, inside, mark, own) == 1)) {
        radii.push_back(radius);
        for (const int v : inside) {
          usable[v] = 0;
          for (const int w : adjacency.neighbours(v)) usable[w] = 0;
        }
        break;
      }
      for (const int v : inside) mark[v] = 0;
    }
  }
  std::vector<int> face_of;
  LabelledSurface cut = split_at_levels(
      mesh, adjacency, mark,
      [&](int a, int b) {
        const int own = std::max(mark[a], mark[b]) - 1;
        const auto distance = [&](int v) { return (mesh.V.row(v) - mesh.V.row(vertices[own])).norm(); };
        const double da = distance(a), db = distance(b);
        return da == db ? 0.5 : std::clamp((radii[own] - da) / (db - da), nearest_share, 1 - nearest_share);
      },
      face_of);
  LabelledSurface result;
  std::vector<char> keep(cut.mesh.face_count());
  for (int f = 0; f < cut.mesh.face_count(); ++f) {
    keep[f] = cut.face_label[f] == 0;
    if (keep[f]) result.face_label.push_back(surface.face_label[face_of[f]]);
  }
  std::vector<int> vertex_of;
  result.mesh = kept_faces(cut.mesh, keep, vertex_of);
  surface = std::move(result);
  return radii;
}

}  // namespace formwright
