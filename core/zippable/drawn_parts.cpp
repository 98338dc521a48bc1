// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/drawn_parts.h"

#include <algorithm>
#include <limits>
#include <queue>
#include <string>

#include "base/error.h"
#include "geometry/adjacency.h"
#include "geometry/laplacian.h"
#include "geometry/measures.h"
#include "geometry/point_distance.h"
#include "numerics/sparse_cholesky.h"
#include "zippable/geodesic_distance.h"

namespace formwright {
namespace {

int nearest_vertex(const TriangleMesh& mesh, const Vec3& point) {
  Eigen::Index nearest = 0;
  (mesh.V.rowwise() - point.transpose()).rowwise().squaredNorm().minCoeff(&nearest);
  return static_cast<int>(nearest);
}

/// Vertices of the shortest way along edges, both ends included; only the start where no way leads on.
std::vector<int> edge_way(const TriangleMesh& mesh, const Adjacency& adjacency, int from, int to) {
  std::vector<double> distance(mesh.vertex_count(), std::numeric_limits<double>::infinity());
  std::vector<int> before(mesh.vertex_count(), -1);
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  distance[from] = 0;
  queue.emplace(0, from);
  while (!queue.empty()) {
    const auto [d, v] = queue.top();
    queue.pop();
    if (v == to) break;
    if (d > distance[v]) continue;
    for (const int w : adjacency.neighbours(v)) {
      const double reach = d + (mesh.V.row(w) - mesh.V.row(v)).norm();
      if (reach < distance[w]) distance[w] = reach, before[w] = v, queue.emplace(reach, w);
    }
  }
  if (from != to && before[to] < 0) return {from};
  std::vector<int> way{to};
  while (way.back() != from) way.push_back(before[way.back()]);
  std::reverse(way.begin(), way.end());
  return way;
}

/// `count` + 1 points at even steps along a polyline.
std::vector<Vec3> even_points(const std::vector<Vec3>& line, int count) {
  std::vector<double> along{0};
  for (std::size_t i = 0; i + 1 < line.size(); ++i) along.push_back(along.back() + (line[i + 1] - line[i]).norm());
  std::vector<Vec3> points;
  std::size_t side = 0;
  for (int k = 0; k <= count; ++k) {
    const double wanted = along.back() * k / count;
    while (side + 2 < line.size() && along[side + 1] < wanted) ++side;
    const double length = along[side + 1] - along[side], t = length > 0 ? std::clamp((wanted - along[side]) / length, 0.0, 1.0) : 0.0;
    points.push_back((1 - t) * line[side] + t * line[side + 1]);
  }
  return points;
}

/// Pulls a way straight on the surface: few points first, each to the middle between its neighbours and back onto the surface, then twice
/// as many. Ends stay.
std::vector<Vec3> straightened(std::vector<Vec3> line, const PointDistance& surface, double step_mm) {
  double length = 0;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) length += (line[i + 1] - line[i]).norm();
  for (int count = 2; count < 4096; count *= 2) {
    line = even_points(line, count);
    for (int sweep = 0; sweep < 20; ++sweep)
      for (int i = 1; i < count; ++i) line[i] = surface.nearest(0.5 * (line[i - 1] + line[i + 1]))->point;
    if (length / count < step_mm) break;
  }
  return line;
}

/// Marks the edges of a way between two vertices that is as straight as edges allow.
void mark_way(const TriangleMesh& mesh, const Adjacency& adjacency, const PointDistance& surface, double step_mm, int from, int to,
              std::vector<char>& wall) {
  std::vector<Vec3> line;
  for (const int v : edge_way(mesh, adjacency, from, to)) line.push_back(mesh.V.row(v).transpose());
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
    const std::vector<int> way = edge_way(mesh, adjacency, stops[i], stops[i + 1]);
    for (std::size_t k = 0; k + 1 < way.size(); ++k) wall[adjacency.find_edge(way[k], way[k + 1])] = 1;
  }
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

/// Each part's indicator after diffusing over about two edges: n x parts, rows sum to 1.
Eigen::MatrixXd smooth_indicators(const TriangleMesh& mesh, const Adjacency& adjacency, const std::vector<int>& part, int count,
                                  Context& context) {
  const int n = mesh.vertex_count();
  const Eigen::VectorXd face_area = face_areas(mesh);
  Eigen::MatrixXd u = Eigen::MatrixXd::Zero(n, count);
  Eigen::VectorXd area = Eigen::VectorXd::Zero(n);
  for (int f = 0; f < mesh.face_count(); ++f)
    for (int k = 0; k < 3; ++k) u(mesh.F(f, k), part[f]) += face_area[f] / 3, area[mesh.F(f, k)] += face_area[f] / 3;
  const double edge = mean_edge_length(mesh), time = 4 * edge * edge;
  SparseMatrix system = time * cotangent_laplacian(mesh, adjacency);
  for (int v = 0; v < n; ++v) system.coeffRef(v, v) += area[v] + 1e-12 * edge * edge;
  const SparseMatrix lower = system.triangularView<Eigen::Lower>();
  SparseCholesky cholesky;
  cholesky.analyze(lower, Positions(), context);
  cholesky.factorize(lower, context);
  cholesky.solve(u);
  return u;
}

}  // namespace

LabelledSurface divide_along_curves(const TriangleMesh& mesh, const std::vector<DrawnCurve>& curves, Context& context) {
  const Adjacency adjacency(mesh);
  const PointDistance surface(mesh);
  const double step_mm = mean_edge_length(mesh);
  std::vector<char> wall(adjacency.edge_count(), 0);
  for (std::size_t i = 0; i < curves.size(); ++i) {
    std::vector<int> stops;
    for (const Vec3& point : curves[i].points) {
      const int v = nearest_vertex(mesh, point);
      if (stops.empty() || stops.back() != v) stops.push_back(v);
    }
    if (curves[i].closed && stops.size() > 1 && stops.back() != stops.front()) stops.push_back(stops.front());
    if (stops.size() < (curves[i].closed ? 4u : 2u))
      throw Error(ErrorCode::invalid_input, "segments",
                  "Curve " + std::to_string(i + 1) + " of segments.json has too few different points: a loop needs three, a line two.");
    for (std::size_t k = 0; k + 1 < stops.size(); ++k) {
      context.check_cancelled();
      mark_way(mesh, adjacency, surface, step_mm, stops[k], stops[k + 1], wall);
    }
  }
  int count = 0;
  const std::vector<int> part = parts_between(adjacency, wall, count);
  if (count < 2)
    throw Error(ErrorCode::invalid_input, "segments",
                "The curves of segments.json divide nothing: close them, or let each end on another.");
  const Eigen::MatrixXd field = -smooth_indicators(mesh, adjacency, part, count, context);
  std::vector<int> label(mesh.vertex_count());
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    Eigen::Index least = 0;
    field.row(v).minCoeff(&least);
    label[v] = static_cast<int>(least);
  }
  LabelledSurface result = split_by_least_field(mesh, label, field);
  // Slivers between ways that cross each other vanish under the smoothing: what is left is numbered anew.
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
