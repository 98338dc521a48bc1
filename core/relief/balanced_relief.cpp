// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/balanced_relief.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "relief/bounds/order_repair.h"
#include "relief/bounds/separators.h"
#include "relief/baselines.h"

namespace formwright {
namespace {

constexpr double inner_part = 0.8;       // of the slab, about its middle: where the first start is moved to
constexpr double inner_share = 0.05;     // by how much
constexpr double order_room = 1e-8;      // of the thickness
constexpr double separator_room = 1e-4;  // of the thickness
constexpr double box_share = 0.02;       // of the way between two bounds: how far from them a later start keeps
constexpr double min_width = 1e-6;       // of the thickness, between two bounds: a barrier needs room
constexpr double first_decrease = 3e-3;
constexpr int max_rounds = 3, later_steps = 6;
/// Of the fractions that are reported: a later round takes few steps.
constexpr double later_share = 0.15;
// Later rounds start near their end.
constexpr double later_beta = 4, later_gap = 30;  // times the last ones

/// The affine map of all depths that puts the bounded vertices against both sides of the slab, which a barrier keeps
/// them away from.
void fill_slab(const SlabProblem& problem, Eigen::VectorXd& u) {
  const DepthBounds& bounds = problem.bounds;
  const Eigen::VectorXd depth = problem.frame.depth(u);
  double low = INFINITY, high = -INFINITY, nearest = 0, farthest = 0;
  for (Eigen::Index i = 0; i < depth.size(); ++i) {
    if (!bounds.bounded[static_cast<std::size_t>(i)]) continue;
    low = std::min(low, depth[i]);
    high = std::max(high, depth[i]);
    nearest = bounds.nearest[i];
    farthest = bounds.farthest[i];
  }
  if (!(high > low)) return;
  const double scale = (farthest - nearest) / (high - low);
  for (int i = 0; i < depth.size(); ++i) u[i] = problem.frame.u_for_depth(i, farthest + scale * (depth[i] - high));
}

void repair(const SlabProblem& problem, const Eigen::VectorXd& feasible, Eigen::VectorXd& u) {
  if (problem.flat) fill_slab(problem, u);
  u = u.cwiseMax(problem.lower).cwiseMin(problem.upper);
  repair_order(problem.rows, problem.visibility.vertex, problem.lower, problem.upper, feasible,
               order_room * problem.thickness, u);
  u = u.cwiseMax(problem.lower).cwiseMin(problem.upper);
}

/// The bounds, those of vertices that are held at one depth a little apart. The result is clipped to the bounds
/// themselves.
std::pair<Eigen::VectorXd, Eigen::VectorXd> with_room(const SlabProblem& problem) {
  const Eigen::VectorXd middle = 0.5 * (problem.lower + problem.upper);
  const double half = 0.5 * min_width * problem.thickness;
  Eigen::VectorXd lower = problem.lower, upper = problem.upper;
  for (Eigen::Index i = 0; i < lower.size(); ++i)
    if (upper[i] - lower[i] < 2 * half) {
      lower[i] = middle[i] - half;
      upper[i] = middle[i] + half;
    }
  return {lower, upper};
}

/// `start` a little towards linear compression into the middle of the bounds, so that none is touched.
Eigen::VectorXd off_the_bounds(const SlabProblem& problem, const Eigen::VectorXd& start, const Eigen::VectorXd& lower,
                               const Eigen::VectorXd& upper) {
  const Eigen::VectorXd linear = linear_compression(problem.frame, problem.bounds);
  Eigen::VectorXd u(start.size());
  for (Eigen::Index i = 0; i < u.size(); ++i) {
    double middle = linear[i];
    if (problem.bounds.bounded[static_cast<std::size_t>(i)]) {
      // A vertex painted free has far more room than it should start in.
      const bool free = problem.bounds.nearest_allowed(i) < problem.bounds.nearest[i];
      const double low = free ? problem.frame.u_for_depth(static_cast<int>(i), problem.bounds.nearest[i]) : lower[i];
      const double size = upper[i] - low;
      const double share = std::clamp((linear[i] - low) / size, 0.0, 1.0);
      middle = low + (0.5 + inner_part * (share - 0.5)) * size;
    }
    u[i] = start[i] + inner_share * (middle - start[i]);
  }
  return u;
}

/// Every u strictly between its bounds, as near as possible.
Eigen::VectorXd inside(const Eigen::VectorXd& u, const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                       double thickness) {
  Eigen::VectorXd result = u;
  for (Eigen::Index i = 0; i < u.size(); ++i) {
    const double off = box_share * std::min(thickness, upper[i] - lower[i]);
    result[i] = std::clamp(u[i], lower[i] + off, upper[i] - off);
  }
  return result;
}

/// Gives the rows that `u` breaks their kind; says whether there are new ones with something visible behind.
bool separate_broken(const SlabProblem& problem, const Eigen::VectorXd& u, std::vector<Separator>& kind) {
  bool found = false;
  for (std::size_t k = 0; k < problem.rows.size(); ++k) {
    const InequalityRow& row = problem.rows[k];
    if (kind[k] != Separator::none) continue;
    double slack = -row.bound;
    for (std::size_t j = 0; j < row.index.size(); ++j) slack += row.coefficient[j] * u[row.index[j]];
    if (slack >= 0) continue;
    const bool seen = visible_behind(row, problem.visibility.vertex);
    kind[k] = seen ? Separator::between : Separator::behind;
    found = found || seen;
  }
  return found;
}

}  // namespace

BalancedResult balanced_relief(BalancedSolver& solver, const SlabProblem& problem, const Eigen::VectorXd& start,
                               const BalancedSettings& settings, Context& context) {
  BalancedResult result;
  result.u = start;
  result.converged = true;
  const double energy_unit = solver.energy(start);
  if (!(energy_unit > 0) || solver.normals().corners().empty()) return result;  // the model itself fits
  result.start_objective = result.objective = solver.objective(start, settings.last_beta, energy_unit);
  std::vector<Separator> kind(problem.rows.size(), Separator::none);
  const auto [bound_lower, bound_upper] = with_room(problem);
  Eigen::VectorXd lower = bound_lower, upper = bound_upper, point = off_the_bounds(problem, start, lower, upper);
  // While rows may still become separators, it need not be exact.
  BalancedSettings now = settings;
  now.decrease = std::max(settings.decrease, first_decrease);
  int steps = 0;
  for (int round = 0; round < max_rounds; ++round) {
    const auto begin = [](int of) { return of == 0 ? 0 : 1 - later_share * (max_rounds - of); };
    const auto span = context.span(begin(round), begin(round + 1), "Restoring broad forms");
    BalancedResult found = solver.solve(point, energy_unit, lower, upper, now, context);
    steps += found.steps;
    const bool broken = separate_broken(problem, found.u, kind);
    repair(problem, start, found.u);
    found.objective = solver.objective(found.u, settings.last_beta, energy_unit);
    if (round == 0 || found.objective < result.objective) {
      result.u = found.u;
      result.objective = found.objective;
      result.converged = found.converged;
    }
    if (!broken && round > 0) break;
    lower = bound_lower;
    upper = bound_upper;
    add_separators(problem.rows, kind, found.u, separator_room * problem.thickness, lower, upper);
    point = inside(found.u, lower, upper, problem.thickness);
    now.first_beta = std::min(settings.first_beta, later_beta * settings.last_beta);
    now.first_gap = std::min(settings.first_gap, later_gap * settings.gap);
    now.decrease = settings.decrease;
    now.max_steps = std::min(settings.max_steps, later_steps);
  }
  result.steps = steps;
  // Parts that gave way have kinks, which the energy counts even where they are hidden: the normals decide.
  if (!(solver.normals()(result.u) <= solver.normals()(start))) {
    result.u = start;
    result.objective = result.start_objective;
  }
  return result;
}

}  // namespace formwright
