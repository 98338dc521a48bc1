// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Exchange: solve for a small pool of constraints, add those that the result violates most, repeat.
// A dual active-set method in the spirit of Goldfarb and Idnani 1983 and of Remez's exchange, with one factorisation.
#include <Eigen/Core>
#include <limits>
#include <span>
#include <unordered_map>
#include <vector>

#include "base/context.h"
#include "numerics/qp/problem/bounded_qp_energy.h"
#include "numerics/qp/problem/bounded_qp_rows.h"
#include "numerics/qp/exchange/exchange_columns.h"
#include "numerics/qp/exchange/exchange_pool_qp.h"

namespace formwright::bounded_qp_detail {

struct ExchangeSettings {
  double violation_tolerance = 0;                             // to accept
  int max_rounds = 200;                                       // then: stop, with `stopped`
  double max_work = std::numeric_limits<double>::infinity();  // multiplications, about: stop, with `stopped`
  /// From here on, stop as well once more rows are missing than join in a round, and more than a round before.
  double work_to_judge = std::numeric_limits<double>::infinity();
};

struct ExchangeResult {
  Eigen::VectorXd u, m;
  std::vector<RowKey> active;   // rows with a positive multiplier; equalities always; the base excluded
  Eigen::VectorXd multiplier;   // of those
  std::vector<RowKey> pushing;  // those whose force moves u by more than the tolerance
  Eigen::VectorXd force;        // n: all multipliers times their rows, the gauge's included; Q u off the base
  double violation_max = 0;
  int rounds = 0, columns = 0, pivots = 0;
  double work = 0;       // multiplications, about
  bool stopped = false;  // violations are left, or the work ran out
  bool spread = false;   // stopped because contacts spread: u is the optimum of the rows that were looked at
  std::vector<BoundedQpRound> history;
  BoundedQpSeconds seconds;
};

class ExchangeSolver {
 public:
  explicit ExchangeSolver(Energy& energy) : energy_(energy) {}

  /// `base`: unknowns whose bounds are equal; they leave the factorisation.
  /// Starts from the active set of the call before if the base is the same. Throws Error: could_not_solve.
  ExchangeResult solve(const Rows& rows, const std::vector<RowKey>& base, const ExchangeSettings& settings,
                       Context& context);

  /// Drops columns and active set; needed after the energy has changed.
  void forget();
  double memory_mb() const { return columns_.memory_mb(); }

 private:
  ExchangeResult run(const Rows& rows, const std::vector<RowKey>& base, const ExchangeSettings& settings,
                     Context& context);
  void start(const Rows& rows, const std::vector<RowKey>& base, Context& context);
  void add_to_pool(const Rows& rows, std::span<const RowKey> keys, Context& context);
  int& column_of(const Rows& rows, RowKey key);
  int gauge_rows() const { return gauge_column_ >= 0 ? 1 : 0; }
  PoolProblem pool_problem(const Rows& rows) const;
  Eigen::VectorXd by_column(const PoolProblem& problem, const Eigen::VectorXd& y) const;
  void add_drivers(const Eigen::VectorXd& w, Eigen::VectorXd& u) const;
  void refine(const Rows& rows, const PoolProblem& problem, const PoolQp& qp, PoolSolution& pool,
              Eigen::VectorXd& u) const;
  Eigen::VectorXd forces(const Rows& rows, const PoolSolution& pool) const;
  double force_residual(const Rows& rows, const PoolSolution& pool, const Eigen::VectorXd& u) const;

  Energy& energy_;
  ExchangeColumns columns_;
  std::vector<int> bound_column_;  // n; column of e_i, or -1
  struct OrderColumn {
    InequalityRow row;
    int column;
  };
  std::unordered_multimap<std::size_t, OrderColumn> order_columns_;  // by a hash of the row's contents
  int gauge_column_ = -1;
  Eigen::VectorXd gauge_;  // n, absolute values add up to 1; or empty
  std::vector<RowKey> pool_;
  std::vector<int> pool_column_;
  std::vector<char> active_;          // pool rows
  Eigen::VectorXd drivers_;           // free constants, then m
  std::vector<int> constant_driver_;  // component -> driver, or -1
  std::vector<RowKey> base_;
  Eigen::VectorXd base_offset_;  // n, or empty: u with all drivers at zero
  Eigen::MatrixXd base_slope_;   // n x groups, or empty: du/dm
  Eigen::MatrixXd base_P_;       // groups x groups
  Eigen::VectorXd base_r_;       // groups
};

}  // namespace formwright::bounded_qp_detail
