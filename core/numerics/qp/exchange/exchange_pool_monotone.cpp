// SPDX-License-Identifier: GPL-3.0-or-later
// The way of PoolQp that cannot fail: each pass raises the objective of the dual.
#include <algorithm>
#include <cmath>

#include "base/index.h"
#include "numerics/qp/exchange/exchange_pool_qp.h"

namespace formwright::bounded_qp_detail {

namespace {
constexpr std::size_t max_entering = 256;  // rows in one pass
constexpr double round_off = 1e-13;        // of the objective: passes that raise it by less change nothing

// How far from `now` >= 0 towards `goal` one may go before turning negative, 1 if `goal` can be reached.
double reach(double now, double goal) { return goal > 0 ? 1.0 : now > 0 ? now / (now - goal) : 0.0; }
}  // namespace

// Monotone: every pass raises the dual objective, so that no active set comes back. Rows enter by tens or hundreds at a
// time, the most violated first, and rows that pull leave together; where that does not raise the objective, they leave
// one by one [LH74], which cannot fail. Begins where the solve before ended: its multipliers satisfy every condition of
// the dual.
void PoolQp::monotone(double tolerance, Context& context) {
  const int k = p_.rows();
  std::vector<char> aside(index(k), 0);
  Feasible at{Eigen::VectorXd::Zero(k), p_.equality};
  at.y.head(solved_y_.size()) = solved_y_;
  for (int a = 0; a < k; ++a) {
    if (!p_.equality[index(a)]) at.active[index(a)] = at.y[a] > 0;
  }
  descend(at, context);
  Eigen::VectorXd s = slack();
  double best = objective(s);
  for (int idle = 0; idle <= k && work() <= max_work_;) {
    const double allowed = std::max(tolerance, noise(s));
    std::vector<int> entering;
    for (int a = 0; a < k; ++a) {
      if (!at.active[index(a)] && !aside[index(a)] && s[a] < -allowed) entering.push_back(a);
    }
    if (entering.empty()) return;
    std::sort(entering.begin(), entering.end(), [&](int a, int b) { return s[a] != s[b] ? s[a] < s[b] : a < b; });
    if (entering.size() > batch_) entering.resize(batch_);
    for (const int a : entering) at.active[index(a)] = 1;
    Feasible next = at;
    without_pulling(next, context);
    if (work() > max_work_) return;
    s = slack();
    double value = objective(s);
    const bool at_once = value > best;
    if (at_once) {
      at = std::move(next);
    } else {
      descend(at, context);
      if (work() > max_work_) return;
      s = slack();
      value = objective(s);
    }
    // Round-off pushed it in, round-off pushed it out.
    if (entering.size() == 1 && !at.active[index(entering.front())]) aside[index(entering.front())] = 1;
    // Once round-off in the objective is all that passes change, the rest is round-off in the slacks, too.
    const bool raised = value > best + round_off * std::abs(best);
    idle = raised ? 0 : idle + 1;
    best = std::max(best, value);
    batch_ = at_once ? std::min(max_entering, 2 * batch_) : raised ? std::max<std::size_t>(1, batch_ / 4) : 1;
  }
}

// The optimum of the active rows without those that pull: all of them leave at once, until none does.
void PoolQp::without_pulling(Feasible& at, Context& context) {
  for (bool pulls = true; pulls;) {
    context.check_cancelled();
    if (work() > max_work_) return;
    solve_active(at.active);
    pulls = false;
    for (int a = 0; a < p_.rows(); ++a) {
      if (!at.active[index(a)] || p_.equality[index(a)] || y_[a] > 0) continue;
      at.active[index(a)] = 0;
      pulls = true;
    }
  }
  at.y = y_;
}

// Straight towards the optimum of the active rows, as far as none pulls; those that would then leave.
void PoolQp::descend(Feasible& at, Context& context) {
  const int k = p_.rows();
  for (;;) {
    context.check_cancelled();
    if (work() > max_work_) return;
    solve_active(at.active);
    double step = 1;
    for (int a = 0; a < k; ++a) {
      if (at.active[index(a)] && !p_.equality[index(a)]) step = std::min(step, reach(at.y[a], y_[a]));
    }
    if (step >= 1) break;
    for (int a = 0; a < k; ++a) {
      if (!at.active[index(a)]) continue;
      if (!p_.equality[index(a)] && reach(at.y[a], y_[a]) <= step) {
        at.active[index(a)] = 0;
        at.y[a] = 0;
      } else {
        at.y[a] += step * (y_[a] - at.y[a]);
      }
    }
  }
  at.y = y_;
}

// Of the dual, for the slacks `s` of the last solution.
double PoolQp::objective(const Eigen::VectorXd& s) const {
  return y_.dot(p_.d - 0.5 * (s + p_.d - p_.B * w_)) - 0.5 * w_.dot(p_.P * w_);
}

}  // namespace formwright::bounded_qp_detail
