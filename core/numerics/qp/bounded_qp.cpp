// SPDX-License-Identifier: GPL-3.0-or-later
#include "numerics/qp/bounded_qp.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "numerics/qp/bounded_qp_base.h"
#include "numerics/qp/bounded_qp_crossover.h"
#include "numerics/qp/bounded_qp_energy.h"
#include "numerics/qp/bounded_qp_rows.h"
#include "numerics/qp/bounded_qp_tie.h"
#include "numerics/qp/exchange_solver.h"
#include "numerics/qp/interior_point_solver.h"

namespace formwright {

using namespace bounded_qp_detail;

namespace {
constexpr std::size_t many_equalities = 32;  // from here on they leave the factorisation instead of filling the pool
constexpr int rounds_before_interior_point = 4;
constexpr int stages_before_interior_point = 40;
constexpr int order_rounds = 20;
constexpr double round_off_room = 1e3;  // of the tolerance, for order rows
constexpr double real_force =
    1e-10;  // of the largest stiffness times the largest displacement: smaller ones are round-off

std::vector<RowKey> equal_bounds(const Rows& rows) {
  const BoundedQpConstraints& c = rows.constraints();
  std::vector<RowKey> found;
  for (int i = 0; i < rows.size(); ++i) {
    if (c.lower[i] == c.upper[i] && c.lower_slope[i] == c.upper_slope[i]) found.push_back({Side::both, i});
  }
  return found;
}

// Counts what was done before into a later result.
void add_up(const ExchangeResult& before, ExchangeResult& result) {
  result.rounds += before.rounds;
  result.history.insert(result.history.begin(), before.history.begin(), before.history.end());
  result.seconds.factorise += before.seconds.factorise;
  result.seconds.columns += before.seconds.columns;
  result.seconds.pool += before.seconds.pool;
  result.seconds.sweeps += before.seconds.sweeps;
}

// Relative to the largest force. Where nothing pushes, force and Q u are both round-off: relative to what cancels
// there.
double kkt_residual(const Energy& energy, const Eigen::VectorXd& u, const Eigen::VectorXd& force) {
  if (u.size() == 0) return 0;
  const double left = (energy.apply(u) - force).cwiseAbs().maxCoeff();
  const double push = force.cwiseAbs().maxCoeff(), stiff = energy.largest_stiffness() * u.cwiseAbs().maxCoeff();
  const double size = push > real_force * stiff ? push : stiff;
  return size > 0 ? left / size : 0;
}
}  // namespace

struct BoundedQp::Implementation {
  Energy energy;
  ExchangeSolver exchange{energy};
  double seconds_interior = 0;

  struct Outcome {
    ExchangeResult result;
    QpMethod method = QpMethod::exchange;
    int iterations = 0;  // of the interior point
  };

  Outcome solve(const Rows& rows, const BoundedQpOptions& options, Context& context);
  Outcome solve_densely(const Rows& rows, ExchangeResult so_far, const BoundedQpOptions& options, Context& context);
};

BoundedQp::BoundedQp() : implementation_(std::make_unique<Implementation>()) {}
BoundedQp::~BoundedQp() = default;
BoundedQp::BoundedQp(BoundedQp&&) noexcept = default;
BoundedQp& BoundedQp::operator=(BoundedQp&&) noexcept = default;

void BoundedQp::set_energy(const SparseMatrix& lower_Q, std::vector<int> component, const Positions& positions,
                           Context& context) {
  auto& I = *implementation_;
  I.energy.set(lower_Q, std::move(component), positions, {}, context);
  I.exchange.forget();
  I.energy.factorize_pinned({}, context);
}

BoundedQp::Implementation::Outcome BoundedQp::Implementation::solve(const Rows& rows, const BoundedQpOptions& options,
                                                                    Context& context) {
  std::vector<RowKey> base = equal_bounds(rows);
  if (base.size() < many_equalities) base.clear();
  ExchangeSettings settings;
  settings.violation_tolerance = options.violation_tolerance;
  settings.max_rounds = options.max_rounds;
  if (options.method != QpMethod::interior_point) settings.max_active = options.max_active_in_pool;
  if (options.method == QpMethod::interior_point)
    settings.max_rounds = std::min(options.max_rounds, rounds_before_interior_point);
  settings.may_stop = true;
  Outcome outcome;
  outcome.result = exchange.solve(rows, base, settings, context);
  if (options.method == QpMethod::interior_point)
    return solve_densely(rows, std::move(outcome.result), options, context);
  if (!outcome.result.stopped) {
    add_base_reactions(energy, rows, base, outcome.result);
    return outcome;
  }
  // Dense contact: what holds now is the guess to go on from.
  for (const RowKey key : outcome.result.active) {
    if (key.side == Side::lower || key.side == Side::upper) base.push_back(key);
    else if (key.side == Side::order) settings.first.push_back(key);
  }
  const int stages = options.method == QpMethod::exchange ? options.max_rounds : stages_before_interior_point;
  auto dense = exchange_on_base(energy, rows, base, settings, stages, context);
  if (!dense && options.method == QpMethod::automatic)
    return solve_densely(rows, std::move(outcome.result), options, context);
  if (!dense) {
    throw Error(ErrorCode::could_not_solve, "max_rounds",
                "The relief did not converge in " + std::to_string(stages) +
                    " stages: raise the thickness, or repair the model.");
  }
  add_up(outcome.result, *dense);
  outcome.result = std::move(*dense);
  return outcome;
}

// Interior point on all bounds and those order rows that turn out to matter, then the exact active set.
BoundedQp::Implementation::Outcome BoundedQp::Implementation::solve_densely(const Rows& rows, ExchangeResult so_far,
                                                                            const BoundedQpOptions& options,
                                                                            Context& context) {
  Outcome outcome;
  outcome.method = QpMethod::interior_point;
  Stopwatch watch;
  std::vector<int> order;
  for (const RowKey key : so_far.active) {
    if (key.side == Side::order) order.push_back(key.index);
  }
  InteriorPointStart start{so_far.u, so_far.m, so_far.active, so_far.multiplier};
  InteriorPointSettings settings;
  InteriorPointResult point;
  for (int round = 0;; ++round) {
    point = solve_interior_point(energy, rows, order, start, settings, context);
    outcome.iterations += point.iterations;
    Rows::Violations violations;
    rows.evaluate(point.u, point.m, violations);
    const std::size_t before = order.size();
    for (const RowKey key : rows.worth_adding(violations, options.violation_tolerance)) {
      if (key.side == Side::order && std::find(order.begin(), order.end(), key.index) == order.end())
        order.push_back(key.index);
    }
    if (order.size() == before || round == order_rounds) break;
    start = {point.u, point.m, {}, {}};
    std::vector<double> force;
    const auto note = [&](RowKey key, double y) {
      start.active.push_back(key);
      force.push_back(y);
    };
    for (int i = 0; i < rows.size(); ++i) {
      if (point.force_lower[i] > 0 && point.force_lower[i] >= point.force_upper[i])
        note({Side::lower, i}, point.force_lower[i]);
      else if (point.force_upper[i] > 0) note({Side::upper, i}, point.force_upper[i]);
    }
    for (std::size_t k = 0; k < point.order.size(); ++k)
      note({Side::order, point.order[k]}, point.order_force[static_cast<Eigen::Index>(k)]);
    start.multiplier = Eigen::Map<const Eigen::VectorXd>(force.data(), static_cast<Eigen::Index>(force.size()));
  }
  const double seconds_interior_point = watch.lap();
  ExchangeSettings exact;
  exact.violation_tolerance = options.violation_tolerance;
  exact.max_rounds = options.max_rounds;
  exact.max_active = options.max_active_in_pool;
  exact.may_stop = true;
  auto crossed = crossover(energy, rows, point, exact, context);
  if (!crossed) {
    throw Error(
        ErrorCode::could_not_solve, "constraints",
        "Too many points of the relief are close to its limits to be solved: raise the thickness or simplify the model.");
  }
  add_up(so_far, *crossed);
  outcome.result = std::move(*crossed);
  seconds_interior = seconds_interior_point;
  return outcome;
}

BoundedQpSolution BoundedQp::solve(const BoundedQpConstraints& constraints, const BoundedQpOptions& options,
                                   Context& context) {
  auto& I = *implementation_;
  if (!(options.violation_tolerance > 0))
    throw Error(ErrorCode::invalid_input, "violation_tolerance", "The tolerance must be positive.");
  const Rows rows(constraints, I.energy);
  I.seconds_interior = 0;
  auto [found, method, iterations] = I.solve(rows, options, context);
  BoundedQpSolution solution;
  solution.u = std::move(found.u);
  solution.m = std::move(found.m);
  break_ties(I.energy, rows, found.pushing, 1e-3 * options.violation_tolerance, solution.u, solution.m, context);
  rows.clip(solution.u, solution.m);
  Rows::Violations violations;
  rows.evaluate(solution.u, solution.m, violations);
  solution.violation_max = violations.max;
  // Bounds hold exactly after clipping; order rows on a badly conditioned energy only to round-off, which is reported.
  if (!(violations.max <= round_off_room * options.violation_tolerance)) {
    throw Error(ErrorCode::could_not_solve, "violation_tolerance",
                "Rounding errors leave depth order conditions violated by " +
                    std::to_string(violations.max / options.violation_tolerance) + " times the tolerance: allow more.");
  }
  solution.objective = I.energy.energy(solution.u);
  solution.kkt_residual = kkt_residual(I.energy, solution.u, found.force);
  solution.rounds = found.rounds;
  solution.active_constraints = static_cast<int>(found.active.size());
  solution.method_used = method;
  solution.interior_point_iterations = iterations;
  solution.seconds = found.seconds;
  solution.seconds.interior_point = I.seconds_interior;
  solution.history = std::move(found.history);
  return solution;
}

double BoundedQp::memory_mb() const {
  return implementation_->energy.memory_mb() + implementation_->exchange.memory_mb();
}

}  // namespace formwright
