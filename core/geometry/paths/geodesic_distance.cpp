// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/paths/geodesic_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

namespace formwright {
namespace {

/// The distance at c that a front passing a (at da) and b (at db) brings, if it comes through between them.
double through(const Vec3& a, double da, const Vec3& b, double db, const Vec3& c) {
  // The front's source lies in the plane of the triangle, at distances da and db from a and b, beyond ab from c.
  const Vec3 ab = b - a, ac = c - a;
  const double length = ab.norm();
  if (length == 0) return std::numeric_limits<double>::infinity();
  const double x = (da * da - db * db + length * length) / (2 * length);
  const double y_squared = da * da - x * x;
  if (y_squared < 0) return std::numeric_limits<double>::infinity();
  const double cx = ac.dot(ab) / length, cy = std::sqrt(std::max(0.0, ac.squaredNorm() - cx * cx)),
               y = std::sqrt(y_squared);
  const double crossing = x + (cx - x) * (y + cy > 0 ? y / (y + cy) : 0.0);
  if (crossing < 0 || crossing > length) return std::numeric_limits<double>::infinity();
  return std::hypot(cx - x, cy + y);
}

}  // namespace

Eigen::VectorXd geodesic_distance_mm(const TriangleMesh& mesh, const Adjacency& adjacency,
                                     const std::vector<int>& sources, const Eigen::VectorXd& slowness) {
  Eigen::VectorXd distance = Eigen::VectorXd::Constant(mesh.vertex_count(), std::numeric_limits<double>::infinity());
  std::vector<char> done(mesh.vertex_count(), 0);
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (const int v : sources) distance[v] = 0, queue.emplace(0, v);
  const bool slow = slowness.size() > 0;
  const auto position = [&](int v) { return Vec3(mesh.V.row(v).transpose()); };
  const auto offer = [&](int v, double d) {
    if (d < distance[v]) distance[v] = d, queue.emplace(d, v);
  };
  while (!queue.empty()) {
    const auto [d, v] = queue.top();
    queue.pop();
    if (done[v]) continue;
    done[v] = 1;
    for (const int w : adjacency.neighbours(v))
      if (!done[w]) offer(w, d + (slow ? 0.5 * (slowness[v] + slowness[w]) : 1.0) * (position(w) - position(v)).norm());
    for (const int h : adjacency.outgoing(v)) {
      const int p = adjacency.to(h), q = adjacency.from(previous_halfedge(h));
      const double s = slow ? (slowness[v] + slowness[p] + slowness[q]) / 3 : 1.0;
      if (done[p] && !done[q]) offer(q, through(s * position(v), d, s * position(p), distance[p], s * position(q)));
      if (done[q] && !done[p]) offer(p, through(s * position(v), d, s * position(q), distance[q], s * position(p)));
    }
  }
  return distance;
}

}  // namespace formwright
