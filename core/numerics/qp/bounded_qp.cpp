// SPDX-License-Identifier: GPL-3.0-or-later
#include "numerics/qp/bounded_qp.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "numerics/qp/interior_point/active_set_polish.h"
#include "numerics/qp/exchange/exchange_base.h"
#include "numerics/qp/problem/bounded_qp_energy.h"
#include "numerics/qp/problem/bounded_qp_rows.h"
#include "numerics/qp/bounded_qp_tie.h"
#include "numerics/qp/exchange/exchange_solver.h"
#include "numerics/qp/problem/feasible_point.h"
#include "numerics/qp/interior_point/interior_point_solver.h"

namespace formwright {

using namespace bounded_qp_detail;

namespace {
// Of the fractions that are reported, where one method follows the other.
constexpr double share_of_exchange = 0.6, share_of_interior_point = 0.95;

// Of the work that the interior point would take: what an exchange may take before it is given up. It is faster where
// few constraints hold.
constexpr double exchange_share = 0.6, exchange_only_share = 20;
// From this share on it is given up as soon as contacts spread: more constraints are violated than a round before,
// though the worst of those have joined. Thin reliefs that end in thousands of contacts show it early, and those that
// end sooner by the exchange do not (docs/numerics.md).
constexpr double share_to_judge = 0.03;
constexpr double min_exchange_work = 3e8;  // about a tenth of a second
constexpr double usual_iterations = 20;
constexpr double factor_growth = 3, entry_growth = 2;        // of the factor by order rows
constexpr double solves_per_iteration = 10, solve_work = 5;  // of forward and backward solves, for each entry of L
constexpr double round_off_room = 1e3;                       // of the tolerance, for order rows
constexpr double real_force =
    1e-10;  // of the largest stiffness times the largest displacement: smaller ones are round-off

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
  NewtonMatrix newton{energy};
  double seconds_interior = 0;

  struct Outcome {
    ExchangeResult result;
    QpMethod method = QpMethod::exchange;
    int iterations = 0;  // of the interior point
    double relative_gap = 0;
  };

  double interior_point_work() const;
  Outcome solve(const Rows& rows, const BoundedQpOptions& options, Context& context);
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
  I.newton.forget();
  I.energy.factorize_pinned({}, context);
}

double BoundedQp::Implementation::interior_point_work() const {
  const SparseCholesky& factor = energy.factor();
  return usual_iterations * (factor_growth * factor.factor_flops() +
                             solves_per_iteration * solve_work * entry_growth * factor.factor_entries());
}

BoundedQp::Implementation::Outcome BoundedQp::Implementation::solve(const Rows& rows, const BoundedQpOptions& options,
                                                                    Context& context) {
  Outcome outcome;
  // Leaves what was found so far in the outcome where the work ran out.
  const auto exchange_within = [&](double max_work, double work_to_judge) {
    const std::vector<RowKey> base = base_of(rows);
    outcome.result =
        exchange.solve(rows, base, {options.violation_tolerance, options.max_rounds, max_work, work_to_judge}, context);
    if (outcome.result.stopped) exchange.forget();
    else add_base_reactions(energy, rows, base, outcome.result);
    return !outcome.result.stopped;
  };
  const double work_of_try = std::max(min_exchange_work, exchange_share * interior_point_work()),
               max_work_of_exchange = std::max(min_exchange_work, exchange_only_share * interior_point_work());
  double tried = 0;
  if (options.method != QpMethod::interior_point) {
    tried = options.max_exchange_work > 0          ? options.max_exchange_work
            : options.method == QpMethod::exchange ? max_work_of_exchange
                                                   : work_of_try;
    const auto span = context.span(0, options.method == QpMethod::exchange ? 1 : share_of_exchange, "Finding contacts");
    const double work_to_judge = options.method == QpMethod::automatic
                                     ? std::max(min_exchange_work, share_to_judge * interior_point_work())
                                     : std::numeric_limits<double>::infinity();
    if (exchange_within(tried, work_to_judge)) return outcome;
  } else {
    outcome.result.u = Eigen::VectorXd::Zero(rows.size());
    outcome.result.m = rows.centred_m();
  }
  const ExchangeResult so_far = std::move(outcome.result);
  outcome.method = QpMethod::interior_point;
  Stopwatch watch;
  const InteriorPointStart start{so_far.u, so_far.m, so_far.active, so_far.multiplier, so_far.spread};
  const InteriorPointResult point = [&] {
    const auto span = context.span(share_of_exchange, share_of_interior_point, "Fitting into the thickness");
    return solve_interior_point(
        energy, newton, rows, start,
        {.violation = 0.1 * options.violation_tolerance, .max_iterations = options.max_iterations}, context);
  }();
  outcome.iterations = point.iterations;
  outcome.result = polish_active_set(energy, newton, rows, point, options.violation_tolerance, context);
  add_up(so_far, outcome.result);
  seconds_interior = watch.lap();
  if (!outcome.result.stopped) return outcome;
  outcome.relative_gap = point.relative_gap;
  // Without a point that satisfies every constraint, the interior point's own would not either, unless it is the
  // optimum: then an exchange would only tell exactly which constraints hold.
  const double second_try = point.converged ? work_of_try : max_work_of_exchange;
  if (!rows.constraints().start_satisfies_rows && tried < second_try) {
    const ExchangeResult before = std::move(outcome.result);
    if (exchange_within(second_try, std::numeric_limits<double>::infinity())) {
      add_up(before, outcome.result);
      outcome.method = QpMethod::exchange;
      outcome.relative_gap = 0;
      return outcome;
    }
    outcome.result = before;
  }
  return outcome;
}

BoundedQpSolution BoundedQp::solve(const BoundedQpConstraints& constraints, const BoundedQpOptions& options,
                                   Context& context) {
  auto& I = *implementation_;
  if (!(options.violation_tolerance > 0))
    throw Error(ErrorCode::invalid_input, "violation_tolerance", "The tolerance must be positive.");
  const Rows rows(constraints, I.energy);
  I.seconds_interior = 0;
  auto [found, method, iterations, relative_gap] = I.solve(rows, options, context);
  BoundedQpSolution solution;
  solution.u = std::move(found.u);
  solution.m = std::move(found.m);
  break_ties(I.energy, rows, found.pushing, 1e-3 * options.violation_tolerance, solution.u, solution.m, context);
  rows.clip(solution.u, solution.m);
  Rows::Violations violations;
  rows.evaluate(solution.u, solution.m, violations);
  const double allowed = round_off_room * options.violation_tolerance;
  if (relative_gap > 0 && violations.max > allowed) {
    const double smallest = (1 - relative_gap) * I.energy.energy(solution.u);
    move_inside(rows, solution.u, solution.m);
    rows.evaluate(solution.u, solution.m, violations);
    relative_gap = std::clamp(1 - smallest / I.energy.energy(solution.u), relative_gap, 1.0);
  }
  solution.violation_max = violations.max;
  // Bounds hold exactly after clipping; order rows on a badly conditioned energy only to round-off, which is reported.
  if (!(violations.max <= allowed)) {
    throw Error(ErrorCode::could_not_solve, "violation_tolerance",
                "Rounding errors leave depth order conditions violated by " +
                    std::to_string(violations.max / options.violation_tolerance) + " times the tolerance: allow more.");
  }
  solution.objective = I.energy.energy(solution.u);
  solution.kkt_residual = kkt_residual(I.energy, solution.u, found.force);
  solution.relative_gap = relative_gap;
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
