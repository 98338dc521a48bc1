// SPDX-License-Identifier: GPL-3.0-or-later
#include "numerics/qp/exchange/exchange_pool_qp.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/index.h"
#include "base/parallel.h"

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
constexpr std::size_t slacks_per_chunk = 512;
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
  if (grown) {
    factor_.add_rows(k - rows_before);
  } else {
    factor_.restart(k, proximal_row);
    solved_y_.resize(0);
    block_pivoting_helps_ = true;
  }
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
  std::vector<Eigen::Index> acting;
  for (Eigen::Index c = 0; c < by_column.size(); ++c) {
    if (by_column[c] != 0) acting.push_back(c);
  }
  work_ += slack_work * static_cast<double>(gram_.rows()) * static_cast<double>(acting.size());
  Eigen::VectorXd response = Eigen::VectorXd::Zero(gram_.rows());
  parallel_for(static_cast<std::size_t>(gram_.rows()), slacks_per_chunk, [&](std::size_t begin, std::size_t end) {
    const auto first = static_cast<Eigen::Index>(begin), count = static_cast<Eigen::Index>(end - begin);
    auto part = response.segment(first, count);
    const auto column = [&](std::size_t k) {
      return gram_.col(acting[k]).segment(first, count) * by_column[acting[k]];
    };
    std::size_t k = 0;
    for (; k + 4 <= acting.size(); k += 4) part += (column(k) + column(k + 1)) + (column(k + 2) + column(k + 3));
    for (; k < acting.size(); ++k) part += column(k);
  });
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
    // Where blocks of rows went in and out without an end, those of more rows would, too.
    if (round > 0 || block_pivoting_helps_) {
      const bool settled = block_pivoting(tolerance, context);
      if (!settled) monotone(tolerance, context);
      block_pivoting_helps_ = block_pivoting_helps_ && settled;
    } else {
      monotone(tolerance, context);
    }
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
  if (!result.stopped) solved_y_ = result.y;
  result.w = w_;
  result.push = row_diagonal_.cwiseProduct(y_);
  result.active = active_;
  result.pivots = pivots_;
  return result;
}

}  // namespace formwright::bounded_qp_detail
