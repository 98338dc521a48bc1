// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/operators/laplacian.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "base/context.h"
#include "base/index.h"

namespace formwright {
namespace {

double held_cotangent(double dot, double cross, double limit) {
  // cross >= 0; the comparison avoids the division where it would overflow.
  if (std::abs(dot) >= limit * cross) return dot == 0 ? 0 : std::copysign(limit, dot);
  return dot / cross;
}

double checked_limit(const LaplacianOptions& options) { return std::clamp(options.cotangent_limit, 0.0, 1e12); }

/// Half the cotangent opposite each half-edge, in order: h = 3 f + k lies opposite corner k + 2.
std::vector<double> half_cotangents(const TriangleMesh& mesh, double limit) {
  std::vector<double> result(index(3 * mesh.face_count()));
  for (int f = 0; f < mesh.face_count(); ++f) {
    const std::array<Vec3, 3> p{mesh.V.row(mesh.F(f, 0)), mesh.V.row(mesh.F(f, 1)), mesh.V.row(mesh.F(f, 2))};
    const double twice_area = (p[1] - p[0]).cross(p[2] - p[0]).norm();
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 u = p[(k + 1) % 3] - p[k], w = p[(k + 2) % 3] - p[k];
      result[index(3 * f) + (k + 1) % 3] = 0.5 * held_cotangent(u.dot(w), twice_area, limit);
    }
  }
  return result;
}

/// Meyer et al. 2003, Sec. 3.3-3.4, from the sides opposite the three corners.
std::array<double, 3> corner_shares(VertexArea kind, const std::array<double, 3>& side) {
  const double area = area_from_lengths(side[0], side[1], side[2]);
  if (kind == VertexArea::barycentric || area == 0) return {area / 3, area / 3, area / 3};
  std::array<double, 3> squared{}, cotangent{};
  for (std::size_t k = 0; k < 3; ++k) squared[k] = side[k] * side[k];
  for (std::size_t k = 0; k < 3; ++k) {
    const double dot = squared[(k + 1) % 3] + squared[(k + 2) % 3] - squared[k];
    if (dot < 0) {  // obtuse here: the circumcentre lies outside
      std::array<double, 3> shares{area / 4, area / 4, area / 4};
      shares[k] = area / 2;
      return shares;
    }
    cotangent[k] = dot / (4 * area);
  }
  std::array<double, 3> shares{};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
    shares[k] = (squared[i] * cotangent[i] + squared[j] * cotangent[j]) / 8;
  }
  return shares;
}

void apply_floor(Eigen::VectorXd& areas, const std::vector<char>& used, double floor) {
  const auto count = std::count(used.begin(), used.end(), 1);
  if (count == 0) return;
  const double minimum = floor * areas.sum() / static_cast<double>(count);
  areas = areas.cwiseMax(minimum);
}

}  // namespace

SparseMatrix cotangent_laplacian(const TriangleMesh& mesh, const Adjacency& adjacency,
                                 const LaplacianOptions& options) {
  const std::vector<double> cotangents = half_cotangents(mesh, checked_limit(options));
  const int n = mesh.vertex_count();
  const IndexLists& rings = adjacency.one_rings();
  SparseMatrix laplacian(n, n);
  laplacian.resizeNonZeros(static_cast<Eigen::Index>(rings.items.size()) + n);
  int* const start = laplacian.outerIndexPtr();
  int* const row = laplacian.innerIndexPtr();
  double* const value = laplacian.valuePtr();

  // Column v holds its ring, ascending, with v itself in its place; edges ascend, so that filling them
  // in order meets first the lower neighbours of every vertex, then the higher ones.
  std::vector<int> slot(index(n)), diagonal(index(n));
  for (int v = 0; v <= n; ++v) start[v] = (n > 0 ? rings.first[index(v)] : 0) + v;
  for (int v = 0; v < n; ++v) {
    const auto ring = adjacency.neighbours(v);
    const auto lower = std::lower_bound(ring.begin(), ring.end(), v) - ring.begin();
    slot[index(v)] = start[v];
    diagonal[index(v)] = start[v] + static_cast<int>(lower);
    row[diagonal[index(v)]] = v;
    value[diagonal[index(v)]] = 0;
  }
  const auto put = [&](int column, int neighbour, double weight) {
    int& position = slot[index(column)];
    if (position == diagonal[index(column)]) ++position;
    row[position] = neighbour;
    value[position++] = -weight;
    value[diagonal[index(column)]] += weight;
  };
  for (int e = 0; e < adjacency.edge_count(); ++e) {
    const Edge edge = adjacency.edges()[index(e)];
    if (edge.lower == edge.higher) continue;
    double weight = 0;
    for (const int h : adjacency.halfedges_of_edge(e)) weight += cotangents[index(h)];
    put(edge.lower, edge.higher, weight);
    put(edge.higher, edge.lower, weight);
  }
  return laplacian;
}

SparseMatrix cotangent_laplacian(const TriangleMesh& mesh, const LaplacianOptions& options) {
  return cotangent_laplacian(mesh, Adjacency(mesh), options);
}

SparseMatrix cotangent_laplacian(const IntrinsicTriangulation& t, const LaplacianOptions& options) {
  const double limit = checked_limit(options);
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(2 * t.from.size() + index(t.vertex_count));
  for (int v = 0; v < t.vertex_count; ++v) entries.emplace_back(v, v, 0.0);
  const auto cotangent = [&](int h) {
    const double a = t.length[index(h)], b = t.length[index(next_halfedge(h))],
                 c = t.length[index(previous_halfedge(h))];
    return held_cotangent(b * b + (c - a) * (c + a), 4 * area_from_lengths(a, b, c), limit);
  };
  for (int h = 0; h < static_cast<int>(t.from.size()); ++h) {
    const int g = t.opposite[index(h)];
    if (g > h) continue;
    const int i = t.from[index(h)], j = t.from[index(next_halfedge(h))];
    if (i == j) continue;
    double weight = 0.5 * (cotangent(h) + (g >= 0 ? cotangent(g) : 0));
    if (weight < 0 && weight > -1e-9) weight = 0;  // the tolerance of intrinsic_delaunay and round-off
    entries.emplace_back(i, j, -weight);
    entries.emplace_back(j, i, -weight);
    entries.emplace_back(i, i, weight);
    entries.emplace_back(j, j, weight);
  }
  SparseMatrix laplacian(t.vertex_count, t.vertex_count);
  laplacian.setFromTriplets(entries.begin(), entries.end());
  return laplacian;
}

Eigen::VectorXd vertex_areas(const TriangleMesh& mesh, VertexArea kind, double floor) {
  Eigen::VectorXd areas = Eigen::VectorXd::Zero(mesh.vertex_count());
  std::vector<char> used(index(mesh.vertex_count()), 0);
  for (int f = 0; f < mesh.face_count(); ++f) {
    std::array<double, 3> side{};
    for (int k = 0; k < 3; ++k)
      side[index(k)] = (mesh.V.row(mesh.F(f, (k + 1) % 3)) - mesh.V.row(mesh.F(f, (k + 2) % 3))).norm();
    const auto shares = corner_shares(kind, side);
    for (int k = 0; k < 3; ++k) {
      areas[mesh.F(f, k)] += shares[index(k)];
      used[index(mesh.F(f, k))] = 1;
    }
  }
  apply_floor(areas, used, floor);
  return areas;
}

Eigen::VectorXd vertex_areas(const IntrinsicTriangulation& t, VertexArea kind, double floor) {
  Eigen::VectorXd areas = Eigen::VectorXd::Zero(t.vertex_count);
  std::vector<char> used(index(t.vertex_count), 0);
  for (int f = 0; f < t.face_count(); ++f) {
    const auto length = [&](int k) { return t.length[index(3 * f + k)]; };
    const auto shares = corner_shares(kind, {length(1), length(2), length(0)});
    for (int k = 0; k < 3; ++k) {
      areas[t.from[index(3 * f + k)]] += shares[index(k)];
      used[index(t.from[index(3 * f + k)])] = 1;
    }
  }
  apply_floor(areas, used, floor);
  return areas;
}

}  // namespace formwright
