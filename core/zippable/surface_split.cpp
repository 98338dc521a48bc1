// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/surface_split.h"

#include <algorithm>
#include <array>
#include <functional>

#include "base/error.h"
#include "geometry/adjacency.h"

namespace formwright {
namespace {

constexpr double nearest_share = 0.1;  // of an edge: how close to its end a new vertex may lie

/// Splits every face whose vertices differ in `label`; `level(a, b)` is where along the edge from a the labels change.
/// `face_of`, per new face: the old one.
LabelledSurface split(const TriangleMesh& mesh, const Adjacency& adjacency, const std::vector<int>& label,
                      const std::function<double(int, int)>& level, std::vector<int>& face_of) {
  LabelledSurface result;
  std::vector<int> crossing(adjacency.edge_count(), -1);
  std::vector<Vec3> points;
  const int n = mesh.vertex_count();
  for (int e = 0; e < adjacency.edge_count(); ++e) {
    const auto [a, b] = adjacency.edges()[e];
    if (label[a] == label[b]) continue;
    const double t = std::clamp(level(a, b), nearest_share, 1 - nearest_share);
    crossing[e] = n + static_cast<int>(points.size());
    points.push_back(((1 - t) * mesh.V.row(a) + t * mesh.V.row(b)).transpose());
  }
  std::vector<std::array<int, 3>> faces;
  face_of.clear();
  int current = 0;
  const auto add = [&](int a, int b, int c, int of) {
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

/// V - E + F of some faces.
int euler_of(const TriangleMesh& mesh, const Adjacency& adjacency, const std::vector<int>& faces) {
  std::vector<char> vertex(mesh.vertex_count(), 0), edge(adjacency.edge_count(), 0);
  int euler = static_cast<int>(faces.size());
  for (const int f : faces)
    for (int h = 3 * f; h < 3 * f + 3; ++h) {
      if (!vertex[adjacency.from(h)]) vertex[adjacency.from(h)] = 1, ++euler;
      if (!edge[adjacency.edge_of(h)]) edge[adjacency.edge_of(h)] = 1, --euler;
    }
  return euler;
}

}  // namespace

LabelledSurface split_by_least_field(const TriangleMesh& mesh, const std::vector<int>& label, const Eigen::MatrixXd& field) {
  const Adjacency adjacency(mesh);
  std::vector<int> face_of;
  return split(mesh, adjacency, label, [&](int a, int b) {
    // How much better the own label is than the other one, at either end.
    const double at_a = field(a, label[b]) - field(a, label[a]), at_b = field(b, label[a]) - field(b, label[b]);
    return at_a + at_b > 0 ? at_a / (at_a + at_b) : 0.5;
  }, face_of);
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

double puncture(LabelledSurface& surface, int vertex, double radius_mm, std::vector<int>& vertex_of) {
  const TriangleMesh& mesh = surface.mesh;
  const Adjacency adjacency(mesh);
  const Vec3 centre = mesh.V.row(vertex).transpose();
  const auto distance = [&](int v) { return (mesh.V.row(v).transpose() - centre).norm(); };
  const int own = surface.face_label[adjacency.outgoing(vertex).front() / 3];
  std::vector<char> usable(mesh.vertex_count(), 1);  // inside its label and off every opening
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    if (adjacency.is_boundary_vertex(v)) usable[v] = 0;
    for (const int h : adjacency.outgoing(v))
      if (surface.face_label[h / 3] != own) usable[v] = 0;
  }
  if (!usable[vertex]) throw Error(ErrorCode::invalid_input, "mesh", "A puncture lies on the border of its part: move it inside.");
  double least_ring = 1e300;
  for (const int w : adjacency.neighbours(vertex)) least_ring = std::min(least_ring, distance(w));
  for (double radius = radius_mm;; radius *= 0.5) {
    const bool last = radius <= least_ring;
    std::vector<int> inside(mesh.vertex_count(), 0), stack{vertex};
    inside[vertex] = 1;
    bool clear = true;
    while (!stack.empty() && clear) {
      const int v = stack.back();
      stack.pop_back();
      for (const int w : adjacency.neighbours(v)) {
        clear = clear && usable[w];
        if (!inside[w] && distance(w) < radius && clear) inside[w] = 1, stack.push_back(w);
      }
    }
    if (!clear && !last) continue;
    std::vector<int> face_of;
    LabelledSurface cut = split(mesh, adjacency, inside, [&](int a, int b) {
      const double da = distance(a), db = distance(b);
      return da == db ? 0.5 : (radius - da) / (db - da);
    }, face_of);
    std::vector<int> removed;
    std::vector<char> keep(cut.mesh.face_count(), 1);
    for (int f = 0; f < cut.mesh.face_count(); ++f)
      if (cut.face_label[f] == 1) removed.push_back(f), keep[f] = 0;
    const Adjacency cut_adjacency(cut.mesh);
    if (!last && euler_of(cut.mesh, cut_adjacency, removed) != 1) continue;
    LabelledSurface result;
    result.mesh = kept_faces(cut.mesh, keep, vertex_of);
    for (int f = 0; f < cut.mesh.face_count(); ++f)
      if (keep[f]) result.face_label.push_back(surface.face_label[face_of[f]]);
    vertex_of.resize(mesh.vertex_count());
    surface = std::move(result);
    return std::min(radius, radius_mm);
  }
}

}  // namespace formwright
