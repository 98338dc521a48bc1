// SPDX-License-Identifier: GPL-3.0-or-later
#include "numerics/qp/interior_point/interior_point_solver.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/index.h"
#include "numerics/convergence.h"
#include "numerics/qp/interior_point/newton_system.h"

namespace formwright::bounded_qp_detail {

namespace {
constexpr double boundary_part = 0.9995;
constexpr double start_slack = 0.05;  // of the distance between the bounds
// From a point well within the bounds towards an infeasible one of less energy than the optimum's (docs/numerics.md).
constexpr double part_of_start = 0.7;
constexpr double balance_tolerance = 1e-9;
constexpr double zero_energy = 1e-18;  // of the stiffness times the square of the lengths
constexpr double min_energy = 1e-12;   // of the same, where even the start has none
constexpr int steps_after_small_gap = 6;
constexpr double stiffer = 0.1;            // springs of order rows, a step, while rows do not close
constexpr double first_stiffening = 0.01;  // of what order_softness says: every step measures anew what is left
constexpr int max_corrections_of_step = 2;
constexpr double long_step = 0.9;

double square(double x) { return x * x; }

// Slacks and multipliers of one family of rows, g^T u + slope m - s = bound, s, y >= 0.
struct Family {
  std::vector<RowKey> key;
  Eigen::VectorXd s, y;            // slack and multiplier
  Eigen::VectorXd gap;             // g^T u + slope m - bound - s: what is left of the equation
  Eigen::VectorXd soft;            // ds = g^T du + slope dm + gap + soft dy
  Eigen::VectorXd target, ds, dy;  // wanted change of s y; steps
};

class InteriorPoint {
 public:
  InteriorPoint(const Energy& energy, NewtonMatrix& matrix, const Rows& rows, const InteriorPointStart& start);
  InteriorPointResult run(const InteriorPointSettings& settings, Context& context);

 private:
  void begin(const InteriorPointStart& start);
  double energy_of_nearest() const;
  void residuals();
  void factorize(Context& context);
  void direction();
  double step_length() const;
  double correct(double step, double wanted_product);
  double complementarity() const { return bounds_.s.dot(bounds_.y) + order_.s.dot(order_.y); }
  double count() const { return static_cast<double>(bounds_.key.size() + order_.key.size()); }
  double moved(RowKey key, const Eigen::VectorXd& u, const Eigen::VectorXd& m) const {
    return rows_.apply(key, u) + rows_.slope(key) * m[rows_.group(key)];
  }

  const Energy& energy_;
  const Rows& rows_;
  NewtonSystem system_;
  int n_, groups_;
  Family bounds_, order_;
  Eigen::VectorXd u_, m_, du_, dm_;
  double gauge_force_ = 0, dgauge_ = 0;
  Eigen::VectorXd force_left_, m_left_;  // stationarity in u and m
};

InteriorPoint::InteriorPoint(const Energy& energy, NewtonMatrix& matrix, const Rows& rows,
                             const InteriorPointStart& start)
    : energy_(energy), rows_(rows), system_(energy, matrix, rows), n_(energy.size()), groups_(rows.groups()) {
  const BoundedQpConstraints& c = rows.constraints();
  std::vector<RowKey> held;
  for (int i = 0; i < n_; ++i) {
    if (c.lower[i] == c.upper[i] && c.lower_slope[i] == c.upper_slope[i]) {
      held.push_back({Side::both, i});
      continue;
    }
    if (std::isfinite(c.lower[i])) bounds_.key.push_back({Side::lower, i});
    if (std::isfinite(c.upper[i])) bounds_.key.push_back({Side::upper, i});
  }
  system_.hold(held);
  // Where all unknowns of a row are held nothing can move it: its force would grow without end.
  for (std::size_t r = 0; r < c.rows.size(); ++r) {
    const auto is_held = [&](int i) { return system_.held(i); };
    if (!std::all_of(c.rows[r].index.begin(), c.rows[r].index.end(), is_held))
      order_.key.push_back({Side::order, static_cast<int>(r)});
  }
  begin(start);
}

void InteriorPoint::begin(const InteriorPointStart& start) {
  const BoundedQpConstraints& c = rows_.constraints();
  // A point within the bounds needs no travel: its energy is of the size of the answer's, and so are the first
  // multipliers.
  const bool inside = c.start_u.size() == n_ && c.start_m.size() == groups_;
  u_ = inside ? c.start_u : start.u;
  m_ = inside ? c.start_m : start.m;
  if (inside && start.is_near) {
    u_ += part_of_start * (start.u - u_);
    m_ += part_of_start * (start.m - m_);
  }
  system_.place_held(u_, m_);
  bounds_.soft.setZero(static_cast<Eigen::Index>(bounds_.key.size()));
  const Eigen::VectorXd softness = order_softness(energy_, rows_);
  order_.soft.resize(static_cast<Eigen::Index>(order_.key.size()));
  for (std::size_t a = 0; a < order_.key.size(); ++a)
    order_.soft[static_cast<Eigen::Index>(a)] = first_stiffening * softness[order_.key[a].index];
  // A known multiplier times the slack its row starts with is how far from the end the start is.
  Eigen::VectorXd known = Eigen::VectorXd::Zero(n_),
                  known_order = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(c.rows.size()));
  std::vector<Side> side(index(n_), Side::order);
  for (std::size_t k = 0; !inside && k < start.active.size(); ++k) {
    const RowKey key = start.active[k];
    (key.side == Side::order ? known_order : known)[key.index] =
        std::max(0.0, start.multiplier[static_cast<Eigen::Index>(k)]);
    if (key.side != Side::order) side[index(key.index)] = key.side;
  }
  const auto width_of = [&](int i) {
    if (!std::isfinite(c.lower[i]) || !std::isfinite(c.upper[i])) return rows_.scale();
    return std::min(rows_.scale(),
                    c.upper[i] - c.lower[i] + (c.upper_slope[i] - c.lower_slope[i]) * m_[c.group[index(i)]]);
  };
  double widths = 0;
  for (int i = 0; i < n_; ++i) widths += width_of(i) / n_;
  // Products of the size that the energy's forces and the distances between the bounds have: multipliers that start far
  // below what will be needed cost tens of short steps.
  const double force_product = energy_.apply(u_).lpNorm<1>() * widths / std::max(1.0, count());
  double product = 0;
  int products = 0;
  for (Family* family : {&bounds_, &order_}) {
    const auto k = static_cast<Eigen::Index>(family->key.size());
    family->s.resize(k);
    family->y.setZero(k);
    for (Eigen::Index a = 0; a < k; ++a) {
      const RowKey key = family->key[static_cast<std::size_t>(a)];
      const double width = key.side == Side::order ? widths : width_of(key.index);
      family->s[a] = std::max(moved(key, u_, m_) - rows_.bound(key), start_slack * width);
      if (key.side == Side::order) family->y[a] = known_order[key.index];
      else if (side[index(key.index)] == key.side) family->y[a] = known[key.index];
      if (family->y[a] > 0) {
        product += family->s[a] * family->y[a];
        ++products;
      }
    }
  }
  double mu = products > 0 ? product / products : 0;
  if (!(mu > 0)) {
    mu = std::max(
             {energy_.energy(u_), energy_of_nearest(), min_energy * energy_.absolute_sum() * square(rows_.scale())}) /
         std::max(1.0, count());
    mu = std::max(mu, force_product);
  }
  for (Family* family : {&bounds_, &order_}) {
    for (Eigen::Index a = 0; a < family->s.size(); ++a) family->y[a] = std::max(family->y[a], mu / family->s[a]);
  }
}

// Of the point that is moved onto each violated constraint by itself. Multipliers that start far below what the
// constraints will need cost tens of short steps; those far above cost one or two.
double InteriorPoint::energy_of_nearest() const {
  Eigen::VectorXd moved_u = u_;
  for (std::size_t a = 0; a < bounds_.key.size(); ++a) {
    const RowKey key = bounds_.key[a];
    const double missing = rows_.bound(key) - moved(key, u_, m_);
    if (missing > 0) moved_u[key.index] += key.side == Side::upper ? -missing : missing;
  }
  for (const InequalityRow& row : rows_.constraints().rows) {
    double value = row.slope * m_[row.group] - row.bound, size = 0;
    for (std::size_t k = 0; k < row.index.size(); ++k) {
      value += row.coefficient[k] * moved_u[row.index[k]];
      size += square(row.coefficient[k]);
    }
    if (!(value < 0) || !(size > 0)) continue;
    for (std::size_t k = 0; k < row.index.size(); ++k) moved_u[row.index[k]] -= value * row.coefficient[k] / size;
  }
  return energy_.energy(moved_u);
}

void InteriorPoint::residuals() {
  force_left_ = energy_.apply(u_);
  const Eigen::VectorXd& gauge = system_.gauge();
  if (gauge.size() > 0) force_left_ -= gauge_force_ * gauge;
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
}

void InteriorPoint::factorize(Context& context) {
  NewtonSystem::Springs springs;
  springs.lower.setZero(n_);
  springs.upper.setZero(n_);
  for (std::size_t a = 0; a < bounds_.key.size(); ++a) {
    const auto k = static_cast<Eigen::Index>(a);
    (bounds_.key[a].side == Side::upper ? springs.upper : springs.lower)[bounds_.key[a].index] =
        bounds_.y[k] / bounds_.s[k];
  }
  springs.order.setZero(static_cast<Eigen::Index>(rows_.constraints().rows.size()));
  for (std::size_t a = 0; a < order_.key.size(); ++a) {
    const auto k = static_cast<Eigen::Index>(a);
    springs.order[order_.key[a].index] = order_.y[k] / (order_.s[k] + order_.y[k] * order_.soft[k]);
  }
  system_.factorize(springs, context);
}

// The Newton step towards the families' targets for s dy + y ds.
void InteriorPoint::direction() {
  Eigen::VectorXd a = -force_left_, b = -m_left_;
  for (const Family* family : {&bounds_, &order_}) {
    for (std::size_t e = 0; e < family->key.size(); ++e) {
      const RowKey key = family->key[e];
      const auto k = static_cast<Eigen::Index>(e);
      // dy = (target - y (g du + slope dm + gap)) / (s + y soft); its constant part acts as a force.
      const double push =
          (family->target[k] - family->y[k] * family->gap[k]) / (family->s[k] + family->y[k] * family->soft[k]);
      rows_.add_force(key, push, a);
      b[rows_.group(key)] += rows_.slope(key) * push;
    }
  }
  const double c = system_.gauge().size() > 0 ? -system_.gauge().dot(u_) : 0;
  NewtonSystem::Step step = system_.solve(a, b, c, 0);
  du_ = std::move(step.u);
  dm_ = std::move(step.m);
  dgauge_ = step.gauge_force;
  for (Family* family : {&bounds_, &order_}) {
    family->ds.resize(family->s.size());
    family->dy.resize(family->s.size());
    for (std::size_t e = 0; e < family->key.size(); ++e) {
      const auto k = static_cast<Eigen::Index>(e);
      const double open = moved(family->key[e], du_, dm_) + family->gap[k];
      family->dy[k] = (family->target[k] - family->y[k] * open) / (family->s[k] + family->y[k] * family->soft[k]);
      family->ds[k] = open + family->soft[k] * family->dy[k];
    }
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

// Corrections towards products s y of equal size (Gondzio 1996), while they lengthen the step: a solve costs far less
// than a factorisation.
double InteriorPoint::correct(double step, double wanted_product) {
  for (int k = 0; k < max_corrections_of_step && step < long_step; ++k) {
    const double goal = std::min(1.0, 1.5 * step + 0.1), small = 0.1 * wanted_product, large = 10 * wanted_product;
    const Family bounds = bounds_, order = order_;
    const Eigen::VectorXd du = du_, dm = dm_;
    const double dgauge = dgauge_, before = step;
    for (Family* family : {&bounds_, &order_}) {
      for (Eigen::Index e = 0; e < family->s.size(); ++e) {
        const double product = (family->s[e] + goal * family->ds[e]) * (family->y[e] + goal * family->dy[e]);
        if (product < small) family->target[e] += small - product;
        else if (product > large) family->target[e] += std::max(large - product, -large);
      }
    }
    direction();
    step = std::min(1.0, boundary_part * step_length());
    if (step >= 1.1 * before) continue;
    if (step < before) {
      bounds_ = bounds;
      order_ = order;
      du_ = du;
      dm_ = dm;
      dgauge_ = dgauge;
      step = before;
    }
    break;
  }
  return step;
}

InteriorPointResult InteriorPoint::run(const InteriorPointSettings& settings, Context& context) {
  InteriorPointResult result;
  int small_gaps = 0;
  double open_before = std::numeric_limits<double>::infinity();
  Convergence convergence(1);
  for (;; ++result.iterations) {
    residuals();
    const double gap = complementarity(), mu = gap / std::max(1.0, count()), energy = energy_.energy(u_);
    double open = 0, force = 0;
    for (const Family* family : {&bounds_, &order_}) {
      if (family->s.size() == 0) continue;
      open = std::max(open, family->gap.cwiseAbs().maxCoeff());
      force = std::max(force, family->y.maxCoeff());
    }
    double unbalanced = 0;
    for (int i = 0; i < n_; ++i) {
      if (!system_.held(i)) unbalanced = std::max(unbalanced, std::abs(force_left_[i]));
    }
    // Where nothing needs to bend, the energy is round-off.
    const double no_energy = zero_energy * energy_.absolute_sum() * rows_.scale() * rows_.scale();
    result.relative_gap = gap / std::max({energy, no_energy, std::numeric_limits<double>::min()});
    const double off_gauge = system_.gauge().size() > 0 ? std::abs(system_.gauge().dot(u_)) : 0;
    open = std::max(open, off_gauge);
    result.violation = open;
    result.converged = result.relative_gap <= settings.relative_gap && open <= settings.violation &&
                       unbalanced <= balance_tolerance * force;
    const double passed =
        convergence.passed(std::max(result.relative_gap / settings.relative_gap, open / settings.violation));
    context.progress(passed, "Fitting into the thickness");
    // What a few more steps do not improve is round-off.
    small_gaps = result.relative_gap <= settings.relative_gap && open > 0.5 * open_before ? small_gaps + 1 : 0;
    // Rows that nearly repeat each other share a force that soft springs move from one to the other only slowly.
    if (small_gaps > 0) order_.soft *= stiffer;
    open_before = open;
    if (small_gaps > steps_after_small_gap) break;
    if (result.converged || result.iterations >= settings.max_iterations || count() == 0) break;
    try {
      const auto quiet = context.span(passed, passed, "");  // one factorisation of many
      factorize(context);
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
    const double left = std::clamp(after / gap, 0.0, 1.0);
    // Below the gap that is asked for, smaller products only cost digits while rows still close.
    const double asked = settings.relative_gap * std::max(energy, no_energy) / std::max(1.0, count());
    const double wanted = std::max(left * left * left * mu, 0.1 * asked);
    for (Family* family : {&bounds_, &order_}) {
      family->target =
          (wanted - family->s.array() * family->y.array() - family->ds.array() * family->dy.array()).matrix();
    }
    direction();
    step = std::min(1.0, boundary_part * step_length());
    step = correct(step, wanted);
    if (!(step > 1e-12) || !std::isfinite(step) || !du_.allFinite() || !dm_.allFinite()) break;
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
  result.order_slack = Eigen::VectorXd::Ones(static_cast<Eigen::Index>(rows_.constraints().rows.size()));
  result.order_force = Eigen::VectorXd::Zero(result.order_slack.size());
  for (std::size_t a = 0; a < order_.key.size(); ++a) {
    result.order_slack[order_.key[a].index] = order_.s[static_cast<Eigen::Index>(a)];
    result.order_force[order_.key[a].index] = order_.y[static_cast<Eigen::Index>(a)];
  }
  result.u = std::move(u_);
  result.m = std::move(m_);
  result.gauge_force = gauge_force_;
  return result;
}
}  // namespace

InteriorPointResult solve_interior_point(const Energy& energy, NewtonMatrix& matrix, const Rows& rows,
                                         const InteriorPointStart& start, const InteriorPointSettings& settings,
                                         Context& context) {
  matrix.analyze(rows, context);
  return InteriorPoint(energy, matrix, rows, start).run(settings, context);
}

}  // namespace formwright::bounded_qp_detail
