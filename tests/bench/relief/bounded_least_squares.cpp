// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/relief/bounded_least_squares.h"

#include <algorithm>
#include <cmath>

namespace formwright::test {
namespace {

constexpr double tolerance = 1e-8;  // of the energy: what all conditions may cost; of the slab: what they may lack
constexpr double first_cost = 0.1;  // of the energy at the start: what all conditions cost there
constexpr double min_start_slack = 1e-2;  // of the slab
constexpr double step_share = 0.995;      // of the path to where the first slack or force would be 0
constexpr double smallest_shift = 1e-13;  // of the diagonal: the free scale stays determined
constexpr int max_steps = 100;

/// All conditions as G u >= h: lower bounds, upper bounds, order.
class Conditions {
 public:
  explicit Conditions(const AllowedDepths& allowed)
      : n_(allowed.lower.size()), order_(allowed.order), across_(allowed.order.transpose()) {
    h_.resize(2 * n_ + order_.rows());
    h_ << allowed.lower, -allowed.upper, allowed.order_bound;
  }
  Eigen::Index count() const { return h_.size(); }
  const Eigen::VectorXd& h() const { return h_; }
  Eigen::VectorXd times(const Eigen::VectorXd& u) const {
    Eigen::VectorXd result(count());
    result << u, -u, order_ * u;
    return result;
  }
  Eigen::VectorXd transposed_times(const Eigen::VectorXd& y) const {
    return y.head(n_) - y.segment(n_, n_) + across_ * y.tail(order_.rows());
  }
  /// Lower triangle of H + G^T D G.
  SparseMatrix added_to(const SparseMatrix& H, const Eigen::VectorXd& D) const {
    const SparseMatrix of_order = across_ * SparseMatrix(D.tail(order_.rows()).asDiagonal() * order_);
    SparseMatrix sum = SparseMatrix(H + of_order).triangularView<Eigen::Lower>();
    const double shift = smallest_shift * H.diagonal().mean();
    for (int i = 0; i < n_; ++i) {
      double& diagonal = sum.valuePtr()[sum.outerIndexPtr()[i]];
      diagonal = (1 + smallest_shift) * diagonal + D[i] + D[n_ + i] + shift;
    }
    return sum;
  }

 private:
  Eigen::Index n_;
  SparseMatrix order_, across_;
  Eigen::VectorXd h_;
};

/// The longest step, at most 1, that keeps `value` positive.
double longest_step(const Eigen::VectorXd& value, const Eigen::VectorXd& change) {
  double step = 1;
  for (Eigen::Index i = 0; i < value.size(); ++i)
    if (change[i] < 0) step = std::min(step, -value[i] / change[i]);
  return step;
}

}  // namespace

BoundedMinimum BoundedLeastSquares::minimise(const LeastSquares& energy, const AllowedDepths& allowed,
                                             Context& context) {
  BoundedMinimum result{0.5 * (allowed.lower + allowed.upper), 0, false};
  Eigen::VectorXd& u = result.u;
  const Conditions conditions(allowed);
  const auto count = static_cast<double>(conditions.count());
  const double slab = (allowed.upper - allowed.lower).mean();
  const SparseMatrix H = 2 * (SparseMatrix(energy.rows.transpose()) * energy.rows);

  Eigen::VectorXd slack = (conditions.times(u) - conditions.h()).cwiseMax(min_start_slack * slab);
  Eigen::VectorXd force = first_cost * energy(u) / count * slack.cwiseInverse();
  for (; result.steps < max_steps; ++result.steps) {
    const Eigen::VectorXd missing = conditions.times(u) - conditions.h() - slack,
                          imbalance = energy.gradient(u) - conditions.transposed_times(force);
    const double cost = slack.dot(force);
    const double balance = imbalance.cwiseAbs().maxCoeff() * slab;
    if (cost <= tolerance * energy(u) && balance <= tolerance * energy(u) &&
        missing.cwiseAbs().maxCoeff() <= tolerance * slab) {
      result.converged = true;
      break;
    }
    const Eigen::VectorXd stiffness = force.cwiseQuotient(slack);
    const SparseMatrix system = conditions.added_to(H, stiffness);
    if (system.nonZeros() != entries_) {
      factor_.analyze(system, positions_, context);
      entries_ = system.nonZeros();
    }
    factor_.factorize(system, context);
    Eigen::VectorXd step, slack_step, force_step;
    const auto solve_for = [&](const Eigen::VectorXd& complement) {
      const Eigen::VectorXd of_force = complement.cwiseQuotient(slack) + stiffness.cwiseProduct(missing);
      step = -imbalance - conditions.transposed_times(of_force);
      factor_.solve(step);
      slack_step = conditions.times(step) + missing;
      force_step = -complement.cwiseQuotient(slack) - stiffness.cwiseProduct(slack_step);
      return std::min(longest_step(slack, slack_step), longest_step(force, force_step));
    };
    const Eigen::VectorXd products = slack.cwiseProduct(force);
    const double reach = solve_for(products);
    const double predicted = (slack + reach * slack_step).dot(force + reach * force_step);
    const double centring = std::pow(predicted / cost, 3);
    const Eigen::VectorXd corrected =
        (products + slack_step.cwiseProduct(force_step)).array() - centring * cost / count;
    const double length = step_share * solve_for(corrected);
    u += length * step;
    slack += length * slack_step;
    force += length * force_step;
  }
  u = u.cwiseMax(allowed.lower).cwiseMin(allowed.upper);
  return result;
}

}  // namespace formwright::test
