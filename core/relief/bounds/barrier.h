// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Bounds in a primal-dual interior point method (Nocedal and Wright 2006, section 19.2): every one has a slack s > 0
// and a force y > 0 with s y = w at the end, w the barrier's weight, which falls from step to step.
#include <Eigen/Core>
#include <algorithm>

namespace formwright {

class Barrier {
 public:
  /// `lower`, `upper` (n): -inf / +inf where free; `u` (n): strictly between them. The bounds must outlive the barrier.
  Barrier(const Eigen::VectorXd& lower, const Eigen::VectorXd& upper, const Eigen::VectorXd& u);

  /// `cost`: what all bounds may cost together at the end of the iteration, in units of the objective.
  void set_weight(double cost) { weight_ = cost / std::max<double>(1, static_cast<double>(count_)); }
  void start_forces();

  Eigen::VectorXd stiffness() const;                            // n, to be added to the diagonal
  Eigen::VectorXd gradient() const { return gradient_at(u_); }  // n, of - w sum log s
  Eigen::VectorXd gradient_at(const Eigen::VectorXd& u) const;

  /// The way to go instead of `step` (n): vertices that would lose more than nine tenths of a slack go less far, the
  /// others are not held up.
  Eigen::VectorXd within(const Eigen::VectorXd& step) const;
  /// Goes to u + way, and lets the forces follow.
  void move(const Eigen::VectorXd& way);

 private:
  const Eigen::VectorXd &lower_, &upper_;
  Eigen::VectorXd u_, force_lower_, force_upper_;
  long count_ = 0;  // of bounds
  double weight_ = 1;
};

}  // namespace formwright
