// SPDX-License-Identifier: GPL-3.0-or-later
#include "numerics/qp/interior_point/active_set_polish.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/index.h"
#include "numerics/qp/interior_point/newton_system.h"

namespace formwright::bounded_qp_detail {

namespace {
constexpr int max_polish_rounds = 12;
constexpr int polish_rounds_without_gain = 4;
constexpr int max_corrections = 8;      // multiplier steps on one active set
constexpr double polish_target = 1e-3;  // of the tolerance
constexpr double zero_force = 1e-10;    // of the largest force: a multiplier no smaller than minus this counts as zero
constexpr double tying_force = 1e-9;    // of the largest force: a reaction that ties a part to its bound
constexpr double max_growth = 1e3;      // of the largest displacement
constexpr double balance_to_reach = 1e-13;  // of the largest force: what corrections strive for

struct ActiveSet {
  std::vector<char> lower, upper, order;
};

class Polish {
 public:
  Polish(const Energy& energy, NewtonMatrix& matrix, const Rows& rows, const InteriorPointResult& point);
  ExchangeResult run(double tolerance, Context& context);

 private:
  void guess();
  void solve(double target, Context& context);
  int exchange(double target);
  ExchangeResult result() const;
  ExchangeResult interior_result() const;

  const Energy& energy_;
  const Rows& rows_;
  const InteriorPointResult& point_;
  NewtonSystem system_;
  int n_, groups_;
  ActiveSet active_;
  std::vector<RowKey> held_;
  Eigen::VectorXd u_, m_, y_;  // y: of order rows
  double gauge_force_ = 0;
  Eigen::VectorXd left_;  // Q u - sum y a - gauge force: reactions of held unknowns, elsewhere what is unbalanced
  double force_size_ = 0;
};

Polish::Polish(const Energy& energy, NewtonMatrix& matrix, const Rows& rows, const InteriorPointResult& point)
    : energy_(energy),
      rows_(rows),
      point_(point),
      system_(energy, matrix, rows),
      n_(energy.size()),
      groups_(rows.groups()),
      u_(point.u),
      m_(point.m),
      y_(point.order_force),
      gauge_force_(point.gauge_force) {
  guess();
}

// Slack and multiplier of a row have typical sizes; their product goes to zero along the path, so that one of the two
// is far below its size.
void Polish::guess() {
  const BoundedQpConstraints& c = rows_.constraints();
  double typical_force = std::numeric_limits<double>::min(), typical_slack = typical_force;
  int slacks = 1;
  const auto survey = [&](double slack, double force) {
    typical_force = std::max(typical_force, 0.1 * force);
    typical_slack += slack, ++slacks;
  };
  for (int i = 0; i < n_; ++i) {
    if (std::isfinite(c.lower[i])) survey(point_.slack_lower[i], point_.force_lower[i]);
    if (std::isfinite(c.upper[i])) survey(point_.slack_upper[i], point_.force_upper[i]);
  }
  for (Eigen::Index r = 0; r < point_.order_slack.size(); ++r) survey(point_.order_slack[r], point_.order_force[r]);
  typical_slack /= slacks;
  const auto holds = [&](double slack, double force) { return force * typical_slack > slack * typical_force; };
  active_.lower.assign(index(n_), 0);
  active_.upper.assign(index(n_), 0);
  for (int i = 0; i < n_; ++i) {
    if (std::isfinite(c.lower[i])) active_.lower[index(i)] = holds(point_.slack_lower[i], point_.force_lower[i]);
    if (std::isfinite(c.upper[i]) && !active_.lower[index(i)])
      active_.upper[index(i)] = holds(point_.slack_upper[i], point_.force_upper[i]);
  }
  active_.order.assign(c.rows.size(), 0);
  for (std::size_t r = 0; r < c.rows.size(); ++r) {
    const auto k = static_cast<Eigen::Index>(r);
    active_.order[r] = holds(point_.order_slack[k], point_.order_force[k]);
  }
}

// The optimum with the active set held as equalities.
void Polish::solve(double target, Context& context) {
  const BoundedQpConstraints& c = rows_.constraints();
  held_.clear();
  for (int i = 0; i < n_; ++i) {
    if (c.lower[i] == c.upper[i] && c.lower_slope[i] == c.upper_slope[i]) held_.push_back({Side::both, i});
    else if (active_.lower[index(i)]) held_.push_back({Side::lower, i});
    else if (active_.upper[index(i)]) held_.push_back({Side::upper, i});
  }
  system_.hold(held_);
  NewtonSystem::Springs springs{Eigen::VectorXd::Zero(n_), Eigen::VectorXd::Zero(n_), order_softness(energy_, rows_)};
  for (Eigen::Index r = 0; r < y_.size(); ++r) {
    if (active_.order[static_cast<std::size_t>(r)]) springs.order[r] = 1 / springs.order[r];
    else springs.order[r] = y_[r] = 0;
  }
  system_.factorize(springs, context);
  const Eigen::VectorXd& gauge = system_.gauge();
  system_.place_held(u_, m_);
  double open_before = std::numeric_limits<double>::infinity(), unbalanced_before = open_before;
  for (int correction = 0;; ++correction) {
    left_ = energy_.apply(u_);
    if (gauge.size() > 0) left_ -= gauge_force_ * gauge;
    Eigen::VectorXd b = Eigen::VectorXd::Zero(groups_), spring_force = Eigen::VectorXd::Zero(n_);
    double open = 0;
    force_size_ = std::numeric_limits<double>::min();
    for (Eigen::Index r = 0; r < y_.size(); ++r) {
      if (!active_.order[static_cast<std::size_t>(r)]) continue;
      const RowKey key{Side::order, static_cast<int>(r)};
      const double missing = rows_.deficit(key, u_, m_);
      open = std::max(open, std::abs(missing));
      force_size_ = std::max(force_size_, std::abs(y_[r]));
      rows_.add_force(key, -y_[r], left_);
      rows_.add_force(key, springs.order[r] * missing, spring_force);
      b[rows_.group(key)] += rows_.slope(key) * (y_[r] + springs.order[r] * missing);
    }
    double unbalanced = 0;
    for (int i = 0; i < n_; ++i) {
      double& size = system_.held(i) ? force_size_ : unbalanced;
      size = std::max(size, std::abs(left_[i]));
    }
    if (gauge.size() > 0) open = std::max(open, std::abs(gauge.dot(u_)));
    const bool closed = open <= 0.1 * target, balanced = unbalanced <= balance_to_reach * force_size_;
    // What is left of either is round-off.
    const bool spent = (closed || open > 0.5 * open_before) && (balanced || unbalanced > 0.5 * unbalanced_before);
    if (correction == max_corrections || (correction > 0 && spent) || (closed && balanced)) return;
    open_before = open;
    unbalanced_before = unbalanced;
    const double c_left = gauge.size() > 0 ? -gauge.dot(u_) : 0;
    const NewtonSystem::Step step = system_.solve(spring_force - left_, b, c_left, 0);
    u_ += step.u;
    m_ += step.m;
    gauge_force_ += step.gauge_force;
    for (Eigen::Index r = 0; r < y_.size(); ++r) {
      if (!active_.order[static_cast<std::size_t>(r)]) continue;
      y_[r] += springs.order[r] * rows_.deficit({Side::order, static_cast<int>(r)}, u_, m_);
    }
    system_.place_held(u_, m_);
  }
}

// Lets violated constraints join and those that pull leave; returns how many.
int Polish::exchange(double target) {
  int wrong = 0;
  for (const RowKey key : held_) {
    if (rows_.equality(key)) continue;
    const double push = key.side == Side::upper ? -left_[key.index] : left_[key.index];
    if (push >= -zero_force * force_size_) continue;
    (key.side == Side::upper ? active_.upper : active_.lower)[index(key.index)] = 0;
    ++wrong;
  }
  for (Eigen::Index r = 0; r < y_.size(); ++r) {
    if (!active_.order[static_cast<std::size_t>(r)] || y_[r] >= -zero_force * force_size_) continue;
    active_.order[static_cast<std::size_t>(r)] = 0;
    ++wrong;
  }
  // Springs of rows that nearly repeat each other settle between them: the looser one does not hold.
  for (Eigen::Index r = 0; r < y_.size(); ++r) {
    if (!active_.order[static_cast<std::size_t>(r)]) continue;
    const double missing = rows_.deficit({Side::order, static_cast<int>(r)}, u_, m_);
    if (missing < -target) active_.order[static_cast<std::size_t>(r)] = 0;
    if (std::abs(missing) > target) ++wrong;
  }
  Rows::Violations violations;
  rows_.evaluate(u_, m_, violations);
  for (const RowKey key : rows_.worth_adding(violations, target)) {
    char* flag = nullptr;
    if (key.side == Side::order) flag = &active_.order[index(key.index)];
    else if (!system_.held(key.index))
      flag = &(key.side == Side::upper ? active_.upper : active_.lower)[index(key.index)];
    if (flag == nullptr || *flag) continue;
    *flag = 1;
    ++wrong;
  }
  return wrong;
}

ExchangeResult Polish::result() const {
  ExchangeResult result;
  result.u = u_;
  result.m = m_;
  result.force = Eigen::VectorXd::Zero(n_);
  if (system_.gauge().size() > 0) result.force += gauge_force_ * system_.gauge();
  std::vector<double> multiplier;
  const auto add = [&](RowKey key, double push) {
    if (!rows_.equality(key)) push = std::max(push, 0.0);
    if (push == 0 && !rows_.equality(key)) return;
    result.active.push_back(key);
    multiplier.push_back(push);
    rows_.add_force(key, push, result.force);
    if (rows_.equality(key) || push > tying_force * force_size_) result.pushing.push_back(key);
  };
  for (const RowKey key : held_) add(key, key.side == Side::upper ? -left_[key.index] : left_[key.index]);
  for (Eigen::Index r = 0; r < y_.size(); ++r) {
    if (active_.order[static_cast<std::size_t>(r)]) add({Side::order, static_cast<int>(r)}, y_[r]);
  }
  result.multiplier =
      Eigen::Map<const Eigen::VectorXd>(multiplier.data(), static_cast<Eigen::Index>(multiplier.size()));
  return result;
}

ExchangeResult Polish::run(double tolerance, Context& context) {
  int fewest = std::numeric_limits<int>::max(), patience = polish_rounds_without_gain;
  for (int round = 0; round < max_polish_rounds; ++round) {
    try {
      solve(polish_target * tolerance, context);
    } catch (const Error& error) {
      if (error.code() != ErrorCode::could_not_solve) throw;
      break;
    }
    if (!u_.allFinite() || !m_.allFinite()) break;
    // Constraints that hold leave a direction free in which nothing but round-off acts.
    if (u_.cwiseAbs().maxCoeff() > max_growth * std::max(point_.u.cwiseAbs().maxCoeff(), rows_.scale())) break;
    const int wrong = exchange(polish_target * tolerance);
    if (wrong == 0) {
      ExchangeResult found = result();
      found.rounds = round + 1;
      return found;
    }
    if (wrong < fewest) {
      fewest = wrong;
      patience = polish_rounds_without_gain;
    } else if (--patience < 0) {
      break;
    }
  }
  u_ = point_.u;
  m_ = point_.m;
  gauge_force_ = point_.gauge_force;
  ExchangeResult found = interior_result();
  found.stopped = true;
  return found;
}

// Multipliers of the interior point, those far below their size left out.
ExchangeResult Polish::interior_result() const {
  ExchangeResult result;
  result.u = point_.u;
  result.m = point_.m;
  result.force = Eigen::VectorXd::Zero(n_);
  if (system_.gauge().size() > 0) result.force += point_.gauge_force * system_.gauge();
  const double size = std::max({point_.force_lower.size() ? point_.force_lower.maxCoeff() : 0.0,
                                point_.force_upper.size() ? point_.force_upper.maxCoeff() : 0.0,
                                point_.order_force.size() ? point_.order_force.maxCoeff() : 0.0});
  std::vector<double> multiplier;
  const auto add = [&](RowKey key, double push) {
    rows_.add_force(key, push, result.force);
    if (push <= tying_force * size) return;
    result.active.push_back(key);
    multiplier.push_back(push);
    result.pushing.push_back(key);
  };
  for (int i = 0; i < n_; ++i) {
    if (point_.force_lower[i] > 0) add({Side::lower, i}, point_.force_lower[i]);
    if (point_.force_upper[i] > 0) add({Side::upper, i}, point_.force_upper[i]);
  }
  for (Eigen::Index r = 0; r < point_.order_force.size(); ++r)
    add({Side::order, static_cast<int>(r)}, point_.order_force[r]);
  // An unknown held by an equality is balanced by its reaction, whatever it is.
  const BoundedQpConstraints& c = rows_.constraints();
  const Eigen::VectorXd open = energy_.apply(point_.u) - result.force;
  for (int i = 0; i < n_; ++i)
    if (c.lower[i] == c.upper[i] && c.lower_slope[i] == c.upper_slope[i]) {
      rows_.add_force({Side::both, i}, open[i], result.force);
      result.active.push_back({Side::both, i});
      multiplier.push_back(open[i]);
      result.pushing.push_back({Side::both, i});
    }
  result.multiplier =
      Eigen::Map<const Eigen::VectorXd>(multiplier.data(), static_cast<Eigen::Index>(multiplier.size()));
  return result;
}

}  // namespace

ExchangeResult polish_active_set(const Energy& energy, NewtonMatrix& matrix, const Rows& rows,
                                 const InteriorPointResult& point, double violation_tolerance, Context& context) {
  return Polish(energy, matrix, rows, point).run(violation_tolerance, context);
}

}  // namespace formwright::bounded_qp_detail
