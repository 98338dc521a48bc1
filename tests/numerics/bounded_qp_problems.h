// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Small bounded QPs that are stated in a line: paths, grids, slabs, bumpy height fields.
#include <cmath>
#include <utility>
#include <vector>

#include "numerics/bounded_qp_reference.h"
#include "numerics/qp/bounded_qp.h"

namespace formwright::test {

inline SparseMatrix graph_laplacian(int n, const std::vector<std::pair<int, int>>& edges) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < n; ++i) entries.emplace_back(i, i, 0.0);
  for (const auto& [a, b] : edges) {
    entries.emplace_back(a, a, 1);
    entries.emplace_back(b, b, 1);
    entries.emplace_back(a, b, -1);
    entries.emplace_back(b, a, -1);
  }
  SparseMatrix L(n, n);
  L.setFromTriplets(entries.begin(), entries.end());
  return L;
}

inline std::vector<std::pair<int, int>> path(int n, int first = 0) {
  std::vector<std::pair<int, int>> edges;
  for (int i = 1; i < n; ++i) edges.emplace_back(first + i - 1, first + i);
  return edges;
}

inline std::vector<std::pair<int, int>> grid(int width, int height) {
  std::vector<std::pair<int, int>> edges;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (x > 0) edges.emplace_back(y * width + x - 1, y * width + x);
      if (y > 0) edges.emplace_back((y - 1) * width + x, y * width + x);
    }
  }
  return edges;
}

inline SparseMatrix lower_of(const SparseMatrix& Q) {
  SparseMatrix lower = Q.triangularView<Eigen::Lower>();
  return lower;
}

inline BoundedQpConstraints unbounded(int n) {
  BoundedQpConstraints c;
  c.lower = Eigen::VectorXd::Constant(n, -infinity);
  c.upper = Eigen::VectorXd::Constant(n, infinity);
  c.lower_slope = c.upper_slope = Eigen::VectorXd::Zero(n);
  c.group.assign(static_cast<std::size_t>(n), 0);
  c.gauge = Eigen::VectorXd::Zero(n);
  return c;
}

/// u - m in [-z - thickness, -z], gauge: mean zero.
inline BoundedQpConstraints slab(const Eigen::VectorXd& z, double thickness) {
  BoundedQpConstraints c = unbounded(static_cast<int>(z.size()));
  c.upper = -z;
  c.lower = c.upper.array() - thickness;
  c.lower_slope = c.upper_slope = Eigen::VectorXd::Ones(z.size());
  c.gauge = Eigen::VectorXd::Constant(z.size(), 1.0 / static_cast<double>(z.size()));
  return c;
}

/// What BoundedQp takes.
struct QpProblem {
  SparseMatrix lower_Q;
  std::vector<int> component;
  BoundedQpConstraints constraints;
};

inline BoundedQpSolution solve(const QpProblem& p, QpMethod method = QpMethod::automatic) {
  Context context;
  BoundedQp qp;
  qp.set_energy(p.lower_Q, p.component, {}, context);
  BoundedQpOptions options;
  options.method = method;
  return qp.solve(p.constraints, options, context);
}

inline Eigen::VectorXd bumps(int width, int height, std::uint64_t seed, double size) {
  Random random(seed);
  Eigen::VectorXd z = Eigen::VectorXd::Zero(width * height);
  for (int k = 0; k < 12; ++k) {
    const double cx = random.unit() * width, cy = random.unit() * height, r = random.between(0.05, 0.3) * width,
                 h = random.between(-1, 1) * size;
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x)
        z[y * width + x] += h * std::exp(-((x - cx) * (x - cx) + (y - cy) * (y - cy)) / (r * r));
    }
  }
  return z;
}

inline QpProblem bumpy_relief(int width, int height, double thickness, std::uint64_t seed = 1) {
  const SparseMatrix L = graph_laplacian(width * height, grid(width, height));
  return {lower_of(L * L), std::vector<int>(static_cast<std::size_t>(width * height), 0),
          slab(bumps(width, height, seed, 10), thickness)};
}

}  // namespace formwright::test
