// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// An independent solver for small bounded QPs, dense throughout, and random problems to try it on.
// Nothing here is shared with the solver under test but the structs that state the problem.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "numerics/qp/bounded_qp.h"

namespace formwright::test {

inline constexpr double infinity = std::numeric_limits<double>::infinity();

/// xorshift64*: the same numbers on every platform.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed * 0x9e3779b97f4a7c15ULL + 88172645463325252ULL) {
    for (int i = 0; i < 8; ++i) unit();
  }
  double unit() {  // [0, 1)
    state_ ^= state_ >> 12;
    state_ ^= state_ << 25;
    state_ ^= state_ >> 27;
    return static_cast<double>((state_ * 0x2545f4914f6cdd1dULL) >> 11) * 0x1.0p-53;
  }
  double between(double low, double high) { return low + (high - low) * unit(); }
  int below(int count) { return static_cast<int>(unit() * count); }
  bool chance(double p) { return unit() < p; }

 private:
  std::uint64_t state_;
};

/// min 1/2 x^T H x, A x >= b, E x = 0, with x = (u, m).
struct DenseProblem {
  Eigen::MatrixXd H, A, E;
  Eigen::VectorXd b;
};

inline DenseProblem dense_problem(const Eigen::MatrixXd& Q, const BoundedQpConstraints& c) {
  const Eigen::Index n = Q.rows(), groups = c.group_count;
  std::vector<Eigen::VectorXd> rows;
  std::vector<double> bounds;
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Index m = n + c.group[static_cast<std::size_t>(i)];
    if (std::isfinite(c.lower[i])) {
      Eigen::VectorXd row = Eigen::VectorXd::Zero(n + groups);
      row[i] = 1;
      row[m] = -c.lower_slope[i];
      rows.push_back(row);
      bounds.push_back(c.lower[i]);
    }
    if (std::isfinite(c.upper[i])) {
      Eigen::VectorXd row = Eigen::VectorXd::Zero(n + groups);
      row[i] = -1;
      row[m] = c.upper_slope[i];
      rows.push_back(row);
      bounds.push_back(-c.upper[i]);
    }
  }
  for (const InequalityRow& r : c.rows) {
    Eigen::VectorXd row = Eigen::VectorXd::Zero(n + groups);
    for (std::size_t k = 0; k < r.index.size(); ++k) row[r.index[k]] += r.coefficient[k];
    row[n + r.group] += r.slope;
    rows.push_back(row);
    bounds.push_back(r.bound);
  }
  DenseProblem p;
  p.H = Eigen::MatrixXd::Zero(n + groups, n + groups);
  p.H.topLeftCorner(n, n) = Q;
  p.A.resize(static_cast<Eigen::Index>(rows.size()), n + groups);
  for (std::size_t r = 0; r < rows.size(); ++r) p.A.row(static_cast<Eigen::Index>(r)) = rows[r];
  p.b = Eigen::Map<const Eigen::VectorXd>(bounds.data(), static_cast<Eigen::Index>(bounds.size()));
  p.E = Eigen::MatrixXd::Zero(1, n + groups);
  p.E.leftCols(n) = c.gauge.transpose() / c.gauge.cwiseAbs().sum();
  return p;
}

struct DenseSolution {
  Eigen::VectorXd x;
  double objective = 0, violation = 0, gap = 0;
};

/// Primal-dual path following (Nocedal and Wright 2006, Alg. 16.4) on the full, unreduced KKT system by LU with
/// full pivoting. A proximal term, recentred every step, covers directions that nothing determines.
inline DenseSolution solve_dense(const DenseProblem& p) {
  const Eigen::Index n = p.H.rows(), m = p.A.rows(), e = p.E.rows();
  Eigen::VectorXd x = Eigen::VectorXd::Zero(n), y = Eigen::VectorXd::Zero(e);
  Eigen::VectorXd s = (p.A * x - p.b).cwiseMax(1.0), z = Eigen::VectorXd::Ones(m);
  DenseSolution result;
  double best = infinity;
  int unimproved = 0;
  for (int iteration = 0; iteration < 200; ++iteration) {
    const Eigen::VectorXd rd = p.H * x - p.A.transpose() * z - p.E.transpose() * y, re = p.E * x,
                          rp = p.A * x - p.b - s;
    const double mu = m > 0 ? s.dot(z) / static_cast<double>(m) : 0;
    // Near the end round-off in K stops all progress: the best iterate counts.
    const double merit =
        s.dot(z) + rd.cwiseAbs().maxCoeff() + re.cwiseAbs().maxCoeff() + (m > 0 ? rp.cwiseAbs().maxCoeff() : 0);
    if (merit < best) {
      best = merit;
      result.x = x;
      result.gap = s.dot(z);
      unimproved = 0;
    } else if (++unimproved > 10) {
      break;
    }
    if (merit < 1e-13) break;
    Eigen::MatrixXd K = Eigen::MatrixXd::Zero(n + e, n + e);
    K.topLeftCorner(n, n) = p.H + p.A.transpose() * (z.array() / s.array()).matrix().asDiagonal() * p.A;
    K.topLeftCorner(n, n).diagonal().array() += 1e-11;
    K.topRightCorner(n, e) = -p.E.transpose();
    K.bottomLeftCorner(e, n) = -p.E;
    const Eigen::FullPivLU<Eigen::MatrixXd> lu(K);
    const auto direction = [&](const Eigen::VectorXd& target) {  // wanted s z
      Eigen::VectorXd rhs(n + e);
      rhs.head(n) = -rd + p.A.transpose() *
                              ((target.array() - s.array() * z.array() - z.array() * rp.array()) / s.array()).matrix();
      rhs.tail(e) = re;
      return Eigen::VectorXd(lu.solve(rhs));
    };
    const auto reach = [](const Eigen::VectorXd& v, const Eigen::VectorXd& dv) {
      double step = 1;
      for (Eigen::Index i = 0; i < v.size(); ++i) {
        if (dv[i] < 0) step = std::min(step, -v[i] / dv[i]);
      }
      return step;
    };
    Eigen::VectorXd target = Eigen::VectorXd::Zero(m), d, ds, dz;
    for (int pass = 0; pass < 2; ++pass) {
      d = direction(target);
      ds = p.A * d.head(n) + rp;
      dz = ((target.array() - s.array() * z.array() - z.array() * ds.array()) / s.array()).matrix();
      if (pass == 1) break;
      const double step = std::min(reach(s, ds), reach(z, dz));
      const double affine = (s + step * ds).dot(z + step * dz) / std::max<double>(1, static_cast<double>(m));
      const double sigma = mu > 0 ? std::pow(affine / mu, 3) : 0;
      target = (sigma * mu - ds.array() * dz.array()).matrix();
    }
    const double step = std::min(1.0, 0.995 * std::min(reach(s, ds), reach(z, dz)));
    x += step * d.head(n);
    y += step * d.tail(e);
    s += step * ds;
    z += step * dz;
  }
  result.objective = 0.5 * result.x.dot(p.H * result.x);
  result.violation = m > 0 ? std::max(0.0, (p.b - p.A * result.x).maxCoeff()) : 0;
  return result;
}

/// Proof of optimality: the smallest max |H x - A^T z - E^T y| / max |H x| over z >= 0 on the rows that x touches
/// (within `touching`), by Lawson and Hanson's NNLS. Zero up to round-off if and only if a feasible x is optimal.
inline double stationarity_gap(const DenseProblem& p, const Eigen::VectorXd& x, double touching) {
  const Eigen::VectorXd force = p.H * x, slack = p.A * x - p.b;
  std::vector<Eigen::VectorXd> columns;
  for (Eigen::Index r = 0; r < p.A.rows(); ++r) {
    if (slack[r] <= touching) columns.push_back(p.A.row(r).transpose());
  }
  for (Eigen::Index r = 0; r < p.E.rows(); ++r) {
    columns.push_back(p.E.row(r).transpose());
    columns.push_back(-p.E.row(r).transpose());
  }
  const auto k = static_cast<Eigen::Index>(columns.size());
  Eigen::MatrixXd C(x.size(), k);
  for (Eigen::Index j = 0; j < k; ++j) C.col(j) = columns[static_cast<std::size_t>(j)];
  Eigen::VectorXd z = Eigen::VectorXd::Zero(k);
  std::vector<Eigen::Index> passive;
  const double size = std::max(force.cwiseAbs().maxCoeff(), 1e-300);
  for (int iteration = 0; iteration < 20 * static_cast<int>(k) + 20; ++iteration) {
    const Eigen::VectorXd pull = C.transpose() * (force - C * z);
    Eigen::Index enter = -1;
    for (Eigen::Index j = 0; j < k; ++j) {
      if (std::find(passive.begin(), passive.end(), j) == passive.end() && pull[j] > 1e-13 * size &&
          (enter < 0 || pull[j] > pull[enter]))
        enter = j;
    }
    if (enter < 0) break;
    passive.push_back(enter);
    for (;;) {
      Eigen::MatrixXd part(x.size(), static_cast<Eigen::Index>(passive.size()));
      for (std::size_t j = 0; j < passive.size(); ++j) part.col(static_cast<Eigen::Index>(j)) = C.col(passive[j]);
      const Eigen::VectorXd goal = part.completeOrthogonalDecomposition().solve(force);
      double step = 1;
      for (std::size_t j = 0; j < passive.size(); ++j) {
        const double now = z[passive[j]], to = goal[static_cast<Eigen::Index>(j)];
        if (to <= 0) step = std::min(step, now > 0 ? now / (now - to) : 0.0);
      }
      for (std::size_t j = 0; j < passive.size(); ++j)
        z[passive[j]] += step * (goal[static_cast<Eigen::Index>(j)] - z[passive[j]]);
      if (step >= 1) break;
      std::vector<Eigen::Index> kept;
      for (const Eigen::Index j : passive) {
        if (z[j] > 1e-15 * size) kept.push_back(j);
        else z[j] = 0;
      }
      passive = kept;
    }
  }
  return (force - C * z).cwiseAbs().maxCoeff() / size;
}

/// Q = sum over components of L^T W L, L a random connected graph Laplacian: null space constants, fourth order.
struct RandomProblem {
  Eigen::MatrixXd Q;
  std::vector<int> component;
  BoundedQpConstraints constraints;
  Eigen::VectorXd feasible_u, feasible_m;
};

struct RandomProblemSettings {
  int size = 24, components = 1, groups = 1, rows = 0;
  bool perspective = false;  // slopes 1 + kappa bound
  double free_bounds = 0.2;  // share of bounds that are infinite
  double equal_bounds = 0;   // share of unknowns with lower = upper
  double tightness = 0.5;    // 0: the feasible point is wide of its bounds
  int near_copies = 0;       // of every row, with coefficients and bound changed by 1e-10 to 1e-4
};

inline RandomProblem random_problem(std::uint64_t seed, const RandomProblemSettings& settings) {
  Random random(seed);
  const int n = settings.size;
  RandomProblem p;
  p.component.resize(static_cast<std::size_t>(n));
  Eigen::MatrixXd L = Eigen::MatrixXd::Zero(n, n);
  const auto join = [&](int a, int b, double w) {
    L(a, a) += w;
    L(b, b) += w;
    L(a, b) -= w;
    L(b, a) -= w;
  };
  std::vector<int> last(static_cast<std::size_t>(settings.components), -1);
  for (int i = 0; i < n; ++i) {
    const int k = i < settings.components ? i : random.below(settings.components);
    p.component[static_cast<std::size_t>(i)] = k;
    int& before = last[static_cast<std::size_t>(k)];
    if (before >= 0) join(before, i, random.between(0.5, 2));
    before = i;
  }
  for (int extra = 0; extra < n; ++extra) {
    const int a = random.below(n), b = random.below(n);
    if (a != b && p.component[static_cast<std::size_t>(a)] == p.component[static_cast<std::size_t>(b)])
      join(a, b, random.between(0.5, 2));
  }
  Eigen::VectorXd weight(n);
  for (int i = 0; i < n; ++i) weight[i] = random.between(0.3, 3);
  p.Q = L.transpose() * weight.asDiagonal() * L;

  BoundedQpConstraints& c = p.constraints;
  c.group_count = settings.groups;
  c.gauge.resize(n);
  c.group.resize(static_cast<std::size_t>(n));
  p.feasible_u.resize(n);
  p.feasible_m.resize(settings.groups);
  for (int i = 0; i < n; ++i) {
    c.gauge[i] = random.between(0.5, 1.5);
    c.group[static_cast<std::size_t>(i)] = random.below(settings.groups);
    p.feasible_u[i] = random.between(-1, 1);
  }
  p.feasible_u.array() -= c.gauge.dot(p.feasible_u) / c.gauge.sum();
  for (int g = 0; g < settings.groups; ++g) p.feasible_m[g] = random.between(-0.3, 0.3);
  c.lower.resize(n);
  c.upper.resize(n);
  c.lower_slope = c.upper_slope = Eigen::VectorXd::Ones(n);
  const double kappa = 0.4;
  for (int i = 0; i < n; ++i) {
    const double m = p.feasible_m[c.group[static_cast<std::size_t>(i)]], room = 1.01 - settings.tightness;
    double low = p.feasible_u[i] - room * random.unit(), high = p.feasible_u[i] + room * random.unit();
    if (random.chance(settings.equal_bounds)) low = high = p.feasible_u[i];
    if (settings.perspective) {  // bound + (1 + kappa bound) m = wanted
      c.lower[i] = (low - m) / (1 + kappa * m);
      c.upper[i] = (high - m) / (1 + kappa * m);
      c.lower_slope[i] = 1 + kappa * c.lower[i];
      c.upper_slope[i] = 1 + kappa * c.upper[i];
    } else {
      c.lower[i] = low - m;
      c.upper[i] = high - m;
    }
    if (low < high && random.chance(settings.free_bounds)) c.lower[i] = -infinity;
    if (low < high && random.chance(settings.free_bounds)) c.upper[i] = infinity;
  }
  for (int r = 0; r < settings.rows; ++r) {
    InequalityRow row;
    const double a = random.unit();
    for (const double coefficient : {1.0, -a, a - 1}) {
      row.index.push_back(random.below(n));
      row.coefficient.push_back(coefficient);
    }
    row.group = random.below(settings.groups);
    row.slope = random.chance(0.2) ? random.between(-0.5, 0.5) : 0;
    double value = row.slope * p.feasible_m[row.group];
    for (std::size_t k = 0; k < row.index.size(); ++k) value += row.coefficient[k] * p.feasible_u[row.index[k]];
    row.bound = value - random.between(0, 0.3);
    c.rows.push_back(row);
  }
  for (int r = 0; r < settings.rows; ++r) {
    for (int copy = 0; copy < settings.near_copies; ++copy) {
      InequalityRow row = c.rows[static_cast<std::size_t>(r)];
      const double change = std::pow(10, random.between(-10, -4));
      double shift = 0;
      for (std::size_t k = 0; k < row.index.size(); ++k) {
        const double more = change * random.between(-1, 1);
        row.coefficient[k] += more;
        shift += more * p.feasible_u[row.index[k]];
      }
      row.bound += shift - change * random.unit();  // the feasible point stays so
      c.rows.push_back(row);
    }
  }
  return p;
}

inline SparseMatrix lower_triangle(const Eigen::MatrixXd& Q) {
  SparseMatrix lower = Q.sparseView().eval().triangularView<Eigen::Lower>();
  for (Eigen::Index i = 0; i < Q.rows(); ++i) lower.coeffRef(static_cast<int>(i), static_cast<int>(i)) = Q(i, i);
  lower.makeCompressed();
  return lower;
}

}  // namespace formwright::test
