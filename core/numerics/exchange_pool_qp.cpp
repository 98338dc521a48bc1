// SPDX-License-Identifier: GPL-3.0-or-later
#include "numerics/exchange_pool_qp.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"

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
constexpr double proximal_row = 1e-13, proximal_row_most = 1e-5;
constexpr int proximal_rounds = 60;
constexpr int block_rounds_without_gain = 4;
std::size_t at(int i) { return static_cast<std::size_t>(i); }
}  // namespace

PoolQp::PoolQp(Eigen::Ref<const Eigen::MatrixXd> gram, const PoolProblem& problem) : gram_(gram), p_(problem) {
  const int k = p_.rows(), d = p_.drivers();
  double scale = 0;
  for (int a = 0; a < k; ++a) scale = std::max(scale, gram_(p_.column[at(a)], p_.column[at(a)]));
  if (!(scale > 0)) scale = 1;
  augment_.setZero(d);
  V_.resize(0, d);
  proximal_w_.resize(d);
  for (int j = 0; j < d; ++j) {
    const auto nonzero = static_cast<double>((p_.B.col(j).array() != 0).count());
    const double square = nonzero > 0 ? p_.B.col(j).squaredNorm() / nonzero : 1.0;
    const double stiffness = square / scale;  // of a row against this driver
    if (p_.P.row(j).isZero(0) && p_.r[j] == 0) augment_[j] = scale / square;
    proximal_w_[j] = proximal_driver * std::max(stiffness, p_.P(j, j));
  }
  row_diagonal_.resize(k);
  for (int a = 0; a < k; ++a) {
    row_diagonal_[a] = gram_(p_.column[at(a)], p_.column[at(a)]);
    for (int j = 0; j < d; ++j) row_diagonal_[a] += augment_[j] * p_.B(a, j) * p_.B(a, j);
  }
}

double PoolQp::gram(int a, int b) const {
  double sum = p_.sign[at(a)] * p_.sign[at(b)] * gram_(p_.column[at(a)], p_.column[at(b)]);
  for (Eigen::Index j = 0; j < p_.B.cols(); ++j) sum += augment_[j] * p_.B(a, j) * p_.B(b, j);
  return sum;
}

void PoolQp::factor(const std::vector<char>& active) {
  std::vector<char> held(at(p_.rows()), 0);
  std::size_t keep = 0;
  while (keep < order_.size() && active[at(order_[keep])]) held[at(order_[keep++])] = 1;
  std::vector<int> order(order_.begin(), order_.begin() + static_cast<std::ptrdiff_t>(keep));
  for (std::size_t k = keep; k < order_.size(); ++k) {
    if (!active[at(order_[k])]) continue;
    held[at(order_[k])] = 1;
    order.push_back(order_[k]);
  }
  for (int a = 0; a < p_.rows(); ++a) {
    if (active[at(a)] && !held[at(a)]) order.push_back(a);
  }
  order_ = std::move(order);
  active_ = active;
  refactor(static_cast<int>(keep));
}

void PoolQp::refactor(int from) {
  const auto k = static_cast<Eigen::Index>(order_.size()), fresh = k - from;
  if (L_.rows() < k) {
    const Eigen::Index capacity = std::max<Eigen::Index>(k, L_.rows() + L_.rows() / 2);
    L_.conservativeResize(capacity, capacity);
    V_.conservativeResize(capacity, p_.drivers());
  }
  if (fresh > 0) {
    for (Eigen::Index b = 0; b < k; ++b) {
      for (Eigen::Index a = std::max<Eigen::Index>(b, from); a < k; ++a) {
        L_(a, b) = gram(order_[static_cast<std::size_t>(a)], order_[static_cast<std::size_t>(b)]);
      }
    }
    for (Eigen::Index a = from; a < k; ++a) L_(a, a) += proximal_y_ * row_diagonal_[order_[static_cast<std::size_t>(a)]];
    auto corner = L_.block(from, from, fresh, fresh);
    if (from > 0) {
      auto below = L_.block(from, 0, fresh, from);
      L_.topLeftCorner(from, from).triangularView<Eigen::Lower>().transpose().solveInPlace<Eigen::OnTheRight>(below);
      corner.selfadjointView<Eigen::Lower>().rankUpdate(below, -1);
    }
    const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> llt(corner);
    if (llt.info() != Eigen::Success) {
      if (proximal_y_ >= proximal_row_most) {
        throw Error(ErrorCode::could_not_solve, "constraints", "The constraints in contact cannot be told apart numerically: remove duplicates.");
      }
      proximal_y_ *= 100;
      return refactor(0);
    }
  }
  for (Eigen::Index a = from; a < k; ++a) V_.row(a) = p_.B.row(order_[static_cast<std::size_t>(a)]);
  if (fresh > 0 && p_.drivers() > 0) {
    auto below = V_.block(from, 0, fresh, p_.drivers());
    if (from > 0) below.noalias() -= L_.block(from, 0, fresh, from) * V_.topRows(from);
    L_.block(from, from, fresh, fresh).triangularView<Eigen::Lower>().solveInPlace(below);
  }
  ++pivots_;
}

// f (in the factor's order) and w: (S' + Dy) y + B w = f, B^T y - (P + E) w = balance; y overwrites f.
void PoolQp::solve_factored(Eigen::VectorXd& f, const Eigen::VectorXd& balance, Eigen::VectorXd& w) const {
  const Eigen::Index k = f.size(), d = p_.drivers();
  const auto L = L_.topLeftCorner(k, k).triangularView<Eigen::Lower>();
  if (k > 0) L.solveInPlace(f);
  w.resize(d);
  if (d > 0) {
    const auto V = V_.topRows(k);
    Eigen::MatrixXd T = p_.P;
    T.diagonal() += proximal_w_;
    T.noalias() += V.transpose() * V;
    w = T.llt().solve(V.transpose() * f - balance);
    f.noalias() -= V * w;
  }
  if (k > 0) L.transpose().solveInPlace(f);
}

// With A the active rows, (S' + Dy) y + B w = d + Dy y0 and B^T y - (P + E) w = r - E w0.
void PoolQp::solve_active() {
  const auto k = static_cast<Eigen::Index>(order_.size());
  Eigen::VectorXd f(k);
  for (Eigen::Index a = 0; a < k; ++a) {
    const int row = order_[static_cast<std::size_t>(a)];
    f[a] = p_.d[row] + proximal_y_ * row_diagonal_[row] * centre_y_[row];
  }
  solve_factored(f, p_.r - proximal_w_.cwiseProduct(centre_w_), w_);
  y_.setZero(p_.rows());
  for (Eigen::Index a = 0; a < k; ++a) y_[order_[static_cast<std::size_t>(a)]] = f[a];
}

std::pair<Eigen::VectorXd, Eigen::VectorXd> PoolQp::correct(const Eigen::VectorXd& slack_error, const Eigen::VectorXd& balance_error) const {
  Eigen::VectorXd f(static_cast<Eigen::Index>(order_.size())), dw, dy = Eigen::VectorXd::Zero(p_.rows());
  for (Eigen::Index a = 0; a < f.size(); ++a) f[a] = slack_error[order_[static_cast<std::size_t>(a)]];
  solve_factored(f, balance_error, dw);
  for (Eigen::Index a = 0; a < f.size(); ++a) dy[order_[static_cast<std::size_t>(a)]] = f[a];
  return {dy, dw};
}

// Round-off in slacks: at least that of adding S y, and what is left of the equations just solved.
double PoolQp::noise(const Eigen::VectorXd& s) const {
  double most = 0, sum = 0, left = 0;
  for (const int a : order_) {
    const double root = std::sqrt(row_diagonal_[a]);
    most = std::max(most, root);
    sum += root * std::abs(y_[a]);
    left = std::max(left, std::abs(s[a] + proximal_y_ * row_diagonal_[a] * (y_[a] - centre_y_[a])));
  }
  return std::max(std::numeric_limits<double>::epsilon() * most * sum, 4 * left);
}

Eigen::VectorXd PoolQp::slack() const {
  Eigen::VectorXd by_column = Eigen::VectorXd::Zero(gram_.rows());
  for (const int a : order_) by_column[p_.column[at(a)]] += p_.sign[at(a)] * y_[a];
  const Eigen::VectorXd response = gram_ * by_column;
  Eigen::VectorXd s = p_.B * w_ - p_.d;
  for (int a = 0; a < p_.rows(); ++a) s[a] += p_.sign[at(a)] * response[p_.column[at(a)]];
  return s;
}

bool PoolQp::block_pivoting(double tolerance, Context& context) {
  int fewest = std::numeric_limits<int>::max(), patience = block_rounds_without_gain;
  std::vector<char> active = active_;
  for (;;) {
    context.check_cancelled();
    factor(active);
    solve_active();
    const Eigen::VectorXd s = slack();
    const double allowed = std::max(tolerance, noise(s));
    int wrong = 0;
    for (int a = 0; a < p_.rows(); ++a) {
      if (p_.equality[at(a)]) continue;
      if (active[at(a)] ? y_[a] < 0 : s[a] < -allowed) {
        active[at(a)] = !active[at(a)];
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

// How far from `now` >= 0 towards `goal` one may go before turning negative, 1 if all the way.
static double reach(double now, double goal) { return goal > 0 ? 1.0 : now > 0 ? now / (now - goal) : 0.0; }

// Monotone: every pass raises the dual objective, so that no active set comes back. Once round-off in the objective
// is all that passes change, the rest is round-off in the slacks too.
void PoolQp::lawson_hanson(double tolerance, Context& context) {
  const int k = p_.rows();
  std::vector<char> active = p_.equality, aside(at(k), 0);
  Eigen::VectorXd y = Eigen::VectorXd::Zero(k);
  int entered = -1, idle = 0;
  double best = -std::numeric_limits<double>::infinity();
  for (;;) {
    for (;;) {
      context.check_cancelled();
      factor(active);
      solve_active();
      double step = 1;
      for (int a = 0; a < k; ++a) {
        if (active[at(a)] && !p_.equality[at(a)]) step = std::min(step, reach(y[a], y_[a]));
      }
      if (step >= 1) break;
      for (int a = 0; a < k; ++a) {
        if (!active[at(a)]) continue;
        if (!p_.equality[at(a)] && reach(y[a], y_[a]) <= step) {
          active[at(a)] = 0;
          y[a] = 0;
        } else {
          y[a] += step * (y_[a] - y[a]);
        }
      }
    }
    y = y_;
    if (entered >= 0 && !active[at(entered)]) aside[at(entered)] = 1;  // round-off pushed it in, round-off pushed it out
    const Eigen::VectorXd s = slack();
    const double value = y.dot(p_.d - 0.5 * (s + p_.d - p_.B * w_)) - 0.5 * w_.dot(p_.P * w_);
    idle = value > best + 1e-13 * std::abs(best) ? 0 : idle + 1;
    best = std::max(best, value);
    if (idle > k) return;
    const double allowed = std::max(tolerance, noise(s));
    entered = -1;
    for (int a = 0; a < k; ++a) {
      if (!active[at(a)] && !aside[at(a)] && s[a] < -allowed && (entered < 0 || s[a] < s[entered])) entered = a;
    }
    if (entered < 0) return;
    active[at(entered)] = 1;
  }
}

PoolSolution PoolQp::solve(const std::vector<char>& start, const Eigen::VectorXd& w, double tolerance, Context& context) {
  const int k = p_.rows();
  active_ = start;
  for (int a = 0; a < k; ++a) {
    if (p_.equality[at(a)]) active_[at(a)] = 1;
  }
  order_.clear();
  proximal_y_ = proximal_row;
  centre_y_.setZero(k);
  centre_w_ = w;
  w_ = w;
  PoolSolution result;
  double residual_before = std::numeric_limits<double>::infinity();
  int stalled = 0;
  for (int round = 0; round < proximal_rounds; ++round) {
    if (!block_pivoting(tolerance, context)) lawson_hanson(tolerance, context);
    result.residual = 0;
    for (const int a : order_) {
      result.residual = std::max(result.residual, proximal_y_ * row_diagonal_[a] * std::abs(y_[a] - centre_y_[a]));
    }
    double imbalance = 0;
    for (int j = 0; j < p_.drivers(); ++j) {
      const double force = p_.B.col(j).cwiseAbs().dot(y_.cwiseAbs());
      const double left = proximal_w_[j] * std::abs(w_[j] - centre_w_[j]);
      if (left > 1e-14 * force) imbalance = std::max(imbalance, left / std::max(force, std::numeric_limits<double>::min()));
    }
    centre_y_ = y_;
    centre_w_ = w_;
    if (result.residual <= 0.1 * tolerance && imbalance <= 1e-14) break;
    stalled = result.residual > 0.5 * residual_before ? stalled + 1 : 0;
    residual_before = result.residual;
    if (stalled >= 8 && result.residual > tolerance) {
      result.contradictory = true;
      break;
    }
  }
  result.y = y_;
  result.w = w_;
  result.push = row_diagonal_.cwiseProduct(y_);
  result.active = active_;
  result.pivots = pivots_;
  return result;
}

}  // namespace formwright::bounded_qp_detail
