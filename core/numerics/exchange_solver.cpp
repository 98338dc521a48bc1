// SPDX-License-Identifier: GPL-3.0-or-later
#include "numerics/exchange_solver.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/error.h"

namespace formwright::bounded_qp_detail {

namespace {
constexpr double target_violation = 1e-3;  // of the tolerance: what rounds strive for before they accept
std::size_t at(int i) { return static_cast<std::size_t>(i); }

std::size_t hash_of(const InequalityRow& row) {
  std::size_t h = row.index.size();
  const auto mix = [&h](std::size_t value) { h ^= value + 0x9e3779b9U + (h << 6) + (h >> 2); };
  for (const int i : row.index) mix(static_cast<std::size_t>(i));
  for (const double a : row.coefficient) mix(static_cast<std::size_t>(std::bit_cast<std::uint64_t>(a)));
  return h;
}
}  // namespace

void ExchangeSolver::forget() {
  columns_.reset(energy_.size());
  bound_column_.assign(at(energy_.size()), -1);
  order_columns_.clear();
  gauge_column_ = -1;
  pool_.clear();
  pool_column_.clear();
  active_.clear();
  drivers_.resize(0);
  base_.clear();
}

// Factors with the base taken out and finds u as a function of m with nothing else acting:
//   u = offset + sum_g m_g slope_g,  Q u = 0 off the base,  u on its bound on the base.
void ExchangeSolver::start(const Rows& rows, const std::vector<RowKey>& base, Context& context) {
  const int n = energy_.size(), groups = rows.groups();
  const bool same = base == base_ && bound_column_.size() == at(n);
  if (!same) forget();
  base_ = base;
  std::vector<char> flags;
  if (!base.empty()) {
    flags.assign(at(n), 0);
    for (const RowKey key : base) flags[at(key.index)] = 1;
  }
  energy_.factorize_pinned(flags, context);
  constant_driver_.assign(at(energy_.component_count()), -1);
  int constants = 0;
  for (int k = 0; k < energy_.component_count(); ++k) {
    if (energy_.free_constant(k)) constant_driver_[at(k)] = constants++;
  }
  if (drivers_.size() != constants + groups) {
    drivers_.setZero(constants + groups);
    drivers_.tail(groups) = rows.centred_m();
  }
  base_P_.setZero(groups, groups);
  base_r_.setZero(groups);
  base_offset_.resize(0);
  base_slope_.resize(0, 0);
  if (!base.empty()) {
    Eigen::MatrixXd held = Eigen::MatrixXd::Zero(n, groups + 1);
    for (const RowKey key : base) {
      const double sign = key.side == Side::upper ? -1 : 1;
      held(key.index, groups) = sign * rows.bound(key);
      held(key.index, rows.group(key)) = -sign * rows.slope(key);
    }
    for (Eigen::Index c = 0; c <= groups; ++c) {
      Eigen::VectorXd force = -energy_.apply(held.col(c));
      for (int i = 0; i < n; ++i) {
        if (energy_.fixed(i)) force[i] = 0;
      }
      energy_.factor().solve(force);
      held.col(c) += force;
    }
    for (Eigen::Index c = 0; c < groups; ++c) {
      const Eigen::VectorXd force = energy_.apply(held.col(c));
      base_P_.col(c) = held.leftCols(groups).transpose() * force;
      base_r_[c] = held.col(groups).dot(force);
    }
    base_P_ = (0.5 * (base_P_ + base_P_.transpose())).eval();
    base_offset_ = held.col(groups);
    base_slope_ = held.leftCols(groups);
  }
  if (gauge_column_ < 0 || gauge_ != rows.constraints().gauge) {
    gauge_ = rows.constraints().gauge;
    SparseVector g;
    for (int i = 0; i < n; ++i) {
      if (energy_.fixed(i) || gauge_[i] == 0) continue;
      g.index.push_back(i);
      g.value.push_back(gauge_[i]);
    }
    columns_.append(std::vector{energy_.factor().forward(g)}, context);
    gauge_column_ = columns_.count() - 1;
  }
  // The pool of the call before, as far as its rows still mean the same.
  std::vector<RowKey> kept;
  std::vector<char> active;
  for (std::size_t k = 0; k < pool_.size(); ++k) {
    const RowKey key = pool_[k];
    if (key.side == Side::order && (at(key.index) >= rows.constraints().rows.size() || column_of(rows, key) != pool_column_[k])) continue;
    if (!std::isfinite(rows.bound(key))) continue;
    kept.push_back(key);
    active.push_back(active_[k]);
  }
  pool_ = std::move(kept);
  active_ = std::move(active);
  pool_column_.clear();
  for (const RowKey key : pool_) pool_column_.push_back(column_of(rows, key));
}

int& ExchangeSolver::column_of(const Rows& rows, RowKey key) {
  if (key.side != Side::order) return bound_column_[at(key.index)];
  const InequalityRow& row = rows.constraints().rows[at(key.index)];
  const std::size_t hash = hash_of(row);
  const auto [first, last] = order_columns_.equal_range(hash);
  for (auto it = first; it != last; ++it) {
    if (it->second.row.index == row.index && it->second.row.coefficient == row.coefficient) return it->second.column;
  }
  return order_columns_.emplace(hash, OrderColumn{row, -1})->second.column;
}

void ExchangeSolver::add_to_pool(const Rows& rows, std::span<const RowKey> keys, Context& context) {
  std::vector<SparseVector> forces;
  for (const RowKey key : keys) {
    int& column = column_of(rows, key);
    if (column < 0) {
      column = columns_.count() + static_cast<int>(forces.size());
      SparseVector g;
      if (key.side != Side::order) {
        if (!energy_.fixed(key.index)) g = {{key.index}, {1.0}};
      } else {
        const InequalityRow& row = rows.constraints().rows[at(key.index)];
        std::vector<std::pair<int, double>> entries;
        for (std::size_t k = 0; k < row.index.size(); ++k) {
          if (!energy_.fixed(row.index[k])) entries.emplace_back(row.index[k], row.coefficient[k]);
        }
        std::sort(entries.begin(), entries.end());
        for (const auto& [i, a] : entries) {
          if (!g.index.empty() && g.index.back() == i) g.value.back() += a;
          else g.index.push_back(i), g.value.push_back(a);
        }
      }
      forces.push_back(std::move(g));
    }
    pool_.push_back(key);
    pool_column_.push_back(column);
    active_.push_back(1);
  }
  constexpr std::size_t batch = 64;
  for (std::size_t first = 0; first < forces.size(); first += batch) {
    context.check_cancelled();
    const std::size_t last = std::min(forces.size(), first + batch);
    columns_.append(energy_.factor().forward(std::vector<SparseVector>(forces.begin() + static_cast<std::ptrdiff_t>(first),
                                                                       forces.begin() + static_cast<std::ptrdiff_t>(last))),
                    context);
  }
}

// Row 0 is the gauge. Every row reads g^T (offset + slope m + sum_k c_k 1_k + v) + slope m >= bound.
PoolProblem ExchangeSolver::pool_problem(const Rows& rows) const {
  const int groups = rows.groups(), drivers = static_cast<int>(drivers_.size()), constants = drivers - groups;
  const auto k = static_cast<Eigen::Index>(pool_.size()) + 1;
  PoolProblem p;
  p.B.setZero(k, drivers);
  p.d.setZero(k);
  p.column.assign(1, gauge_column_);
  p.column.insert(p.column.end(), pool_column_.begin(), pool_column_.end());
  p.sign.assign(static_cast<std::size_t>(k), 1);
  p.equality.assign(static_cast<std::size_t>(k), 0);
  p.equality[0] = 1;
  p.P.setZero(drivers, drivers);
  p.P.bottomRightCorner(groups, groups) = base_P_;
  p.r.setZero(drivers);
  p.r.tail(groups) = base_r_;
  for (int i = 0; i < energy_.size(); ++i) {
    const int c = constant_driver_[at(energy_.component(i))];
    if (c >= 0) p.B(0, c) += gauge_[i];
  }
  if (base_offset_.size() > 0) {
    p.B.row(0).tail(groups) = gauge_.transpose() * base_slope_;
    p.d[0] = -gauge_.dot(base_offset_);
  }
  for (Eigen::Index j = 1; j < k; ++j) {
    const RowKey key = pool_[static_cast<std::size_t>(j - 1)];
    if (key.side == Side::upper) p.sign[static_cast<std::size_t>(j)] = -1;
    p.equality[static_cast<std::size_t>(j)] = rows.equality(key);
    p.B(j, constants + rows.group(key)) += rows.slope(key);
    p.d[j] = rows.bound(key);
    const auto touch = [&](int i, double a) {
      const int c = constant_driver_[at(energy_.component(i))];
      if (c >= 0) p.B(j, c) += a;
    };
    if (key.side == Side::order) {
      const InequalityRow& row = rows.constraints().rows[at(key.index)];
      for (std::size_t e = 0; e < row.index.size(); ++e) touch(row.index[e], row.coefficient[e]);
    } else {
      touch(key.index, p.sign[static_cast<std::size_t>(j)]);
    }
    if (base_offset_.size() > 0) {
      p.d[j] -= rows.apply(key, base_offset_);
      for (int g = 0; g < groups; ++g) p.B(j, constants + g) += rows.apply(key, base_slope_.col(g));
    }
  }
  return p;
}

Eigen::VectorXd ExchangeSolver::displacement(const PoolProblem& problem, const PoolSolution& pool) const {
  Eigen::VectorXd by_column = Eigen::VectorXd::Zero(columns_.count());
  for (int a = 0; a < problem.rows(); ++a) by_column[problem.column[at(a)]] += problem.sign[at(a)] * pool.y[a];
  Eigen::VectorXd u = columns_.combine(by_column);
  energy_.factor().backward(u);
  for (int i = 0; i < energy_.size(); ++i) {
    if (energy_.fixed(i)) u[i] = 0;  // unit rows of the factorisation
    const int c = constant_driver_[at(energy_.component(i))];
    if (c >= 0) u[i] += pool.w[c];
  }
  if (base_offset_.size() > 0) u += base_offset_ + base_slope_ * pool.w.tail(base_slope_.cols());
  return u;
}

ExchangeResult ExchangeSolver::solve(const Rows& rows, const std::vector<RowKey>& base, const ExchangeSettings& settings, Context& context) {
  ExchangeResult result;
  start(rows, base, context);
  const double target = target_violation * settings.violation_tolerance;
  const int groups = rows.groups();
  result.u = Eigen::VectorXd::Zero(energy_.size());
  result.m = drivers_.tail(groups);
  PoolProblem problem;
  PoolSolution pool;
  Rows::Violations violations;
  std::vector<RowKey> added;
  Stopwatch watch;
  for (;; ++result.rounds) {
    if (result.rounds > 0 || !pool_.empty() || !base.empty()) {
      watch.lap();
      problem = pool_problem(rows);
      std::vector<char> start(1, 1);
      start.insert(start.end(), active_.begin(), active_.end());
      PoolQp qp(columns_.gram(), problem);
      pool = qp.solve(start, drivers_, target, context);
      result.pivots += pool.pivots;
      if (pool.contradictory) {
        throw Error(ErrorCode::could_not_solve, "constraints", "The constraints contradict each other: no displacement satisfies them all.");
      }
      active_.assign(pool.active.begin() + 1, pool.active.end());
      drivers_ = pool.w;
      result.m = pool.w.tail(groups);
      result.seconds_pool += watch.lap();
      result.u = displacement(problem, pool);
      result.seconds_sweeps += watch.lap();
    }
    rows.evaluate(result.u, result.m, violations);
    result.violation_max = violations.max;
    std::vector<RowKey> keys = rows.local_maxima(violations, target);
    result.seconds_sweeps += watch.lap();
    std::erase_if(keys, [&](RowKey key) { return std::find(pool_.begin(), pool_.end(), key) != pool_.end(); });
    result.history.push_back({violations.max, static_cast<int>(pool_.size()), static_cast<int>(std::count(active_.begin(), active_.end(), 1)), pool.pivots});
    if (violations.max <= target || keys.empty() || result.rounds >= settings.max_rounds) break;
    add_to_pool(rows, keys, context);
    result.seconds_columns += watch.lap();
    context.progress(static_cast<double>(result.rounds) / (result.rounds + 5), "Finding contacts");
  }
  result.columns = columns_.count();
  std::vector<double> multiplier;
  for (std::size_t k = 0; k < pool_.size(); ++k) {
    if (!active_[k] || (pool.y[static_cast<Eigen::Index>(k) + 1] == 0 && !rows.equality(pool_[k]))) continue;
    result.active.push_back(pool_[k]);
    multiplier.push_back(pool.y[static_cast<Eigen::Index>(k) + 1]);
  }
  result.multiplier = Eigen::Map<const Eigen::VectorXd>(multiplier.data(), static_cast<Eigen::Index>(multiplier.size()));
  if (pool.y.size() > 0) result.gauge_multiplier = pool.y[0];
  return result;
}

}  // namespace formwright::bounded_qp_detail
