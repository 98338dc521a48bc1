// SPDX-License-Identifier: GPL-3.0-or-later
#include "numerics/qp/bounded_qp_tie.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/index.h"
#include "numerics/qp/exchange/exchange_pool_qp.h"

namespace formwright::bounded_qp_detail {

namespace {
constexpr double null_tolerance = 1e-10;  // of the largest pivot of K, which is quadratic in the rows
constexpr int max_rounds = 100;
// How a row reads the constants and m: one coefficient for each component, then one for each group.
Eigen::VectorXd driver_row(const Energy& energy, const Rows& rows, RowKey key) {
  const int components = energy.component_count();
  Eigen::VectorXd row = Eigen::VectorXd::Zero(components + rows.groups());
  if (key.side == Side::order) {
    const InequalityRow& r = rows.constraints().rows[index(key.index)];
    for (std::size_t k = 0; k < r.index.size(); ++k) row[energy.component(r.index[k])] += r.coefficient[k];
  } else {
    row[energy.component(key.index)] = key.side == Side::upper ? -1 : 1;
  }
  row[components + rows.group(key)] += rows.slope(key);
  return row;
}

// The directions that no pushing row and no gauge feels, orthonormal.
Eigen::MatrixXd free_directions(const Energy& energy, const Rows& rows, std::span<const RowKey> pushing) {
  const int components = energy.component_count(), size = components + rows.groups();
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(size, size);
  Eigen::VectorXd gauge = Eigen::VectorXd::Zero(size);
  for (int i = 0; i < energy.size(); ++i) gauge[energy.component(i)] += rows.constraints().gauge[i];
  // A gauge that only compares shapes leaves round-off here.
  const double gauge_size = rows.constraints().gauge.cwiseAbs().sum();
  if (gauge.norm() > 1e-12 * gauge_size) K += gauge * gauge.transpose() / gauge.squaredNorm();
  for (const RowKey key : pushing) {
    const Eigen::VectorXd row = driver_row(energy, rows, key);
    // Sparse outer product: a bound touches one component and one group.
    for (int a = 0; a < size; ++a) {
      if (row[a] == 0) continue;
      for (int b = 0; b < size; ++b) K(a, b) += row[a] * row[b] / row.squaredNorm();
    }
  }
  // K is symmetric: what its columns do not span is its null space.
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(K);
  qr.setThreshold(null_tolerance);
  const Eigen::MatrixXd Q = qr.householderQ();
  return Q.rightCols(size - qr.rank());
}
}  // namespace

int break_ties(const Energy& energy, const Rows& rows, std::span<const RowKey> pushing, double tolerance,
               Eigen::VectorXd& u, Eigen::VectorXd& m, Context& context) {
  const int components = energy.component_count(), groups = rows.groups();
  const Eigen::MatrixXd N = free_directions(energy, rows, pushing);
  const auto freedom = N.cols();
  if (freedom == 0) return 0;
  // |u + W N t|^2 + |m + N_m t|^2 with W N t constant on components: M and its gradient at t = 0.
  Eigen::VectorXd count(components), sum = Eigen::VectorXd::Zero(components);
  for (int k = 0; k < components; ++k) count[k] = energy.component_sizes()[index(k)];
  for (int i = 0; i < energy.size(); ++i) sum[energy.component(i)] += u[i];
  const auto Nc = N.topRows(components), Nm = N.bottomRows(groups);
  const Eigen::MatrixXd M = Nc.transpose() * count.asDiagonal() * Nc + Nm.transpose() * Nm;
  const Eigen::LLT<Eigen::MatrixXd> factor(M);
  const Eigen::VectorXd t_free = -factor.solve(Nc.transpose() * sum + Nm.transpose() * m);

  // A strictly convex QP in t with many rows, few of which matter: exchange once more, in `freedom` dimensions.
  const Eigen::VectorXd u0 = u, m0 = m;
  std::vector<RowKey> pool;
  std::vector<Eigen::VectorXd> rows_t;  // L^-1 of each row's coefficients of t
  Eigen::VectorXd t = t_free;
  PoolProblem problem;
  std::vector<char> active;
  for (int round = 0;; ++round) {
    context.check_cancelled();
    const Eigen::VectorXd move = N * t;
    for (int i = 0; i < energy.size(); ++i) u[i] = u0[i] + move[energy.component(i)];
    m = m0 + move.tail(groups);
    Rows::Violations violations;
    rows.evaluate(u, m, violations);
    // The worst bound of every component, group and side, and the worst order row.
    std::vector<int> worst(index(components) * index(groups) * 2, -1);
    for (int i = 0; i < energy.size(); ++i) {
      if (!(violations.bound[index(i)] > tolerance)) continue;
      const std::size_t slot =
          (index(energy.component(i)) * index(groups) + index(rows.constraints().group[index(i)])) * 2 +
          (violations.side[index(i)] == Side::upper ? 1 : 0);
      if (worst[slot] < 0 || violations.bound[index(i)] > violations.bound[index(worst[slot])]) worst[slot] = i;
    }
    std::vector<RowKey> found;
    for (const int i : worst) {
      if (i >= 0) found.push_back({violations.side[index(i)], i});
    }
    if (violations.max_order > tolerance) {
      const auto it = std::max_element(violations.order.begin(), violations.order.end());
      found.push_back({Side::order, static_cast<int>(it - violations.order.begin())});
    }
    bool grown = false;
    for (const RowKey key : found) {
      if (std::find(pool.begin(), pool.end(), key) != pool.end()) continue;
      const Eigen::VectorXd row = N.transpose() * driver_row(energy, rows, key);
      if (row.norm() <= std::sqrt(null_tolerance)) continue;  // t does not move it: round-off of the shape
      pool.push_back(key);
      rows_t.push_back(factor.matrixL().solve(row));
      grown = true;
    }
    if (!grown || round == max_rounds) return static_cast<int>(freedom);
    const auto k = static_cast<Eigen::Index>(pool.size());
    Eigen::MatrixXd Y(freedom, k);
    problem = {};
    problem.B.resize(k, 0);
    problem.P.resize(0, 0);
    problem.d.resize(k);
    for (Eigen::Index a = 0; a < k; ++a) {
      const std::size_t s = static_cast<std::size_t>(a);
      Y.col(a) = rows_t[s];
      problem.d[a] = rows.deficit(pool[s], u0, m0) - rows_t[s].dot(factor.matrixL().transpose() * t_free);
      problem.column.push_back(static_cast<int>(a));
      problem.sign.push_back(1);
      problem.equality.push_back(rows.equality(pool[s]));
    }
    const Eigen::MatrixXd gram = Y.transpose() * Y;
    active.resize(pool.size(), 1);
    PoolQp qp;
    qp.set_problem(gram, problem, false);
    const PoolSolution solution =
        qp.solve(active, Eigen::VectorXd(), 0.1 * tolerance, std::numeric_limits<double>::infinity(), context);
    if (solution.contradictory) {
      throw Error(
          ErrorCode::could_not_solve, "constraints",
          "The depth limits contradict each other: no position of the parts satisfies them all. Raise the thickness or switch off the depth order.");
    }
    active = solution.active;
    t = t_free + factor.matrixL().transpose().solve(Y * solution.y);
  }
}

}  // namespace formwright::bounded_qp_detail
