// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/parts/limb_tips.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include <Eigen/Geometry>

#include "geometry/paths/geodesic_distance.h"

namespace formwright {

Eigen::VectorXd mean_distance_mm(const TriangleMesh& mesh, const Adjacency& adjacency, Context& context) {
  constexpr int samples = 14;
  const int n = mesh.vertex_count();
  std::vector<Eigen::VectorXd> distances;
  Eigen::VectorXd nearest = Eigen::VectorXd::Constant(n, std::numeric_limits<double>::infinity());
  int vertex = 0;
  std::vector<int> owner(n, 0);
  for (int i = 0; i < samples; ++i) {
    context.check_cancelled();
    distances.push_back(geodesic_distance_mm(mesh, adjacency, {vertex}));
    for (int v = 0; v < n; ++v)
      if (distances[i][v] < nearest[v]) nearest[v] = distances[i][v], owner[v] = i;
    Eigen::Index farthest = 0;
    if (!(nearest.maxCoeff(&farthest) > 0)) break;
    vertex = static_cast<int>(farthest);
  }
  std::vector<double> weight(distances.size(), 0);
  for (int f = 0; f < mesh.face_count(); ++f) {
    const Vec3 a = mesh.V.row(mesh.F(f, 0)).transpose(), b = mesh.V.row(mesh.F(f, 1)).transpose(),
               c = mesh.V.row(mesh.F(f, 2)).transpose();
    for (int k = 0; k < 3; ++k) weight[owner[mesh.F(f, k)]] += (b - a).cross(c - a).norm();
  }
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(n);
  const double total = std::accumulate(weight.begin(), weight.end(), 0.0);
  for (std::size_t i = 0; i < distances.size(); ++i) mean += weight[i] / total * distances[i];
  return mean;
}

std::vector<LimbTip> prominent_maxima(const Adjacency& adjacency, const Eigen::VectorXd& f, double minimum) {
  const int n = adjacency.vertex_count();
  std::vector<int> order(n), parent(n, -1), top(n, -1);
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) { return f[a] != f[b] ? f[a] > f[b] : a < b; });
  const auto root = [&](int v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  std::vector<LimbTip> tips;
  int last_saddle = -1;
  for (const int v : order) {
    parent[v] = v, top[v] = v;
    for (const int w : adjacency.neighbours(v)) {
      if (parent[w] < 0) continue;
      int a = root(v), b = root(w);
      if (a == b) continue;
      if (f[top[a]] < f[top[b]]) std::swap(a, b);
      if (const double prominence = f[top[b]] - f[v]; top[b] != v && prominence >= minimum)
        tips.push_back({top[b], v, prominence}), last_saddle = v;
      parent[b] = a;
    }
  }
  const int highest = order.front();
  tips.push_back({highest, last_saddle, f[highest] - f[order.back()]});
  std::stable_sort(tips.begin(), tips.end(),
                   [](const LimbTip& a, const LimbTip& b) { return a.prominence > b.prominence; });
  return tips;
}

}  // namespace formwright
