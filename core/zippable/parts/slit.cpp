// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/parts/slit.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "base/error.h"
#include "geometry/mesh/measures.h"
#include "zippable/parts/surface_split.h"
#include "zippable/parts/surface_path.h"

namespace formwright {
namespace {

[[noreturn]] void refuse_slit(std::size_t number, const std::string& why) {
  throw Error(ErrorCode::invalid_input, "segments", "Cut " + std::to_string(number + 1) + " of the punctures " + why);
}

/// Through all points, straightest in between, in steps of about `step_mm`.
std::vector<Vec3> path_through(const TriangleMesh& mesh, const Adjacency& adjacency, const PointDistance& surface,
                               const std::vector<Vec3>& points, double step_mm) {
  std::vector<Vec3> path;
  for (std::size_t k = 0; k + 1 < points.size(); ++k) {
    const Vec3 from = surface.nearest(points[k])->point, to = surface.nearest(points[k + 1])->point;
    if ((from - to).norm() < 1e-9 * step_mm) continue;
    std::vector<Vec3> line{from};
    const std::vector<int> edges = edge_path(mesh, adjacency, nearest_vertex(mesh, from), nearest_vertex(mesh, to));
    for (std::size_t i = 1; i + 1 < edges.size(); ++i) line.push_back(mesh.V.row(edges[i]).transpose());
    line.push_back(to);
    line = straightened(std::move(line), surface, step_mm);
    path.insert(path.end(), line.begin() + (path.empty() ? 0 : 1), line.end());
  }
  return path;
}

/// Where a vertex lies beside a path: mm to the left of it (negative: right); 0 beyond its ends or too far off.
double beside(const std::vector<Vec3>& path, const Vec3& point, const Vec3& normal, double reach_mm) {
  double minimum = reach_mm, side = 0;
  for (std::size_t k = 0; k + 1 < path.size(); ++k) {
    const Vec3 along = path[k + 1] - path[k];
    const double t = along.dot(point - path[k]) / along.squaredNorm();
    const Vec3 off = point - (path[k] + std::clamp(t, 0.0, 1.0) * along);
    if (!(off.norm() < minimum)) continue;
    minimum = off.norm();
    const bool beyond = (k == 0 && t <= 0) || (k + 2 == path.size() && t >= 1);
    // At a corner the bisecting direction decides.
    Vec3 direction = along.normalized();
    if (t >= 1 && k + 2 < path.size()) direction += (path[k + 2] - path[k + 1]).normalized();
    if (t <= 0 && k > 0) direction += (path[k] - path[k - 1]).normalized();
    const double left = normal.cross(direction.normalized()).dot(off);
    side = beyond ? 0 : left == 0 ? 1e-12 * reach_mm : left;
  }
  return side;
}

/// The vertices from `first` on that lie between both sides, from end to end; nothing when they are not one simple
/// path.
std::vector<int> chain(const LabelledSurface& cut, const Adjacency& adjacency, int first) {
  std::vector<std::array<int, 2>> next(static_cast<std::size_t>(cut.mesh.vertex_count() - first), {-1, -1});
  int start = -1, edges = 0;
  for (int e = 0; e < adjacency.edge_count(); ++e) {
    const auto [a, b] = adjacency.edges()[e];
    const auto halfedges = adjacency.halfedges_of_edge(e);
    if (a < first || halfedges.size() != 2 || cut.face_label[halfedges[0] / 3] == cut.face_label[halfedges[1] / 3])
      continue;
    ++edges;
    for (const auto& [v, w] : {std::pair{a, b}, std::pair{b, a}}) {
      auto& two = next[static_cast<std::size_t>(v - first)];
      if (two[1] >= 0) return {};
      two[two[0] < 0 ? 0 : 1] = w;
    }
  }
  for (std::size_t i = 0; i < next.size() && start < 0; ++i)
    if (next[i][0] >= 0 && next[i][1] < 0) start = first + static_cast<int>(i);
  std::vector<int> walk;
  for (int v = start, before = -1; v >= 0;) {
    walk.push_back(v);
    const auto& two = next[static_cast<std::size_t>(v - first)];
    const int on = two[0] == before ? two[1] : two[0];
    before = v, v = on;
  }
  return static_cast<int>(walk.size()) == edges + 1 ? walk : std::vector<int>{};
}

std::vector<Vec3> cut_slit(OpenedSurface& surface, const std::vector<Vec3>& points, std::size_t number) {
  const TriangleMesh& mesh = surface.mesh;
  const Adjacency adjacency(mesh);
  const double edge_mm = mean_edge_length(mesh);
  const std::vector<Vec3> path = path_through(mesh, adjacency, PointDistance(mesh), points, 0.5 * edge_mm);
  if (path.size() < 2) refuse_slit(number, "has all its points in one place: draw it longer.");
  const Positions normals = vertex_normals(mesh);
  const int n = mesh.vertex_count();
  std::vector<double> side(n, 0);
  std::vector<int> label(n, 0);
  for (int v = 0; v < n; ++v) {
    const Vec3 point = mesh.V.row(v).transpose();
    double reach = 0;
    for (const int w : adjacency.neighbours(v)) reach = std::max(reach, (mesh.V.row(w).transpose() - point).norm());
    side[v] = beside(path, point, normals.row(v).transpose(), 1.2 * reach);
    label[v] = side[v] > 0;
  }
  std::vector<int> face_of;
  const LabelledSurface cut = split_at_levels(
      mesh, adjacency, label,
      [&](int a, int b) {
        // Only between the left and the right side; around the left side's own rim old edges will do.
        if (side[a] * side[b] < 0) return std::clamp(side[a] / (side[a] - side[b]), 0.1, 0.9);
        return label[a] ? 1.0 : 0.0;
      },
      face_of);
  const Adjacency after(cut.mesh);
  const std::vector<int> walk = chain(cut, after, n);
  if (cut.mesh.vertex_count() - n < 3)
    refuse_slit(number, "is too short for this mesh: draw it longer, or subdivide the model.");
  if (walk.empty()) refuse_slit(number, "meets itself, or an edge that is too sharp: draw it simpler.");
  for (const int v : walk)
    if (after.is_boundary_vertex(v)) refuse_slit(number, "touches an opening or another cut: move it away.");
  OpenedSurface result = surface;
  result.mesh = cut.mesh;
  result.source_of.resize(cut.mesh.vertex_count(), -1);
  // Inner vertices get a second copy for the left side.
  const Eigen::Index old = result.mesh.V.rows(), inner = static_cast<Eigen::Index>(walk.size()) - 2;
  result.mesh.V.conservativeResize(old + inner, 3);
  for (Eigen::Index i = 0; i < inner; ++i) {
    const int v = walk[static_cast<std::size_t>(i) + 1];
    result.mesh.V.row(old + i) = result.mesh.V.row(v);
    result.source_of.push_back(-1);
    for (const int h : after.outgoing(v))
      if (cut.face_label[h / 3] == 1) result.mesh.F(h / 3, h % 3) = static_cast<int>(old + i);
  }
  const Adjacency opened(result.mesh);
  if (!opened.is_manifold() || euler_characteristic(opened) != euler_characteristic(adjacency) - 1 ||
      boundary_loops(opened).size() != boundary_loops(adjacency).size() + 1)
    refuse_slit(number, "does not leave one opening behind: draw it simpler, or subdivide the model.");
  std::vector<Vec3> line;
  for (const int v : walk) line.push_back(cut.mesh.V.row(v).transpose());
  surface = std::move(result);
  return line;
}

}  // namespace

std::vector<std::vector<Vec3>> cut_slits(OpenedSurface& surface, const std::vector<std::vector<Vec3>>& paths,
                                         Context& context) {
  std::vector<std::vector<Vec3>> cuts;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    context.check_cancelled();
    cuts.push_back(cut_slit(surface, paths[i], i));
  }
  return cuts;
}

}  // namespace formwright
