// SPDX-License-Identifier: GPL-3.0-or-later
#include "numerics/qp/interior_point/newton_system.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/index.h"

namespace formwright::bounded_qp_detail {

namespace {
constexpr double spring_softness = 1e-3;  // of the unknowns of an order row
constexpr double proximal_part = 1e-13;   // of the diagonal of Q, in the matrix only: scales that touch nothing
constexpr double pin_part = 1e-3;         // of the pin's diagonal
constexpr double no_change = 1e-12;       // of a row's coefficients: their sum, where a shift changes nothing
}  // namespace

NewtonSystem::NewtonSystem(const Energy& energy, NewtonMatrix& matrix, const Rows& rows)
    : energy_(energy), matrix_(matrix), rows_(rows), n_(energy.size()), groups_(rows.groups()) {
  const Eigen::VectorXd& gauge = rows.constraints().gauge;
  const double size = gauge.cwiseAbs().sum();
  if (size > 0) gauge_ = gauge / size;
  hold({});
}

void NewtonSystem::hold(std::span<const RowKey> bounds) {
  held_.assign(index(n_), 0);
  held_bounds_.assign(bounds.begin(), bounds.end());
  held_slope_.setZero(n_, groups_);
  for (const RowKey key : bounds) {
    held_[index(key.index)] = 1;
    held_slope_(key.index, rows_.group(key)) = key.side == Side::upper ? rows_.slope(key) : -rows_.slope(key);
  }
}

void NewtonSystem::place_held(Eigen::VectorXd& u, const Eigen::VectorXd& m) const {
  for (const RowKey key : held_bounds_) {
    const double value = rows_.bound(key) - rows_.slope(key) * m[rows_.group(key)];
    u[key.index] = key.side == Side::upper ? -value : value;
  }
}

// Where nothing pushes, the constant of a component is anyone's: round-off would move it far, and far from zero Q u
// loses its digits. A spring on one unknown, in the matrix only, lets it move no farther than the gauge asks. Order
// rows that see differences alone join components to sets with one constant.
Eigen::VectorXd NewtonSystem::pins_of_loose_components(const Springs& springs) const {
  const int components = energy_.component_count();
  std::vector<int> parent(index(components));
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int k) {
    while (parent[index(k)] != k) k = parent[index(k)] = parent[index(parent[index(k)])];
    return k;
  };
  std::vector<char> touched(index(components), 0);
  for (int i = 0; i < n_; ++i) {
    if (held(i) || springs.lower[i] > 0 || springs.upper[i] > 0) touched[index(energy_.component(i))] = 1;
  }
  const std::vector<InequalityRow>& order = rows_.constraints().rows;
  for (std::size_t r = 0; r < order.size(); ++r) {
    if (!(springs.order[static_cast<Eigen::Index>(r)] > 0) || order[r].index.empty()) continue;
    const int first = root(energy_.component(order[r].index.front()));
    double sum = 0, size = 0;
    bool touches = touched[index(first)] != 0;
    for (std::size_t k = 0; k < order[r].index.size(); ++k) {
      const int other = root(energy_.component(order[r].index[k]));
      touches = touches || touched[index(other)];
      parent[index(other)] = first;
      sum += order[r].coefficient[k];
      size += std::abs(order[r].coefficient[k]);
    }
    touched[index(first)] = touches || std::abs(sum) > no_change * size;
  }
  Eigen::VectorXd pins = Eigen::VectorXd::Zero(n_);
  for (int k = 0; k < components; ++k) {
    if (root(k) == k && !touched[index(k)]) pins[energy_.pin(k)] = pin_part * energy_.diagonal(energy_.pin(k));
  }
  return pins;
}

void NewtonSystem::factorize(const Springs& springs, Context& context) {
  springs_ = springs;
  const BoundedQpConstraints& c = rows_.constraints();
  const Eigen::Index borders = groups_ + (gauge_.size() > 0 ? 1 : 0);
  Eigen::VectorXd diagonal = springs.lower + springs.upper + pins_of_loose_components(springs);
  border_.setZero(n_, borders);
  Eigen::MatrixXd E = Eigen::MatrixXd::Zero(borders, borders);
  if (!held_bounds_.empty()) {
    for (int g = 0; g < groups_; ++g) border_.col(g) = energy_.apply(held_slope_.col(g));
    E.topLeftCorner(groups_, groups_) = held_slope_.transpose() * border_.leftCols(groups_);
  }
  for (int i = 0; i < n_; ++i) {
    diagonal[i] += proximal_part * energy_.diagonal(i);
    const int g = c.group[index(i)];
    const double lower = springs.lower[i], upper = springs.upper[i], ls = c.lower_slope[i], us = c.upper_slope[i];
    if (lower > 0) {  // u - slope m >= bound
      border_(i, g) -= lower * ls;
      E(g, g) += lower * ls * ls;
    }
    if (upper > 0) {
      border_(i, g) -= upper * us;
      E(g, g) += upper * us * us;
    }
  }
  Eigen::VectorXd slope(groups_);
  for (std::size_t r = 0; r < c.rows.size(); ++r) {
    const double w = springs.order[static_cast<Eigen::Index>(r)];
    if (!(w > 0)) continue;
    const InequalityRow& row = c.rows[r];
    slope.setZero();
    slope[row.group] = row.slope;
    for (std::size_t k = 0; k < row.index.size(); ++k) {
      if (held_[index(row.index[k])]) slope += row.coefficient[k] * held_slope_.row(row.index[k]).transpose();
    }
    if (slope.isZero(0)) continue;
    for (std::size_t k = 0; k < row.index.size(); ++k)
      border_.row(row.index[k]).head(groups_) += w * row.coefficient[k] * slope.transpose();
    E.topLeftCorner(groups_, groups_) += w * slope * slope.transpose();
  }
  if (gauge_.size() > 0) {
    border_.col(groups_) = -gauge_;
    E.row(groups_).head(groups_) = -(gauge_.transpose() * held_slope_);
    E.col(groups_).head(groups_) = E.row(groups_).head(groups_).transpose();
  }
  // Nor do a scale or a gauge that nothing touches make the border singular.
  for (int g = 0; g < groups_; ++g) E(g, g) += proximal_part * energy_.absolute_sum();
  if (gauge_.size() > 0)
    E(groups_, groups_) -= proximal_part / std::max(energy_.absolute_sum(), std::numeric_limits<double>::min());
  for (const RowKey key : held_bounds_) border_.row(key.index).setZero();
  matrix_.factorize(rows_, diagonal, springs.order, held_, context);
  border_energy_ = E;
  border_solved_.resize(0, 0);
}

// x = H^-1 x. A solve waits for the memory of the factor: the border's columns go with the first right-hand side.
void NewtonSystem::solve_with_border(Eigen::VectorXd& x) {
  const Eigen::Index borders = border_.cols();
  if (borders == 0 || border_solved_.cols() == borders) return matrix_.solve(x);
  Eigen::MatrixXd together(n_, borders + 1);
  together << border_, x;
  matrix_.solve(together);
  border_solved_ = together.leftCols(borders);
  x = together.col(borders);
  const Eigen::MatrixXd schur = border_energy_ - border_.transpose() * border_solved_;
  schur_.compute(0.5 * (schur + schur.transpose()));
}

NewtonSystem::Step NewtonSystem::solve_once(const Eigen::VectorXd& a, const Eigen::VectorXd& b, double c) {
  Step step;
  step.u = a;
  for (const RowKey key : held_bounds_) step.u[key.index] = 0;
  solve_with_border(step.u);
  const Eigen::Index borders = border_.cols();
  Eigen::VectorXd rhs(borders);
  rhs.head(groups_) = b;
  if (!held_bounds_.empty()) rhs.head(groups_) += held_slope_.transpose() * a;
  if (borders > groups_) rhs[groups_] = -c;
  rhs -= border_.transpose() * step.u;
  const Eigen::VectorXd moved = borders > 0 ? Eigen::VectorXd(schur_.solve(rhs)) : Eigen::VectorXd();
  step.u -= border_solved_ * moved;
  step.m = moved.head(groups_);
  step.gauge_force = borders > groups_ ? moved[groups_] : 0;
  for (const RowKey key : held_bounds_) step.u[key.index] = held_slope_.row(key.index).dot(step.m);
  return step;
}

// a, b, c minus what the system's matrix makes of the step.
void NewtonSystem::subtract_product(const Step& step, Eigen::VectorXd& a, Eigen::VectorXd& b, double& c) const {
  const BoundedQpConstraints& q = rows_.constraints();
  a -= energy_.apply(step.u);
  for (int i = 0; i < n_; ++i) {
    const int g = q.group[index(i)];
    const double lower = springs_.lower[i], upper = springs_.upper[i];
    if (lower > 0) {
      const double force = lower * (step.u[i] - q.lower_slope[i] * step.m[g]);
      a[i] -= force;
      b[g] += q.lower_slope[i] * force;
    }
    if (upper > 0) {
      const double force = upper * (step.u[i] - q.upper_slope[i] * step.m[g]);
      a[i] -= force;
      b[g] += q.upper_slope[i] * force;
    }
  }
  for (std::size_t r = 0; r < q.rows.size(); ++r) {
    const double w = springs_.order[static_cast<Eigen::Index>(r)];
    if (!(w > 0)) continue;
    const RowKey key{Side::order, static_cast<int>(r)};
    const double force = w * (rows_.apply(key, step.u) + rows_.slope(key) * step.m[rows_.group(key)]);
    rows_.add_force(key, -force, a);
    b[rows_.group(key)] -= rows_.slope(key) * force;
  }
  if (gauge_.size() > 0) {
    a += step.gauge_force * gauge_;
    c -= gauge_.dot(step.u);
  }
}

NewtonSystem::Step NewtonSystem::solve(const Eigen::VectorXd& a, const Eigen::VectorXd& b, double c, int refinements) {
  Step step = solve_once(a, b, c);
  for (int k = 0; k < refinements; ++k) {
    Eigen::VectorXd a_left = a, b_left = b;
    double c_left = c;
    subtract_product(step, a_left, b_left, c_left);
    const Step more = solve_once(a_left, b_left, c_left);
    step.u += more.u;
    step.m += more.m;
    step.gauge_force += more.gauge_force;
  }
  return step;
}

Eigen::VectorXd order_softness(const Energy& energy, const Rows& rows) {
  const std::vector<InequalityRow>& order = rows.constraints().rows;
  Eigen::VectorXd softness(static_cast<Eigen::Index>(order.size()));
  for (std::size_t r = 0; r < order.size(); ++r) {
    double compliance = 0;
    for (std::size_t k = 0; k < order[r].index.size(); ++k) {
      const double a = order[r].coefficient[k], stiffness = energy.diagonal(order[r].index[k]);
      if (stiffness > 0) compliance += a * a / stiffness;
    }
    softness[static_cast<Eigen::Index>(r)] = spring_softness * (compliance > 0 ? compliance : 1);
  }
  return softness;
}

}  // namespace formwright::bounded_qp_detail
