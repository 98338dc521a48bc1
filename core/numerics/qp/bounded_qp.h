// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Convex quadratic programs with bounds: eqs. (3.11)-(3.14) of the thesis after a change of variables.
//
//   minimise   1/2 u^T Q u                                   u in R^n, m in R^groups
//   subject to lower_i + lower_slope_i m_g(i) <= u_i <= upper_i + upper_slope_i m_g(i)
//              sum_k coefficient_k u_index_k + slope m_g >= bound           for every order row
//              sum_i gauge_i u_i = 0                                       (fixes the free scale)
//
// Q is symmetric positive semidefinite; its null space is spanned by the constants on each component.
#include <Eigen/Core>
#include <vector>

#include "base/context.h"
#include "base/data/parameters.h"
#include "numerics/sparse/sparse_cholesky.h"

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
  int max_active_in_pool = 6000;  // more rows in contact: bounds that hold leave the factorisation (docs/numerics.md)
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
  int rounds = 0;            // of the exchange
  int interior_point_iterations = 0;
  int active_constraints = 0;  // with a positive multiplier
  QpMethod method_used = QpMethod::exchange;
  BoundedQpSeconds seconds;
  std::vector<BoundedQpRound> history;
};

/// Keeps the factorisation of Q: solves for other bounds do not factor again.
class BoundedQp {
 public:
  BoundedQp();
  ~BoundedQp();
  BoundedQp(BoundedQp&&) noexcept;
  BoundedQp& operator=(BoundedQp&&) noexcept;

  /// `lower_Q`: lower triangle of Q. `component`: n, the connected part of each unknown, 0-based.
  /// `positions`: n x 3 hint for the ordering. Factors once.
  void set_energy(const SparseMatrix& lower_Q, std::vector<int> component, const Positions& positions,
                  Context& context);

  /// Warm-started from the previous active set when there is one of the same size.
  /// Throws Error: could_not_solve (infeasible, not converged: says which), cancelled, out_of_memory.
  BoundedQpSolution solve(const BoundedQpConstraints& constraints, const BoundedQpOptions& options, Context& context);

  double memory_mb() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace formwright
