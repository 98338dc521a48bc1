// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The linear systems of Newton steps on a bounded QP, with the scales m and the gauge as a border.
#include <Eigen/Core>
#include <Eigen/LU>
#include <span>
#include <vector>

#include "base/context.h"
#include "numerics/qp/problem/bounded_qp_energy.h"
#include "numerics/qp/problem/bounded_qp_rows.h"
#include "numerics/qp/interior_point/newton_matrix.h"

namespace formwright::bounded_qp_detail {

/// With constraints as springs of stiffness w_k >= 0 on g_k^T u + slope_k m, solves
///
///   Q du + sum_k w_k g_k (g_k^T du + slope_k dm) - gauge * dforce = a
///          sum_k w_k slope_k (g_k^T du + slope_k dm)              = b
///   gauge^T du                                                    = c
///
/// Held unknowns follow m along one of their bounds; what acts on them acts on m.
class NewtonSystem {
 public:
  NewtonSystem(const Energy& energy, NewtonMatrix& matrix, const Rows& rows);

  /// Bounds that hold from now on, at most one for an unknown.
  void hold(std::span<const RowKey> bounds);
  bool held(int i) const { return held_[static_cast<std::size_t>(i)] != 0; }
  /// Moves the held unknowns onto their bounds.
  void place_held(Eigen::VectorXd& u, const Eigen::VectorXd& m) const;

  /// The gauge divided by the sum of its absolute values, or empty.
  const Eigen::VectorXd& gauge() const { return gauge_; }

  struct Springs {
    Eigen::VectorXd lower, upper;  // n, on bounds; 0 where there is none and for held unknowns
    Eigen::VectorXd order;         // one for each order row
  };
  /// Throws Error: could_not_solve, cancelled, out_of_memory.
  void factorize(const Springs& springs, Context& context);

  struct Step {
    Eigen::VectorXd u, m;
    double gauge_force = 0;
  };
  /// `refinements`: steps of iterative refinement. A fourth-order energy on a poor mesh costs eight digits.
  Step solve(const Eigen::VectorXd& a, const Eigen::VectorXd& b, double c, int refinements);

 private:
  Eigen::VectorXd pins_of_loose_components(const Springs& springs) const;
  Step solve_once(const Eigen::VectorXd& a, const Eigen::VectorXd& b, double c);
  void solve_with_border(Eigen::VectorXd& x);
  void subtract_product(const Step& step, Eigen::VectorXd& a, Eigen::VectorXd& b, double& c) const;

  const Energy& energy_;
  NewtonMatrix& matrix_;
  const Rows& rows_;
  int n_, groups_;
  Eigen::VectorXd gauge_;
  std::vector<char> held_;
  std::vector<RowKey> held_bounds_;
  Eigen::MatrixXd held_slope_;  // n x groups: du/dm of held unknowns
  Springs springs_;
  Eigen::MatrixXd border_;         // n x (groups + gauge): C
  Eigen::MatrixXd border_solved_;  // H^-1 C, or empty until the first solve
  Eigen::MatrixXd border_energy_;  // (groups + gauge)^2: the system's own entries for m and the gauge
  Eigen::PartialPivLU<Eigen::MatrixXd> schur_;
};

/// Compliance of the springs that hold order rows: a thousandth of that of the row's own unknowns, sum_k a_k^2 / Q_kk.
/// A stiffer spring would cost more than three digits of the rest of the matrix (Altman and Gondzio 1999).
Eigen::VectorXd order_softness(const Energy& energy, const Rows& rows);

}  // namespace formwright::bounded_qp_detail
