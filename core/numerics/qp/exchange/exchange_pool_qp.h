// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The small dense QP of an exchange, in its dual:
//
//   minimise   1/2 v^T v + 1/2 w^T P w + r^T w        v = what the energy sees, w = the free drivers
//   subject to Y^T v + B w >= d                       (or = for equality rows)
//
// whose multipliers y >= 0 solve the complementarity problem
//   s = S y + B w - d >= 0,  y >= 0,  s^T y = 0,  B^T y = P w + r,     S = Y^T Y.
// Judice and Pires 1994 (block principal pivoting), Lawson and Hanson 1974, ch. 23 (the safe fallback).
#include <Eigen/Core>
#include <vector>

#include "base/context.h"
#include "numerics/qp/exchange/exchange_pool_factor.h"

namespace formwright::bounded_qp_detail {

struct PoolProblem {
  Eigen::MatrixXd B;           // rows x drivers
  Eigen::VectorXd d;           // rows
  std::vector<int> column;     // rows; which column of the Gram matrix
  std::vector<double> sign;    // rows; g_j = sign * the column's vector
  std::vector<char> equality;  // rows
  Eigen::MatrixXd P;           // drivers x drivers, positive semidefinite
  Eigen::VectorXd r;           // drivers
  int rows() const { return static_cast<int>(d.size()); }
  int drivers() const { return static_cast<int>(B.cols()); }
};

struct PoolSolution {
  Eigen::VectorXd y;           // rows; zero where inactive
  Eigen::VectorXd w;           // drivers; where the rows leave a choice, the nearest to the start
  std::vector<char> active;    // rows held with equality
  Eigen::VectorXd push;        // rows; by about how much y moves its own row, in units of d
  double residual = 0;         // how far active rows are from being held, in units of d
  bool contradictory = false;  // no w and v satisfy all rows (as far as double precision tells)
  bool stopped = false;        // the work ran out before the rows were settled
  int pivots = 0;              // linear systems solved
};

class PoolQp {
 public:
  PoolQp();
  PoolQp(const PoolQp&) = delete;
  PoolQp& operator=(const PoolQp&) = delete;

  /// The problem to solve next. `gram`: S of all columns; it must stay where it is until the next call. With
  /// `grown`, the problem is the one before with rows added behind: what was factored of it is used again.
  void set_problem(Eigen::Ref<const Eigen::MatrixXd> gram, PoolProblem problem, bool grown);

  /// `start`: active flags to begin with (rows), `w`: drivers to stay near, `tolerance`: on slack, in units of d. Stops
  /// with `stopped` once `work` has passed `max_work`.
  PoolSolution solve(const std::vector<char>& start, const Eigen::VectorXd& w, double tolerance, double max_work,
                     Context& context);

  /// Multiplications of all calls so far, about (PoolFactor::work).
  double work() const { return work_ + factor_.work(); }

  /// One step of iterative refinement on the last active set, with the same factor: solves
  ///   S_AA dy + B_A dw = slack_error_A,   B_A^T dy - P dw = balance_error.
  /// Returns dy (rows; zero where inactive) and dw.
  std::pair<Eigen::VectorXd, Eigen::VectorXd> correct(const Eigen::VectorXd& slack_error,
                                                      const Eigen::VectorXd& balance_error) const;

 private:
  void gram(int b, std::span<const int> rows, double* out) const;
  void solve_active(const std::vector<char>& active);
  double noise(const Eigen::VectorXd& s) const;
  Eigen::VectorXd slack() const;
  bool block_pivoting(double tolerance, Context& context);
  void monotone(double tolerance, Context& context);
  /// Multipliers that satisfy the dual's conditions, and the rows that may push.
  struct Feasible {
    Eigen::VectorXd y;
    std::vector<char> active;
  };
  void without_pulling(Feasible& at, Context& context);
  void descend(Feasible& at, Context& context);
  double objective(const Eigen::VectorXd& s) const;

  using Gram = Eigen::Map<const Eigen::MatrixXd, 0, Eigen::OuterStride<>>;
  Gram gram_{nullptr, 0, 0, Eigen::OuterStride<>(0)};
  PoolProblem p_;
  Eigen::VectorXd augment_;       // per driver: S' = S + B diag(augment) B^T
  Eigen::VectorXd proximal_w_;    // per driver
  Eigen::VectorXd row_diagonal_;  // diagonal of S'
  Eigen::MatrixXd P_;             // P + diag(proximal_w)
  Eigen::VectorXd centre_y_, centre_w_;
  std::vector<char> active_;
  PoolFactor factor_;
  Eigen::VectorXd y_, w_;
  Eigen::VectorXd solved_y_;  // of the solve before, none at first
  bool block_pivoting_helps_ = true;
  std::size_t batch_ = 16;  // rows that enter in the next monotone pass
  int pivots_ = 0;
  mutable double work_ = 0;
  double max_work_ = 0;
};

}  // namespace formwright::bounded_qp_detail
