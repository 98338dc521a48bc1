// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/parts/surface_path.h"

#include <algorithm>
#include <limits>
#include <queue>

namespace formwright {
namespace {

/// What an edge along a feature counts for, of its length.
double cost_share(double bend_rad, double min_rad) { return 1 / (1 + (bend_rad / min_rad) * (bend_rad / min_rad)); }

/// `count` + 1 points at even steps along a polyline.
std::vector<Vec3> even_points(const std::vector<Vec3>& line, int count) {
  std::vector<double> along{0};
  for (std::size_t i = 0; i + 1 < line.size(); ++i) along.push_back(along.back() + (line[i + 1] - line[i]).norm());
  std::vector<Vec3> points;
  std::size_t side = 0;
  for (int k = 0; k <= count; ++k) {
    const double wanted = along.back() * k / count;
    while (side + 2 < line.size() && along[side + 1] < wanted) ++side;
    const double length = along[side + 1] - along[side],
                 t = length > 0 ? std::clamp((wanted - along[side]) / length, 0.0, 1.0) : 0.0;
    points.push_back((1 - t) * line[side] + t * line[side + 1]);
  }
  return points;
}

}  // namespace

int nearest_vertex(const TriangleMesh& mesh, const Vec3& point) {
  Eigen::Index nearest = 0;
  (mesh.V.rowwise() - point.transpose()).rowwise().squaredNorm().minCoeff(&nearest);
  return static_cast<int>(nearest);
}

std::vector<int> edge_path(const TriangleMesh& mesh, const Adjacency& adjacency, int from, int to,
                           const FeatureLines* features) {
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
      const double share =
          features ? cost_share(features->bend_rad[adjacency.find_edge(v, w)], features->options.min_rad) : 1;
      const double reach = d + share * (mesh.V.row(w) - mesh.V.row(v)).norm();
      if (reach < distance[w]) distance[w] = reach, before[w] = v, queue.emplace(reach, w);
    }
  }
  if (from != to && before[to] < 0) return {from};
  std::vector<int> path{to};
  while (path.back() != from) path.push_back(before[path.back()]);
  std::reverse(path.begin(), path.end());
  return path;
}

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

}  // namespace formwright
