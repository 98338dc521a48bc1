// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/relief/iterated_energy.h"

namespace formwright::test {

IteratedMinimum iterate(const std::function<LeastSquares(const Eigen::VectorXd& u)>& energy_at,
                        const AllowedDepths& allowed, const Eigen::VectorXd& start, const Positions& positions,
                        const IterationSettings& settings, Context& context) {
  IteratedMinimum result{start, {}, false};
  const Eigen::VectorXd slab = allowed.upper - allowed.lower;
  BoundedLeastSquares solver(positions);
  for (int k = 0; k < settings.max_iterations && !result.converged; ++k) {
    const Eigen::VectorXd step = solver.minimise(energy_at(result.u), allowed, context).u - result.u;
    result.change.push_back(step.cwiseQuotient(slab).cwiseAbs().maxCoeff());
    result.converged = result.change.back() < settings.tolerance;
    result.u += settings.damping * step;
  }
  return result;
}

}  // namespace formwright::test
