// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The constraints of a bounded QP seen as rows g^T u + slope m >= bound: checked, evaluated, searched.
#include <Eigen/Core>
#include <span>
#include <vector>

#include "numerics/qp/problem/bounded_qp_problem.h"
#include "numerics/qp/problem/bounded_qp_energy.h"

namespace formwright::bounded_qp_detail {

enum class Side : signed char { lower, upper, both, order };  // both: lower and upper are one equality

/// Names a constraint: a side of the bounds of an unknown, or an order row.
struct RowKey {
  Side side = Side::lower;
  int index = 0;
  friend bool operator==(const RowKey&, const RowKey&) = default;
};

class Rows {
 public:
  /// Throws Error{invalid_input}: sizes, NaN, groups or indices out of range, a lower bound above the upper one for
  /// every m; could_not_solve: no m fits all bounds of a group.
  Rows(const BoundedQpConstraints& constraints, const Energy& energy);

  const BoundedQpConstraints& constraints() const { return c_; }
  int size() const { return static_cast<int>(c_.lower.size()); }
  int groups() const { return c_.group_count; }
  int group(RowKey key) const;
  double bound(RowKey key) const;
  double slope(RowKey key) const;
  bool equality(RowKey key) const { return key.side == Side::both; }
  /// sum_k coefficient_k v_k with the row's sign.
  double apply(RowKey key, const Eigen::VectorXd& v) const;
  /// Adds y g to f.
  void add_force(RowKey key, double y, Eigen::VectorXd& f) const;
  /// bound - slope m - g^T u.
  double deficit(RowKey key, const Eigen::VectorXd& u, const Eigen::VectorXd& m) const;
  /// By how much the row is violated (negative: slack).
  double violation(RowKey key, const Eigen::VectorXd& u, const Eigen::VectorXd& m) const;

  /// Violations of everything at once.
  struct Violations {
    std::vector<double> bound;  // n; of the worse side
    std::vector<Side> side;     // n; which side that is
    std::vector<double> order;  // of every order row
    double max = 0, max_order = 0;
  };
  void evaluate(const Eigen::VectorXd& u, const Eigen::VectorXd& m, Violations& out) const;

  /// Rows to add: violated by more than `least` and more than any neighbour in the graph of Q (bounds), or than any
  /// other order row that shares an unknown; all bounds when they are few; the most violated first.
  std::vector<RowKey> worth_adding(const Violations& v, double minimum) const;

  /// Moves u into its bounds: every bound then holds exactly as computed.
  void clip(Eigen::VectorXd& u, const Eigen::VectorXd& m) const;

  /// A size of u that the bounds speak of (their spread), for tolerances relative to it.
  double scale() const { return scale_; }
  /// m that spreads the violation of u = 0 evenly over both sides, group by group.
  Eigen::VectorXd centred_m() const;

 private:
  void check() const;
  const BoundedQpConstraints& c_;
  const Energy& energy_;
  double scale_ = 1;
};

}  // namespace formwright::bounded_qp_detail
