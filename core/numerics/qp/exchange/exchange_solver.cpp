// SPDX-License-Identifier: GPL-3.0-or-later
#include "numerics/qp/exchange/exchange_solver.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "base/error.h"
#include "base/index.h"
#include "numerics/convergence.h"

namespace formwright::bounded_qp_detail {

namespace {
constexpr double target_violation = 1e-3;  // of the tolerance: what rounds strive for
// Many rows that are new at once tell the pool's pivoting too little about which of them will hold.
constexpr int min_batch = 300, batch_part = 4;
constexpr int max_refinements = 3;         // at most, per round
constexpr double spreading = 1.01;         // times the rows that were missing a round before
constexpr double force_tolerance = 1e-10;  // on Q u - forces, relative: above it a refinement is tried
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
  bound_column_.assign(index(energy_.size()), -1);
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
  const bool same = base == base_ && bound_column_.size() == index(n);
  if (!same) forget();
  base_ = base;
  std::vector<char> flags;
  if (!base.empty()) {
    flags.assign(index(n), 0);
    for (const RowKey key : base) flags[index(key.index)] = 1;
  }
  energy_.factorize_pinned(flags, context);
  constant_driver_.assign(index(energy_.component_count()), -1);
  int constants = 0;
  for (int k = 0; k < energy_.component_count(); ++k) {
    if (energy_.free_constant(k)) constant_driver_[index(k)] = constants++;
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
      held(key.index, groups) = rows.bound(key);
      held(key.index, rows.group(key)) = -rows.slope(key);
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
  const double gauge_size = rows.constraints().gauge.cwiseAbs().sum();
  const Eigen::VectorXd gauge =
      gauge_size > 0 ? Eigen::VectorXd(rows.constraints().gauge / gauge_size) : Eigen::VectorXd();
  if (gauge.size() == 0) {
    gauge_column_ = -1;
  } else if (gauge_column_ < 0 || gauge_ != gauge) {
    SparseVector g;
    for (int i = 0; i < n; ++i) {
      if (energy_.fixed(i) || gauge[i] == 0) continue;
      g.index.push_back(i);
      g.value.push_back(gauge[i]);
    }
    columns_.append(std::vector{energy_.factor().forward(g)}, context);
    gauge_column_ = columns_.count() - 1;
  }
  gauge_ = gauge;
  // The pool of the call before, as far as its rows still mean the same.
  std::vector<RowKey> kept;
  std::vector<char> active;
  for (std::size_t k = 0; k < pool_.size(); ++k) {
    const RowKey key = pool_[k];
    if (key.side == Side::order &&
        (index(key.index) >= rows.constraints().rows.size() || column_of(rows, key) != pool_column_[k]))
      continue;
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
  if (key.side != Side::order) return bound_column_[index(key.index)];
  const InequalityRow& row = rows.constraints().rows[index(key.index)];
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
        const InequalityRow& row = rows.constraints().rows[index(key.index)];
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
    columns_.append(
        energy_.factor().forward(std::vector<SparseVector>(forces.begin() + static_cast<std::ptrdiff_t>(first),
                                                           forces.begin() + static_cast<std::ptrdiff_t>(last))),
        context);
  }
}

// The gauge, then the pool's rows, so that new ones come last. Every row reads g^T (offset + slope m + sum_k c_k 1_k +
// v) + slope m >= bound.
PoolProblem ExchangeSolver::pool_problem(const Rows& rows) const {
  const int groups = rows.groups(), drivers = static_cast<int>(drivers_.size()), constants = drivers - groups;
  const Eigen::Index first = gauge_rows(), k = first + static_cast<Eigen::Index>(pool_.size());
  PoolProblem p;
  p.B.setZero(k, drivers);
  p.d.setZero(k);
  p.sign.assign(static_cast<std::size_t>(k), 1);
  p.equality.assign(static_cast<std::size_t>(k), 0);
  p.P.setZero(drivers, drivers);
  p.P.bottomRightCorner(groups, groups) = base_P_;
  p.r.setZero(drivers);
  p.r.tail(groups) = base_r_;
  if (first > 0) {
    p.column.push_back(gauge_column_);
    p.equality[0] = 1;
    for (int i = 0; i < energy_.size(); ++i) {
      const int c = constant_driver_[index(energy_.component(i))];
      if (c >= 0) p.B(0, c) += gauge_[i];
    }
    if (base_offset_.size() > 0) {
      p.B.row(0).tail(groups) = gauge_.transpose() * base_slope_;
      p.d[0] = -gauge_.dot(base_offset_);
    }
  }
  p.column.insert(p.column.end(), pool_column_.begin(), pool_column_.end());
  for (Eigen::Index j = first; j < k; ++j) {
    const RowKey key = pool_[static_cast<std::size_t>(j - first)];
    if (key.side == Side::upper) p.sign[static_cast<std::size_t>(j)] = -1;
    p.equality[static_cast<std::size_t>(j)] = rows.equality(key);
    p.B(j, constants + rows.group(key)) += rows.slope(key);
    p.d[j] = rows.bound(key);
    const auto touch = [&](int i, double a) {
      const int c = constant_driver_[index(energy_.component(i))];
      if (c >= 0) p.B(j, c) += a;
    };
    if (key.side == Side::order) {
      const InequalityRow& row = rows.constraints().rows[index(key.index)];
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

Eigen::VectorXd ExchangeSolver::by_column(const PoolProblem& problem, const Eigen::VectorXd& y) const {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(columns_.count());
  for (int a = 0; a < problem.rows(); ++a) sum[problem.column[index(a)]] += problem.sign[index(a)] * y[a];
  return sum;
}

// Clears the unit rows of the factorisation and adds what the drivers do.
void ExchangeSolver::add_drivers(const Eigen::VectorXd& w, Eigen::VectorXd& u) const {
  for (int i = 0; i < energy_.size(); ++i) {
    if (energy_.fixed(i)) u[i] = 0;
    const int c = constant_driver_[index(energy_.component(i))];
    if (c >= 0) u[i] += w[c];
  }
  if (base_offset_.size() > 0) u += base_slope_ * w.tail(base_slope_.cols());
}

Eigen::VectorXd ExchangeSolver::forces(const Rows& rows, const PoolSolution& pool) const {
  Eigen::VectorXd f = Eigen::VectorXd::Zero(energy_.size());
  const Eigen::Index first = gauge_rows();
  for (std::size_t k = 0; k < pool_.size(); ++k)
    rows.add_force(pool_[k], pool.y[first + static_cast<Eigen::Index>(k)], f);
  if (first > 0) f += pool.y[0] * gauge_;
  return f;
}

double ExchangeSolver::force_residual(const Rows& rows, const PoolSolution& pool, const Eigen::VectorXd& u) const {
  const Eigen::VectorXd force = forces(rows, pool), left = energy_.apply(u) - force;
  double worst = 0;
  for (int i = 0; i < energy_.size(); ++i) {
    if (base_.empty() || !energy_.fixed(i)) worst = std::max(worst, std::abs(left[i]));
  }
  return worst / std::max(force.cwiseAbs().maxCoeff(), std::numeric_limits<double>::min());
}

// One step of iterative refinement of the whole KKT system on the active set: the factor of Q is exact to round-off
// times its condition number, which for a fourth-order energy on a poor mesh is not enough.
void ExchangeSolver::refine(const Rows& rows, const PoolProblem& problem, const PoolQp& qp, PoolSolution& pool,
                            Eigen::VectorXd& u) const {
  const Eigen::Index groups = rows.groups();
  const Eigen::VectorXd force = forces(rows, pool);
  Eigen::VectorXd z = force - energy_.apply(u);
  for (int i = 0; i < energy_.size(); ++i) {
    if (energy_.fixed(i)) z[i] = 0;
  }
  energy_.factor().forward(Eigen::Ref<Eigen::VectorXd>(z));
  const Eigen::VectorXd moved = columns_.project(z);  // by what the step so far moves every row
  const Eigen::VectorXd m = pool.w.tail(groups);
  Eigen::VectorXd slack_error(problem.rows());
  for (int a = 0; a < problem.rows(); ++a) {
    const double error = a >= gauge_rows() ? rows.deficit(pool_[index(a - gauge_rows())], u, m) : -gauge_.dot(u);
    slack_error[a] = error - problem.sign[index(a)] * moved[problem.column[index(a)]];
  }
  const Eigen::VectorXd balance = problem.P * pool.w + problem.r - problem.B.transpose() * pool.y;
  const auto [dy, dw] = qp.correct(slack_error, balance);
  z += columns_.combine(by_column(problem, dy));
  energy_.factor().backward(z);
  add_drivers(dw, z);
  u += z;
  pool.w += dw;
  pool.y += dy;
  for (int a = 0; a < problem.rows(); ++a) {
    if (!problem.equality[index(a)]) pool.y[a] = std::max(pool.y[a], 0.0);
  }
}

ExchangeResult ExchangeSolver::solve(const Rows& rows, const std::vector<RowKey>& base,
                                     const ExchangeSettings& settings, Context& context) {
  try {
    return run(rows, base, settings, context);
  } catch (...) {
    forget();  // columns may have been promised that a cancel kept from being made
    throw;
  }
}

ExchangeResult ExchangeSolver::run(const Rows& rows, const std::vector<RowKey>& base, const ExchangeSettings& settings,
                                   Context& context) {
  ExchangeResult result;
  Stopwatch watch;
  const double work_before = columns_.work();
  start(rows, base, context);
  result.seconds.factorise = watch.lap();
  const double target = target_violation * settings.violation_tolerance;
  const int groups = rows.groups();
  result.u = Eigen::VectorXd::Zero(energy_.size());
  result.m = drivers_.tail(groups);
  PoolProblem problem;
  PoolSolution pool;
  PoolQp qp;
  bool grown = false;
  Rows::Violations violations;
  std::optional<Convergence> convergence;
  double missing_before = std::numeric_limits<double>::infinity();  // rows worth adding after a round
  for (;; ++result.rounds) {
    const bool at_rest = result.rounds == 0 && pool_.empty() && base.empty();  // u = 0 is optimal for no constraints
    if (!at_rest) {
      problem = pool_problem(rows);
      std::vector<char> start_active(index(gauge_rows()), 1);
      start_active.insert(start_active.end(), active_.begin(), active_.end());
      qp.set_problem(columns_.gram(), problem, grown);
      grown = true;
      const double columns_work = columns_.work() - work_before;
      pool = qp.solve(start_active, drivers_, target, settings.max_work - columns_work, context);
      result.work = columns_work + qp.work();
      if (pool.contradictory) {
        throw Error(
            ErrorCode::could_not_solve, "constraints",
            "The depth limits contradict each other, so there is no such relief: raise the thickness or switch off the depth order.");
      }
      active_.assign(pool.active.begin() + gauge_rows(), pool.active.end());
      drivers_ = pool.w;
      result.seconds.pool += watch.lap();
      result.u = columns_.combine(by_column(problem, pool.y));
      energy_.factor().backward(result.u);
      add_drivers(pool.w, result.u);
      if (base_offset_.size() > 0) result.u += base_offset_;
    }
    if (!at_rest && pool.stopped) {
      result.stopped = true;
      break;
    }
    std::vector<RowKey> keys;
    for (int pass = 0;; ++pass) {
      result.m = at_rest ? drivers_.tail(groups) : pool.w.tail(groups);
      rows.evaluate(result.u, result.m, violations);
      keys = rows.worth_adding(violations, target);
      std::erase_if(keys, [&](RowKey key) { return std::find(pool_.begin(), pool_.end(), key) != pool_.end(); });
      if (at_rest || pass == max_refinements) break;
      // Round-off matters once nothing else is left to improve.
      double held = 0, left = 0;
      for (std::size_t k = 0; k < pool_.size(); ++k) {
        if (active_[k]) held = std::max(held, std::abs(rows.violation(pool_[k], result.u, result.m)));
      }
      for (const RowKey key : keys) left = std::max(left, rows.violation(key, result.u, result.m));
      if (left > 10 * held) break;
      if (held <= 0.1 * settings.violation_tolerance &&
          (!keys.empty() || force_residual(rows, pool, result.u) <= force_tolerance))
        break;
      refine(rows, problem, qp, pool, result.u);
    }
    result.seconds.sweeps += watch.lap();
    result.history.push_back({violations.max, static_cast<int>(pool_.size()),
                              static_cast<int>(std::count(active_.begin(), active_.end(), 1)), pool.pivots});
    if (keys.empty()) break;
    if (result.rounds >= settings.max_rounds) {
      result.stopped = true;
      break;
    }
    const int max_new = std::max(min_batch, result.history.back().active / batch_part);
    const auto missing = static_cast<double>(keys.size());
    if (result.work > settings.work_to_judge && missing > max_new && missing > spreading * missing_before) {
      result.stopped = result.spread = true;
      break;
    }
    missing_before = missing;
    if (static_cast<int>(keys.size()) > max_new) keys.resize(index(max_new));  // the worst first
    add_to_pool(rows, keys, context);
    result.seconds.columns += watch.lap();
    // The last rounds find every row that is left at once: seven decades below the first violation.
    if (!convergence) convergence.emplace(std::max(settings.violation_tolerance, 1e-7 * violations.max));
    context.progress(convergence->passed(violations.max), "Finding contacts");
  }
  result.violation_max = violations.max;
  result.columns = columns_.count();
  std::vector<double> multiplier;
  for (std::size_t k = 0; k < pool_.size(); ++k) {
    const Eigen::Index row = gauge_rows() + static_cast<Eigen::Index>(k);
    const double y = pool.y[row];
    if (y == 0 && !rows.equality(pool_[k])) continue;
    result.active.push_back(pool_[k]);
    multiplier.push_back(y);
    if (std::abs(pool.push[row]) > settings.violation_tolerance) result.pushing.push_back(pool_[k]);
  }
  result.multiplier =
      Eigen::Map<const Eigen::VectorXd>(multiplier.data(), static_cast<Eigen::Index>(multiplier.size()));
  result.force = pool.y.size() > 0 ? forces(rows, pool) : Eigen::VectorXd::Zero(energy_.size());
  return result;
}

}  // namespace formwright::bounded_qp_detail
