// SPDX-License-Identifier: GPL-3.0-or-later
#include "numerics/qp/interior_point_solver.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/index.h"
#include "numerics/qp/exchange_columns.h"

namespace formwright::bounded_qp_detail {

namespace {
constexpr double proximal = 1e-13;  // of the diagonal of Q, in the matrix only: components that touch nothing
constexpr double boundary_part = 0.9995;
constexpr double start_slack = 0.05;  // of the distance between the bounds
constexpr double balance_tolerance = 1e-9;
// Slacks and multipliers of one family of rows, g^T u + slope m - s = bound, s, y >= 0.
struct Family {
  std::vector<RowKey> key;
  Eigen::VectorXd s, y;            // slack and multiplier
  Eigen::VectorXd gap;             // g^T u + slope m - bound - s: what is left of the equation
  Eigen::VectorXd target, ds, dy;  // wanted change of s y; steps
};

class InteriorPoint {
 public:
  InteriorPoint(Energy& energy, const Rows& rows, std::span<const int> order, const InteriorPointStart& start);
  InteriorPointResult run(const InteriorPointSettings& settings, Context& context);

 private:
  void begin(const InteriorPointStart& start);
  void residuals();
  void assemble(Context& context);
  void direction();
  double step_length() const;
  double complementarity() const { return bounds_.s.dot(bounds_.y) + order_.s.dot(order_.y); }
  double count() const { return static_cast<double>(bounds_.key.size() + order_.key.size()); }
  double moved(RowKey key, const Eigen::VectorXd& u, const Eigen::VectorXd& m) const {
    return rows_.apply(key, u) + rows_.slope(key) * m[rows_.group(key)];
  }

  Energy& energy_;
  const Rows& rows_;
  int n_, groups_, borders_;  // borders: m, the gauge, the order rows
  Eigen::VectorXd gauge_;
  std::vector<char> fixed_;      // unknowns with lower = upper
  Eigen::MatrixXd fixed_slope_;  // n x groups: their du/dm
  Family bounds_, order_;
  Eigen::VectorXd u_, m_, du_, dm_;
  double gauge_force_ = 0, dgauge_ = 0;
  Eigen::VectorXd force_left_, m_left_;  // stationarity in u (free unknowns) and m
  Eigen::VectorXd diagonal_;
  Eigen::MatrixXd border_dense_;   // L^-1 P of the border columns of m and the gauge
  ExchangeColumns border_sparse_;  // of the order rows
  Eigen::PartialPivLU<Eigen::MatrixXd> schur_;
};

InteriorPoint::InteriorPoint(Energy& energy, const Rows& rows, std::span<const int> order,
                             const InteriorPointStart& start)
    : energy_(energy), rows_(rows), n_(energy.size()), groups_(rows.groups()) {
  const BoundedQpConstraints& c = rows.constraints();
  const double size = c.gauge.cwiseAbs().sum();
  gauge_ = size > 0 ? Eigen::VectorXd(c.gauge / size) : Eigen::VectorXd();
  fixed_.assign(index(n_), 0);
  fixed_slope_.setZero(n_, groups_);
  for (int i = 0; i < n_; ++i) {
    if (c.lower[i] == c.upper[i] && c.lower_slope[i] == c.upper_slope[i]) {
      fixed_[index(i)] = 1;
      fixed_slope_(i, c.group[index(i)]) = c.lower_slope[i];
      continue;
    }
    if (std::isfinite(c.lower[i])) bounds_.key.push_back({Side::lower, i});
    if (std::isfinite(c.upper[i])) bounds_.key.push_back({Side::upper, i});
  }
  for (const int r : order) order_.key.push_back({Side::order, r});
  borders_ = groups_ + (gauge_.size() > 0 ? 1 : 0) + static_cast<int>(order.size());
  begin(start);
}

void InteriorPoint::begin(const InteriorPointStart& start) {
  const BoundedQpConstraints& c = rows_.constraints();
  u_ = start.u;
  m_ = start.m;
  for (int i = 0; i < n_; ++i) {
    if (fixed_[index(i)]) u_[i] = c.lower[i] + c.lower_slope[i] * m_[c.group[index(i)]];
  }
  // A known multiplier times the slack its row starts with is how far from the end the start is.
  Eigen::VectorXd known = Eigen::VectorXd::Zero(n_),
                  known_order = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(c.rows.size()));
  std::vector<Side> side(index(n_), Side::order);
  for (std::size_t k = 0; k < start.active.size(); ++k) {
    const RowKey key = start.active[k];
    (key.side == Side::order ? known_order : known)[key.index] =
        std::max(0.0, start.multiplier[static_cast<Eigen::Index>(k)]);
    if (key.side != Side::order) side[index(key.index)] = key.side;
  }
  double product = 0;
  int products = 0;
  for (Family* family : {&bounds_, &order_}) {
    const auto k = static_cast<Eigen::Index>(family->key.size());
    family->s.resize(k);
    family->y.setZero(k);
    for (Eigen::Index a = 0; a < k; ++a) {
      const RowKey key = family->key[static_cast<std::size_t>(a)];
      const int i = key.index;
      double width = rows_.scale();
      if (key.side != Side::order && std::isfinite(c.lower[i]) && std::isfinite(c.upper[i])) {
        width =
            std::min(width, c.upper[i] - c.lower[i] + (c.upper_slope[i] - c.lower_slope[i]) * m_[c.group[index(i)]]);
      }
      family->s[a] =
          std::max(moved(key, u_, m_) - rows_.bound(key), std::max(start_slack * width, 1e-6 * rows_.scale()));
      if (key.side == Side::order) family->y[a] = known_order[i];
      else if (side[index(i)] == key.side) family->y[a] = known[i];
      if (family->y[a] > 0) {
        product += family->s[a] * family->y[a];
        ++products;
      }
    }
  }
  double mu = products > 0 ? product / products : 0;
  if (!(mu > 0))
    mu = std::max(energy_.energy(u_), 1e-12 * energy_.absolute_sum() * rows_.scale() * rows_.scale()) /
         std::max(1.0, count());
  for (Family* family : {&bounds_, &order_}) {
    for (Eigen::Index a = 0; a < family->s.size(); ++a) family->y[a] = std::max(family->y[a], mu / family->s[a]);
  }
}

void InteriorPoint::residuals() {
  force_left_ = energy_.apply(u_);
  if (gauge_.size() > 0) force_left_ -= gauge_force_ * gauge_;
  m_left_.setZero(groups_);
  for (Family* family : {&bounds_, &order_}) {
    family->gap.resize(family->s.size());
    for (std::size_t a = 0; a < family->key.size(); ++a) {
      const RowKey key = family->key[a];
      const auto k = static_cast<Eigen::Index>(a);
      rows_.add_force(key, -family->y[k], force_left_);
      m_left_[rows_.group(key)] -= rows_.slope(key) * family->y[k];
      family->gap[k] = moved(key, u_, m_) - rows_.bound(key) - family->s[k];
    }
  }
  m_left_ += fixed_slope_.transpose() * force_left_;
  for (int i = 0; i < n_; ++i) {
    if (fixed_[index(i)]) force_left_[i] = 0;
  }
}

// H = Q + diagonal on free unknowns; borders: columns C and the block E of
//   [H  C] [du]   [a]
//   [C' E] [db] = [c],   db = (dm, dgauge, d multipliers of order rows).
void InteriorPoint::assemble(Context& context) {
  diagonal_.setZero(n_);
  const int gauge_border = gauge_.size() > 0 ? groups_ : -1, first_order = groups_ + (gauge_border >= 0 ? 1 : 0);
  Eigen::MatrixXd E = Eigen::MatrixXd::Zero(borders_, borders_);
  border_dense_.setZero(n_, first_order);
  for (int g = 0; g < groups_; ++g) {
    if (fixed_slope_.col(g).isZero(0)) continue;
    border_dense_.col(g) = energy_.apply(fixed_slope_.col(g));
    for (int h = 0; h < groups_; ++h) E(h, g) = fixed_slope_.col(h).dot(border_dense_.col(g));
  }
  for (std::size_t a = 0; a < bounds_.key.size(); ++a) {
    const RowKey key = bounds_.key[a];
    const auto k = static_cast<Eigen::Index>(a);
    const double weight = bounds_.y[k] / bounds_.s[k], sign = key.side == Side::upper ? -1 : 1,
                 slope = rows_.slope(key);
    const int g = rows_.group(key);
    diagonal_[key.index] += weight;
    border_dense_(key.index, g) += weight * sign * slope;
    E(g, g) += weight * slope * slope;
  }
  if (gauge_border >= 0) {
    border_dense_.col(gauge_border) = -gauge_;
    E.row(gauge_border).head(groups_) = -(gauge_.transpose() * fixed_slope_);
    E.col(gauge_border).head(groups_) = E.row(gauge_border).head(groups_).transpose();
  }
  std::vector<SparseVector> forces;
  for (std::size_t a = 0; a < order_.key.size(); ++a) {
    const RowKey key = order_.key[a];
    const int border = first_order + static_cast<int>(a);
    const auto k = static_cast<Eigen::Index>(a);
    E(border, border) = -order_.s[k] / order_.y[k];
    E(border, rows_.group(key)) -= rows_.slope(key);
    const InequalityRow& row = rows_.constraints().rows[index(key.index)];
    std::vector<std::pair<int, double>> entries;
    for (std::size_t e = 0; e < row.index.size(); ++e) {
      if (!fixed_[index(row.index[e])]) entries.emplace_back(row.index[e], -row.coefficient[e]);
      else E.row(border).head(groups_) -= row.coefficient[e] * fixed_slope_.row(row.index[e]);
    }
    std::sort(entries.begin(), entries.end());
    SparseVector force;
    for (const auto& [i, value] : entries) {
      if (!force.index.empty() && force.index.back() == i) force.value.back() += value;
      else force.index.push_back(i), force.value.push_back(value);
    }
    forces.push_back(std::move(force));
    E.col(border).head(groups_) = E.row(border).head(groups_).transpose();
  }
  for (int i = 0; i < n_; ++i) {
    diagonal_[i] += proximal * energy_.diagonal(i);
    if (fixed_[index(i)]) border_dense_.row(i).setZero();
  }
  energy_.factorize_shifted(diagonal_, fixed_, context);
  for (Eigen::Index c = 0; c < border_dense_.cols(); ++c)
    energy_.factor().forward(Eigen::Ref<Eigen::VectorXd>(border_dense_.col(c)));
  border_sparse_.reset(n_);
  border_sparse_.append(energy_.factor().forward(forces), context);
  E.topLeftCorner(first_order, first_order) -= border_dense_.transpose() * border_dense_;
  const auto k = static_cast<Eigen::Index>(order_.key.size());
  if (k > 0) {
    E.bottomRightCorner(k, k) -= border_sparse_.gram();
    for (int c = 0; c < first_order; ++c) {
      const Eigen::VectorXd cross = border_sparse_.project(border_dense_.col(c));
      E.col(c).tail(k) -= cross;
      E.row(c).tail(k) -= cross.transpose();
    }
  }
  if (borders_ > 0) schur_.compute(E);
}

// The Newton step towards the families' targets for s dy + y ds.
void InteriorPoint::direction() {
  Eigen::VectorXd a = -force_left_, c = Eigen::VectorXd::Zero(borders_);
  const int gauge_border = gauge_.size() > 0 ? groups_ : -1, first_order = groups_ + (gauge_border >= 0 ? 1 : 0);
  c.head(groups_) = -m_left_;
  for (std::size_t b = 0; b < bounds_.key.size(); ++b) {
    const RowKey key = bounds_.key[b];
    const auto k = static_cast<Eigen::Index>(b);
    // dy = (target - y (g du + slope dm + gap)) / s; its constant part acts as a force.
    const double push = (bounds_.target[k] - bounds_.y[k] * bounds_.gap[k]) / bounds_.s[k];
    a[key.index] += key.side == Side::upper ? -push : push;
    c[rows_.group(key)] += rows_.slope(key) * push;
  }
  if (gauge_border >= 0) c[gauge_border] = gauge_.dot(u_);
  for (Eigen::Index k = 0; k < order_.s.size(); ++k)
    c[first_order + k] = order_.gap[k] - order_.target[k] / order_.y[k];
  energy_.factor().forward(Eigen::Ref<Eigen::VectorXd>(a));
  Eigen::VectorXd rhs = c;
  rhs.head(first_order) -= border_dense_.transpose() * a;
  if (order_.s.size() > 0) rhs.tail(order_.s.size()) -= border_sparse_.project(a);
  const Eigen::VectorXd db = borders_ > 0 ? Eigen::VectorXd(schur_.solve(rhs)) : Eigen::VectorXd();
  a -= border_dense_ * db.head(first_order);
  if (order_.s.size() > 0) a -= border_sparse_.combine(db.tail(order_.s.size()));
  energy_.factor().backward(a);
  du_ = std::move(a);
  dm_ = db.head(groups_);
  dgauge_ = gauge_border >= 0 ? db[gauge_border] : 0;
  for (int i = 0; i < n_; ++i) {
    if (fixed_[index(i)]) du_[i] = fixed_slope_.row(i).dot(dm_);
  }
  for (Family* family : {&bounds_, &order_}) {
    family->ds.resize(family->s.size());
    for (std::size_t b = 0; b < family->key.size(); ++b) {
      family->ds[static_cast<Eigen::Index>(b)] =
          moved(family->key[b], du_, dm_) + family->gap[static_cast<Eigen::Index>(b)];
    }
    family->dy = ((family->target.array() - family->y.array() * family->ds.array()) / family->s.array()).matrix();
  }
}

double InteriorPoint::step_length() const {
  double step = 1 / boundary_part;
  for (const Family* family : {&bounds_, &order_}) {
    for (Eigen::Index k = 0; k < family->s.size(); ++k) {
      if (family->ds[k] < 0) step = std::min(step, -family->s[k] / family->ds[k]);
      if (family->dy[k] < 0) step = std::min(step, -family->y[k] / family->dy[k]);
    }
  }
  return step;
}

InteriorPointResult InteriorPoint::run(const InteriorPointSettings& settings, Context& context) {
  InteriorPointResult result;
  for (;; ++result.iterations) {
    residuals();
    const double gap = complementarity(), mu = gap / std::max(1.0, count()), energy = energy_.energy(u_);
    double open = 0, force = 0;
    for (const Family* family : {&bounds_, &order_}) {
      if (family->s.size() == 0) continue;
      open = std::max(open, family->gap.cwiseAbs().maxCoeff());
      force = std::max(force, family->y.maxCoeff());
    }
    const double unbalanced = force_left_.cwiseAbs().maxCoeff();
    result.relative_gap = gap / std::max(energy, std::numeric_limits<double>::min());
    result.converged = result.relative_gap <= settings.relative_gap && open <= balance_tolerance * rows_.scale() &&
                       unbalanced <= balance_tolerance * force;
    context.progress(result.iterations / (result.iterations + 10.0), "Fitting into the thickness");
    if (result.converged || result.iterations >= settings.max_iterations || count() == 0) break;
    try {
      assemble(context);
    } catch (const Error& error) {
      // Multipliers over slacks span more than double precision holds: no better point can be had.
      if (error.code() != ErrorCode::could_not_solve) throw;
      break;
    }
    for (Family* family : {&bounds_, &order_}) family->target = -family->s.cwiseProduct(family->y);
    direction();
    double step = std::min(1.0, step_length()), after = 0;
    for (const Family* family : {&bounds_, &order_})
      after += (family->s + step * family->ds).dot(family->y + step * family->dy);
    const double sigma = std::pow(std::clamp(after / gap, 0.0, 1.0), 3);
    for (Family* family : {&bounds_, &order_}) {
      family->target =
          (sigma * mu - family->s.array() * family->y.array() - family->ds.array() * family->dy.array()).matrix();
    }
    direction();
    step = std::min(1.0, boundary_part * step_length());
    if (!(step > 1e-12) || !std::isfinite(step)) break;
    u_ += step * du_;
    m_ += step * dm_;
    gauge_force_ += step * dgauge_;
    for (Family* family : {&bounds_, &order_}) {
      family->s += step * family->ds;
      family->y += step * family->dy;
    }
  }
  result.slack_lower = result.slack_upper = Eigen::VectorXd::Ones(n_);
  result.force_lower = result.force_upper = Eigen::VectorXd::Zero(n_);
  for (std::size_t b = 0; b < bounds_.key.size(); ++b) {
    const auto k = static_cast<Eigen::Index>(b);
    const bool lower = bounds_.key[b].side == Side::lower;
    (lower ? result.slack_lower : result.slack_upper)[bounds_.key[b].index] = bounds_.s[k];
    (lower ? result.force_lower : result.force_upper)[bounds_.key[b].index] = bounds_.y[k];
  }
  for (const RowKey key : order_.key) result.order.push_back(key.index);
  result.order_slack = order_.s;
  result.order_force = order_.y;
  result.u = std::move(u_);
  result.m = std::move(m_);
  result.gauge_force = gauge_force_;
  return result;
}
}  // namespace

InteriorPointResult solve_interior_point(Energy& energy, const Rows& rows, std::span<const int> order,
                                         const InteriorPointStart& start, const InteriorPointSettings& settings,
                                         Context& context) {
  return InteriorPoint(energy, rows, order, start).run(settings, context);
}

}  // namespace formwright::bounded_qp_detail
