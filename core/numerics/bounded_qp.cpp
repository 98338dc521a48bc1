// SPDX-License-Identifier: GPL-3.0-or-later
#include "numerics/bounded_qp.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "numerics/bounded_qp_energy.h"
#include "numerics/bounded_qp_rows.h"
#include "numerics/bounded_qp_tie.h"
#include "numerics/exchange_solver.h"

namespace formwright {

using namespace bounded_qp_detail;

struct BoundedQp::Implementation {
  Energy energy;
  ExchangeSolver exchange{energy};
};

BoundedQp::BoundedQp() : implementation_(std::make_unique<Implementation>()) {}
BoundedQp::~BoundedQp() = default;
BoundedQp::BoundedQp(BoundedQp&&) noexcept = default;
BoundedQp& BoundedQp::operator=(BoundedQp&&) noexcept = default;

void BoundedQp::set_energy(const SparseMatrix& lower_Q, std::vector<int> component, const Positions& positions, Context& context) {
  auto& I = *implementation_;
  I.energy.set(lower_Q, std::move(component), positions, {}, context);
  I.exchange.forget();
  I.energy.factorize_pinned({}, context);
}

BoundedQpSolution BoundedQp::solve(const BoundedQpConstraints& constraints, const BoundedQpOptions& options, Context& context) {
  auto& I = *implementation_;
  const Rows rows(constraints, I.energy);
  const ExchangeSettings settings{options.violation_tolerance, options.max_rounds, 1 << 30};
  ExchangeResult found = I.exchange.solve(rows, {}, settings, context);
  BoundedQpSolution solution;
  solution.u = std::move(found.u);
  solution.m = std::move(found.m);
  break_ties(I.energy, rows, found.pushing, options.violation_tolerance, solution.u, solution.m, context);
  rows.clip(solution.u, solution.m);
  Rows::Violations violations;
  rows.evaluate(solution.u, solution.m, violations);
  solution.violation_max = violations.max;
  solution.objective = I.energy.energy(solution.u);
  const double size = found.force.cwiseAbs().maxCoeff();
  solution.kkt_residual = size > 0 ? (I.energy.apply(solution.u) - found.force).cwiseAbs().maxCoeff() / size : 0;
  solution.rounds = found.rounds;
  solution.seconds = found.seconds;
  solution.history = std::move(found.history);
  solution.active_constraints = static_cast<int>(found.active.size());
  return solution;
}

double BoundedQp::memory_mb() const { return implementation_->energy.memory_mb() + implementation_->exchange.memory_mb(); }

}  // namespace formwright
