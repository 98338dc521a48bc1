// SPDX-License-Identifier: GPL-3.0-or-later
#include "numerics/qp/exchange/exchange_pool_qp.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/index.h"

namespace formwright::bounded_qp_detail {

// Three additions make every linear system positive definite; none changes the answer.
// - Augmentation: S' = S + B T B^T, T >= 0 on drivers with no energy of their own. As B^T y = 0 there, S' y = S y.
//   It gives the column of a pinned unknown, which is zero in S, its stiffness against the component's constant.
// - A proximal term 1/2 |w - w0|^2_E: drivers that the active rows leave free stay where they are. w0 moves to w
//   until E (w - w0) vanishes, which is force balance.
// - A proximal term on y of 1e-13 of the diagonal: linearly dependent rows (the same vertex named by a bound and
//   an order row) share their force evenly. y0 moves to y until the rows are held exactly (method of multipliers).
namespace {
constexpr double proximal_driver = 1e-7;
constexpr double proximal_row = 1e-13;
constexpr double augment_change = 30;
constexpr double cancellation_to_refine = 1e5;
constexpr int proximal_rounds = 60;
constexpr double contradiction = 1e-9;  // of the size of the rows' terms
constexpr int block_rounds_without_gain = 4;
constexpr double slack_work = 5;  // times the seconds of a multiplication in a product of matrices
}  // namespace

PoolQp::PoolQp()
    : factor_([this](int b, std::span<const int> rows, double* out) { gram(b, rows, out); }, row_diagonal_, p_.B, P_) {}

void PoolQp::set_problem(Eigen::Ref<const Eigen::MatrixXd> gram, PoolProblem problem, bool grown) {
  const int rows_before = p_.rows();
  grown = grown && problem.rows() >= rows_before && problem.drivers() == p_.drivers();
  p_ = std::move(problem);
  new (&gram_) Gram(gram.data(), gram.rows(), gram.cols(), Eigen::OuterStride<>(gram.outerStride()));
  const int k = p_.rows(), d = p_.drivers();
  double scale = 0;
  for (int a = 0; a < k; ++a) scale = std::max(scale, gram_(p_.column[index(a)], p_.column[index(a)]));
  if (!(scale > 0)) scale = 1;
  Eigen::VectorXd augment = Eigen::VectorXd::Zero(d);
  proximal_w_.resize(d);
  for (int j = 0; j < d; ++j) {
    const auto nonzero = static_cast<double>((p_.B.col(j).array() != 0).count());
    const double square = nonzero > 0 ? p_.B.col(j).squaredNorm() / nonzero : 1.0;
    const double stiffness = square / scale;  // of a row against this driver
    if (p_.P.row(j).isZero(0) && p_.r[j] == 0) augment[j] = scale / square;
    proximal_w_[j] = proximal_driver * std::max(stiffness, p_.P(j, j));
    // Its size hardly matters, but any change is a new matrix to factor.
    if (grown && !(augment[j] <= augment_change * augment_[j] && augment_[j] <= augment_change * augment[j]))
      grown = false;
  }
  if (!grown) augment_ = augment;
  P_ = p_.P;
  P_.diagonal() += proximal_w_;
  row_diagonal_.resize(k);
  for (int a = 0; a < k; ++a) {
    row_diagonal_[a] = gram_(p_.column[index(a)], p_.column[index(a)]);
    for (int j = 0; j < d; ++j) row_diagonal_[a] += augment_[j] * p_.B(a, j) * p_.B(a, j);
  }
  if (grown) factor_.add_rows(k - rows_before);
  else factor_.restart(k, proximal_row);
}

void PoolQp::gram(int b, std::span<const int> rows, double* out) const {
  const double* column = gram_.col(p_.column[index(b)]).data();
  for (std::size_t k = 0; k < rows.size(); ++k)
    out[k] = p_.sign[index(b)] * p_.sign[index(rows[k])] * column[p_.column[index(rows[k])]];
  for (Eigen::Index j = 0; j < p_.B.cols(); ++j) {
    const double weight = augment_[j] * p_.B(b, j);
    if (weight == 0) continue;
    for (std::size_t k = 0; k < rows.size(); ++k) out[k] += weight * p_.B(rows[k], j);
  }
}

// With A the active rows, (S' + Dy) y + B w = d + Dy y0 and B^T y - (P + E) w = r - E w0.
void PoolQp::solve_active(const std::vector<char>& active) {
  active_ = active;
  factor_.set_active(active);
  ++pivots_;
  const Eigen::VectorXd f = p_.d + factor_.proximal() * row_diagonal_.cwiseProduct(centre_y_),
                        balance = p_.r - proximal_w_.cwiseProduct(centre_w_);
  factor_.solve(f, balance, y_, w_);
  if (factor_.cancellation() < cancellation_to_refine) return;
  const Eigen::VectorXd push = augment_.cwiseProduct(p_.B.transpose() * y_);
  const Eigen::VectorXd left = factor_.proximal() * row_diagonal_.cwiseProduct(centre_y_ - y_) - slack() - p_.B * push;
  Eigen::VectorXd dy, dw;
  factor_.solve(left, balance - p_.B.transpose() * y_ + P_ * w_, dy, dw);
  y_ += dy;
  w_ += dw;
}

std::pair<Eigen::VectorXd, Eigen::VectorXd> PoolQp::correct(const Eigen::VectorXd& slack_error,
                                                            const Eigen::VectorXd& balance_error) const {
  std::pair<Eigen::VectorXd, Eigen::VectorXd> step;
  factor_.solve(slack_error, balance_error, step.first, step.second);
  return step;
}

// Round-off in slacks: at least that of adding S y, and what is left of the equations just solved.
double PoolQp::noise(const Eigen::VectorXd& s) const {
  double maximum = 0, sum = 0, left = 0;
  for (int a = 0; a < p_.rows(); ++a) {
    if (!active_[index(a)]) continue;
    const double root = std::sqrt(row_diagonal_[a]);
    maximum = std::max(maximum, root);
    sum += root * std::abs(y_[a]);
    left = std::max(left, std::abs(s[a] + factor_.proximal() * row_diagonal_[a] * (y_[a] - centre_y_[a])));
  }
  return std::max(std::numeric_limits<double>::epsilon() * maximum * sum, 4 * left);
}

Eigen::VectorXd PoolQp::slack() const {
  Eigen::VectorXd by_column = Eigen::VectorXd::Zero(gram_.rows());
  for (int a = 0; a < p_.rows(); ++a) by_column[p_.column[index(a)]] += p_.sign[index(a)] * y_[a];
  work_ += slack_work * static_cast<double>(gram_.size());
  const Eigen::VectorXd response = gram_ * by_column;
  Eigen::VectorXd s = p_.B * w_ - p_.d;
  for (int a = 0; a < p_.rows(); ++a) s[a] += p_.sign[index(a)] * response[p_.column[index(a)]];
  return s;
}

bool PoolQp::block_pivoting(double tolerance, Context& context) {
  int fewest = std::numeric_limits<int>::max(), patience = block_rounds_without_gain;
  std::vector<char> active = active_;
  for (;;) {
    context.check_cancelled();
    if (work() > max_work_) return true;
    solve_active(active);
    const Eigen::VectorXd s = slack();
    const double allowed = std::max(tolerance, noise(s));
    int wrong = 0;
    for (int a = 0; a < p_.rows(); ++a) {
      if (p_.equality[index(a)]) continue;
      // An active row whose pull is worth less than a hundredth of what is allowed stays: that is round-off.
      if (active[index(a)] ? y_[a] * row_diagonal_[a] < -0.01 * allowed : s[a] < -allowed) {
        active[index(a)] = !active[index(a)];
        ++wrong;
      }
    }
    if (wrong == 0) return true;
    if (wrong < fewest) {
      fewest = wrong;
      patience = block_rounds_without_gain;
    } else if (--patience < 0) {
      return false;
    }
  }
}

// How far from `now` >= 0 towards `goal` one may go before turning negative, 1 if `goal` can be reached.
static double reach(double now, double goal) { return goal > 0 ? 1.0 : now > 0 ? now / (now - goal) : 0.0; }

// Monotone: every pass raises the dual objective, so that no active set comes back. Once round-off in the objective
// is all that passes change, the rest is round-off in the slacks too. Begins with those rows that push now.
void PoolQp::lawson_hanson(double tolerance, Context& context) {
  const int k = p_.rows();
  std::vector<char> active = p_.equality, aside(index(k), 0);
  Eigen::VectorXd y = y_;
  for (int a = 0; a < k; ++a) {
    if (p_.equality[index(a)]) continue;
    y[a] = std::max(y[a], 0.0);
    active[index(a)] = y[a] > 0;
  }
  int entered = -1, idle = 0;
  double best = -std::numeric_limits<double>::infinity();
  for (;;) {
    for (;;) {
      context.check_cancelled();
      if (work() > max_work_) return;
      solve_active(active);
      double step = 1;
      for (int a = 0; a < k; ++a) {
        if (active[index(a)] && !p_.equality[index(a)]) step = std::min(step, reach(y[a], y_[a]));
      }
      if (step >= 1) break;
      for (int a = 0; a < k; ++a) {
        if (!active[index(a)]) continue;
        if (!p_.equality[index(a)] && reach(y[a], y_[a]) <= step) {
          active[index(a)] = 0;
          y[a] = 0;
        } else {
          y[a] += step * (y_[a] - y[a]);
        }
      }
    }
    y = y_;
    if (entered >= 0 && !active[index(entered)])
      aside[index(entered)] = 1;  // round-off pushed it in, round-off pushed it out
    const Eigen::VectorXd s = slack();
    const double value = y.dot(p_.d - 0.5 * (s + p_.d - p_.B * w_)) - 0.5 * w_.dot(p_.P * w_);
    idle = value > best + 1e-13 * std::abs(best) ? 0 : idle + 1;
    best = std::max(best, value);
    if (idle > k) return;
    const double allowed = std::max(tolerance, noise(s));
    entered = -1;
    for (int a = 0; a < k; ++a) {
      if (!active[index(a)] && !aside[index(a)] && s[a] < -allowed && (entered < 0 || s[a] < s[entered])) entered = a;
    }
    if (entered < 0) return;
    active[index(entered)] = 1;
  }
}

PoolSolution PoolQp::solve(const std::vector<char>& start, const Eigen::VectorXd& w, double tolerance, double max_work,
                           Context& context) {
  max_work_ = max_work;
  const int k = p_.rows();
  active_ = start;
  for (int a = 0; a < k; ++a) {
    if (p_.equality[index(a)]) active_[index(a)] = 1;
  }
  y_.setZero(k);
  centre_y_.setZero(k);
  centre_w_ = w;
  w_ = w;
  PoolSolution result;
  double residual_before = std::numeric_limits<double>::infinity();
  int stalled = 0;
  for (int round = 0; round < proximal_rounds; ++round) {
    if (!block_pivoting(tolerance, context)) lawson_hanson(tolerance, context);
    result.stopped = work() > max_work_;
    if (result.stopped) break;
    result.residual = 0;
    for (int a = 0; a < k; ++a) {
      if (!active_[index(a)]) continue;
      result.residual =
          std::max(result.residual, factor_.proximal() * row_diagonal_[a] * std::abs(y_[a] - centre_y_[a]));
    }
    double imbalance = 0;
    for (int j = 0; j < p_.drivers(); ++j) {
      const double force = p_.B.col(j).cwiseAbs().dot(y_.cwiseAbs());
      const double left = proximal_w_[j] * std::abs(w_[j] - centre_w_[j]);
      if (left > 1e-14 * force)
        imbalance = std::max(imbalance, left / std::max(force, std::numeric_limits<double>::min()));
    }
    centre_y_ = y_;
    centre_w_ = w_;
    if (result.residual <= 0.1 * tolerance && imbalance <= 1e-14) break;
    stalled = result.residual > 0.5 * residual_before ? stalled + 1 : 0;
    residual_before = result.residual;
    if (stalled >= 8 && result.residual > tolerance) {
      // What rows of this size cannot agree on by less is round-off, for the caller to judge.
      double size = 0;
      for (int a = 0; a < k; ++a) size = std::max(size, std::abs(p_.d[a]) + p_.B.row(a).cwiseAbs().dot(w_.cwiseAbs()));
      result.contradictory = result.residual > contradiction * size;
      break;
    }
  }
  result.y = y_;
  for (int a = 0; a < k; ++a) {
    if (!p_.equality[index(a)]) result.y[a] = std::max(result.y[a], 0.0);
  }
  result.w = w_;
  result.push = row_diagonal_.cwiseProduct(y_);
  result.active = active_;
  result.pivots = pivots_;
  return result;
}

}  // namespace formwright::bounded_qp_detail
