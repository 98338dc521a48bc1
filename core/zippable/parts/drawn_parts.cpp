// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/parts/drawn_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <string>

#include "base/error.h"
#include "geometry/mesh/adjacency.h"
#include "geometry/operators/laplacian.h"
#include "geometry/mesh/measures.h"
#include "geometry/queries/point_distance.h"
#include "numerics/sparse/sparse_cholesky.h"
#include "geometry/paths/geodesic_distance.h"
#include "zippable/parts/surface_path.h"

namespace formwright {
namespace {

/// Marks the edges of a path between two vertices that is as straight as edges allow.
void mark_path(const TriangleMesh& mesh, const Adjacency& adjacency, const PointDistance& surface, double step_mm,
               int from, int to, std::vector<char>& wall) {
  std::vector<Vec3> line;
  for (const int v : edge_path(mesh, adjacency, from, to)) line.push_back(mesh.V.row(v).transpose());
  if (line.size() < 2) return;
  std::vector<int> stops{from};
  if (line.size() > 2)
    for (const Vec3& point : straightened(std::move(line), surface, step_mm)) {
      const NearestPoint on = *surface.nearest(point);
      Eigen::Index corner = 0;
      on.barycentric.maxCoeff(&corner);
      stops.push_back(mesh.F(on.face, static_cast<int>(corner)));
    }
  stops.push_back(to);
  for (std::size_t i = 0; i + 1 < stops.size(); ++i) {
    const std::vector<int> path = edge_path(mesh, adjacency, stops[i], stops[i + 1]);
    for (std::size_t k = 0; k + 1 < path.size(); ++k) wall[adjacency.find_edge(path[k], path[k + 1])] = 1;
  }
}

/// Marks the edges of the cheapest path: as they are along features, as straight as edges allow in between.
void mark_snapped_path(const TriangleMesh& mesh, const Adjacency& adjacency, const PointDistance& surface,
                       double step_mm, int from, int to, const FeatureLines& features, std::vector<char>& wall) {
  const std::vector<int> path = edge_path(mesh, adjacency, from, to, &features);
  std::size_t left = 0;  // where the path left the features
  for (std::size_t k = 0; k + 1 < path.size(); ++k) {
    const int edge = adjacency.find_edge(path[k], path[k + 1]);
    if (std::abs(features.bend_rad[edge]) < features.options.min_rad) continue;
    if (left < k) mark_path(mesh, adjacency, surface, step_mm, path[left], path[k], wall);
    wall[edge] = 1;
    left = k + 1;
  }
  if (left + 1 < path.size()) mark_path(mesh, adjacency, surface, step_mm, path[left], path.back(), wall);
}

/// The vertex that stands for a drawn point: on the nearest feature line in reach, or the nearest one.
int snapped_vertex(const TriangleMesh& mesh, const SnapTargets& targets, const Vec3& point) {
  int nearest = -1;
  double minimum = targets.reach_mm;
  for (const FeaturePoint& f : targets.features.points)
    if (const double d = (mesh.V.row(f.vertex).transpose() - point).norm(); d < minimum)
      minimum = d, nearest = f.vertex;
  return nearest >= 0 ? nearest : nearest_vertex(mesh, point);
}

/// Of every curve the vertices on its path. A point that a snapped curve moves is moved for all curves that share it.
std::vector<std::vector<int>> stops_of(const TriangleMesh& mesh, const std::vector<DrawnCurve>& curves,
                                       const std::vector<char>& snaps, const SnapTargets* targets) {
  const auto key = [](const Vec3& p) { return std::array<double, 3>{p.x(), p.y(), p.z()}; };
  std::map<std::array<double, 3>, int> moved;
  for (std::size_t i = 0; i < curves.size(); ++i)
    if (snaps[i])
      for (const Vec3& point : curves[i].points) moved.try_emplace(key(point), snapped_vertex(mesh, *targets, point));
  std::vector<std::vector<int>> result;
  for (const DrawnCurve& curve : curves) {
    std::vector<int> stops;
    for (const Vec3& point : curve.points) {
      const auto found = moved.find(key(point));
      const int v = found != moved.end() ? found->second : nearest_vertex(mesh, point);
      if (stops.empty() || stops.back() != v) stops.push_back(v);
    }
    if (curve.closed && stops.size() > 1 && stops.back() != stops.front()) stops.push_back(stops.front());
    if (stops.size() < (curve.closed ? 4u : 2u))
      throw Error(ErrorCode::invalid_input, "segments",
                  "Curve " + std::to_string(result.size() + 1) +
                      " of segments.json has too few different points: a loop needs three, a line two.");
    result.push_back(std::move(stops));
  }
  return result;
}

/// Vertices within a run of walls along sharp edges, with different parts on both sides.
std::vector<char> on_sharp_border(const Adjacency& adjacency, const std::vector<int>& part,
                                  const std::vector<char>& wall, const std::vector<char>& sharp_wall) {
  std::vector<char> keep(adjacency.vertex_count(), 0);
  std::vector<int> walls(adjacency.vertex_count(), 0), sharp(adjacency.vertex_count(), 0);
  for (int e = 0; e < adjacency.edge_count(); ++e) {
    const auto halfedges = adjacency.halfedges_of_edge(e);
    if (!wall[e] || halfedges.size() != 2 || part[halfedges[0] / 3] == part[halfedges[1] / 3]) continue;
    for (const int v : {adjacency.edges()[e].lower, adjacency.edges()[e].higher}) ++walls[v], sharp[v] += sharp_wall[e];
  }
  for (int v = 0; v < adjacency.vertex_count(); ++v)
    keep[v] = walls[v] >= 2 && sharp[v] == walls[v] && !adjacency.is_boundary_vertex(v);
  return keep;
}

/// Faces that are connected without crossing a wall.
std::vector<int> parts_between(const Adjacency& adjacency, const std::vector<char>& wall, int& count) {
  std::vector<int> part(adjacency.face_count(), -1), stack;
  count = 0;
  for (int start = 0; start < adjacency.face_count(); ++start) {
    if (part[start] >= 0) continue;
    part[start] = count;
    stack.push_back(start);
    while (!stack.empty()) {
      const int f = stack.back();
      stack.pop_back();
      for (int h = 3 * f; h < 3 * f + 3; ++h) {
        const int o = adjacency.opposite(h);
        if (o < 0 || wall[adjacency.edge_of(h)] || part[o / 3] >= 0) continue;
        part[o / 3] = count;
        stack.push_back(o / 3);
      }
    }
    ++count;
  }
  return part;
}

/// Each part's indicator after diffusing over about two edges: n x parts, rows sum to 1. It stays as it is on and
/// beside what `keep` marks.
Eigen::MatrixXd smooth_indicators(const TriangleMesh& mesh, const Adjacency& adjacency, const std::vector<int>& part,
                                  int count, const std::vector<char>& keep, Context& context) {
  const int n = mesh.vertex_count();
  const Eigen::VectorXd face_area = face_areas(mesh);
  Eigen::MatrixXd u = Eigen::MatrixXd::Zero(n, count);
  Eigen::VectorXd area = Eigen::VectorXd::Zero(n);
  for (int f = 0; f < mesh.face_count(); ++f)
    for (int k = 0; k < 3; ++k) u(mesh.F(f, k), part[f]) += face_area[f] / 3, area[mesh.F(f, k)] += face_area[f] / 3;
  const double edge = mean_edge_length(mesh), time = 4 * edge * edge;
  SparseMatrix system = time * cotangent_laplacian(mesh, adjacency);
  for (int v = 0; v < n; ++v) {
    const auto ring = adjacency.neighbours(v);
    const bool fixed = keep[v] || std::any_of(ring.begin(), ring.end(), [&](int w) { return keep[w]; });
    const double weight = fixed ? 1e4 : 1;
    if (fixed) u.row(v) *= weight;
    system.coeffRef(v, v) += weight * area[v] + 1e-12 * edge * edge;
  }
  const SparseMatrix lower = system.triangularView<Eigen::Lower>();
  SparseCholesky cholesky;
  cholesky.analyze(lower, Positions(), context);
  cholesky.factorize(lower, context);
  cholesky.solve(u);
  return u;
}

}  // namespace

LabelledSurface divide_along_curves(const TriangleMesh& mesh, const std::vector<DrawnCurve>& curves,
                                    const SnapTargets* targets, Context& context) {
  const Adjacency adjacency(mesh);
  const PointDistance surface(mesh);
  const double step_mm = mean_edge_length(mesh);
  std::vector<char> snaps;
  for (const DrawnCurve& curve : curves) snaps.push_back(targets && curve.snap.value_or(targets->by_default));
  const auto stops = stops_of(mesh, curves, snaps, targets);
  std::vector<char> wall(adjacency.edge_count(), 0), sharp_wall(adjacency.edge_count(), 0);
  for (std::size_t i = 0; i < curves.size(); ++i)
    for (std::size_t k = 0; k + 1 < stops[i].size(); ++k) {
      context.check_cancelled();
      if (!snaps[i]) {
        mark_path(mesh, adjacency, surface, step_mm, stops[i][k], stops[i][k + 1], wall);
        continue;
      }
      std::vector<char> own(adjacency.edge_count(), 0);
      mark_snapped_path(mesh, adjacency, surface, step_mm, stops[i][k], stops[i][k + 1], targets->features, own);
      for (int e = 0; e < adjacency.edge_count(); ++e)
        if (own[e]) wall[e] = 1, sharp_wall[e] |= targets->features.sharp[e];
    }
  int count = 0;
  const std::vector<int> part = parts_between(adjacency, wall, count);
  if (count < 2)
    throw Error(ErrorCode::invalid_input, "segments",
                "The curves in segments.json do not divide the model: close them, or let each end on another one.");
  const std::vector<char> keep = on_sharp_border(adjacency, part, wall, sharp_wall);
  const Eigen::MatrixXd field = -smooth_indicators(mesh, adjacency, part, count, keep, context);
  std::vector<int> label(mesh.vertex_count());
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    Eigen::Index minimum = 0;
    field.row(v).minCoeff(&minimum);
    label[v] = static_cast<int>(minimum);
  }
  LabelledSurface result = split_by_smallest_field(mesh, label, field, keep);
  // Slivers between paths that cross each other vanish under the smoothing: what is left is numbered anew.
  std::vector<int> number(count, -1);
  int next = 0;
  for (int& face : result.face_label) {
    if (number[face] < 0) number[face] = next++;
    face = number[face];
  }
  return result;
}

int puncture_place(const LabelledSurface& surface, int label) {
  const Adjacency adjacency(surface.mesh);
  std::vector<int> border;
  std::vector<char> inside(surface.mesh.vertex_count(), 0);
  for (int h = 0; h < 3 * surface.mesh.face_count(); ++h) {
    if (surface.face_label[h / 3] != label) continue;
    inside[adjacency.from(h)] = 1;
    const int o = adjacency.opposite(h);
    if (o < 0) return -1;
    if (surface.face_label[o / 3] != label) border.push_back(adjacency.from(h)), border.push_back(adjacency.to(h));
  }
  const Eigen::VectorXd distance = geodesic_distance_mm(surface.mesh, adjacency, border);
  int farthest = -1;
  for (int v = 0; v < surface.mesh.vertex_count(); ++v)
    if (inside[v] && (farthest < 0 || distance[v] > distance[farthest])) farthest = v;
  return farthest;
}

}  // namespace formwright
