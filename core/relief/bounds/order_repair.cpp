// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/bounds/order_repair.h"

#include <algorithm>

#include "base/index.h"

namespace formwright {
namespace {

constexpr int max_sweeps = 60;

double row_slack(const InequalityRow& row, const Eigen::VectorXd& u) {
  double value = -row.bound;
  for (std::size_t k = 0; k < row.index.size(); ++k) value += row.coefficient[k] * u[row.index[k]];
  return value;
}

}  // namespace

bool visible_behind(const InequalityRow& row, const std::vector<char>& visible) {
  for (std::size_t k = 0; k < row.index.size(); ++k)
    if (row.coefficient[k] > 0 && visible[index(row.index[k])]) return true;
  return false;
}

void repair_order(const std::vector<InequalityRow>& rows, const std::vector<char>& visible,
                  const Eigen::VectorXd& lower, const Eigen::VectorXd& upper, const Eigen::VectorXd& feasible,
                  double room, Eigen::VectorXd& u) {
  // The smallest move that closes a row (Kaczmarz 1937), over the vertices that may move.
  const auto close = [&](const InequalityRow& row, double missing, bool hidden_only) {
    const auto may_move = [&](std::size_t k) {
      return !hidden_only || (row.coefficient[k] > 0 && !visible[index(row.index[k])]);
    };
    double squares = 0;
    for (std::size_t k = 0; k < row.index.size(); ++k)
      if (may_move(k)) squares += row.coefficient[k] * row.coefficient[k];
    if (!(squares > 0)) return;
    for (std::size_t k = 0; k < row.index.size(); ++k)
      if (may_move(k)) {
        const int i = row.index[k];
        u[i] = std::clamp(u[i] + missing * row.coefficient[k] / squares, lower[i], upper[i]);
      }
  };
  for (int sweep = 0; sweep < max_sweeps; ++sweep) {
    bool moved = false;
    for (const InequalityRow& row : rows) {
      const double now = row_slack(row, u);
      if (now >= 0) continue;
      moved = true;
      close(row, room - now, sweep < max_sweeps / 2);
    }
    if (!moved) return;
  }
  // What is left gives way to `feasible` a quarter at a time, and only the vertices concerned.
  const Eigen::VectorXd before = u;
  Eigen::VectorXd share = Eigen::VectorXd::Zero(u.size());
  for (bool moved = true; moved;) {
    moved = false;
    for (const InequalityRow& row : rows) {
      if (row_slack(row, u) >= -room) continue;
      for (const int i : row.index) {
        if (share[i] >= 1) continue;
        moved = true;
        share[i] += 0.25;
        u[i] = share[i] >= 1 ? feasible[i] : before[i] + share[i] * (feasible[i] - before[i]);
      }
    }
  }
}

}  // namespace formwright
