// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a bounded quadratic program (bounded_qp.h) consists of: constraints, options, solution.
#include <Eigen/Core>
#include <vector>

#include "base/data/parameters.h"

namespace formwright {

struct InequalityRow {
  std::vector<int> index;
  std::vector<double> coefficient;
  double slope = 0;  // of m_group
  int group = 0;
  double bound = 0;
};

struct BoundedQpConstraints {
  Eigen::VectorXd lower, upper;              // n; -inf / +inf where free
  Eigen::VectorXd lower_slope, upper_slope;  // n
  std::vector<int> group;                    // n; which m a bound moves with
  int group_count = 1;
  std::vector<InequalityRow> rows;
  Eigen::VectorXd gauge;  // n
  /// A point well within the bounds (n, group_count), or empty. The interior point starts there.
  Eigen::VectorXd start_u, start_m;
  /// Whether it satisfies the rows, too. An answer that has to be given before the optimum is found then moves towards
  /// it until it satisfies every row.
  bool start_satisfies_rows = false;
};

enum class QpMethod { automatic, exchange, interior_point };
template <>
struct EnumNames<QpMethod> {
  static constexpr std::array<std::string_view, 3> names{"automatic", "exchange", "interior_point"};
  static constexpr std::array<std::string_view, 3> labels{"Automatic", "Exchange", "Interior point"};
};

struct BoundedQpOptions {
  QpMethod method = QpMethod::automatic;
  double violation_tolerance =
      1e-9;  // in units of u, absolute: what rounds strive for; bounds hold exactly, see violation_max
  int max_rounds = 200;
  double max_exchange_work = 0;  // multiplications, about, before the interior point takes over; 0: by its own work
  int max_iterations = 100;      // of the interior point
};

struct BoundedQpRound {
  double violation_max = 0;  // of the constraints outside the pool, before new ones enter
  int pool = 0, active = 0;  // constraints considered, constraints held
  int linear_systems = 0;    // small dense ones
};

struct BoundedQpSeconds {
  double factorise = 0;  // sparse factorisations
  double columns = 0;    // sparse solves and products for new constraints
  double pool = 0;       // small dense problems
  double sweeps = 0;     // back-solves and searches for violations
  double interior_point = 0;
};

struct BoundedQpSolution {
  Eigen::VectorXd u, m;
  double objective = 0;      // 1/2 u^T Q u
  double violation_max = 0;  // over all constraints, after the last round
  double kkt_residual = 0;   // max |Q u - G^T y| / max |G^T y|, with y >= 0 and complementary by construction
  double relative_gap = 0;   // the smallest objective is at most this part below `objective`; 0: the optimum itself
  int rounds = 0;            // of the exchange
  int interior_point_iterations = 0;
  int active_constraints = 0;  // with a positive multiplier
  QpMethod method_used = QpMethod::exchange;
  BoundedQpSeconds seconds;
  std::vector<BoundedQpRound> history;
};

}  // namespace formwright
