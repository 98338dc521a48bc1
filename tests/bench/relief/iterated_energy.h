// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The nonlinear problem that eqs. (3.7) and (3.9) linearise: Laplacian, areas and, for eq. (3.6), mean curvature are
// taken from the deformed surface again and again (thesis, "Linear approximation effect").
#include <functional>
#include <vector>

#include "bench/relief/bounded_least_squares.h"

namespace formwright::test {

struct IterationSettings {
  int max_iterations = 100;
  double damping = 0.5;     // share of the step to each minimum that is taken
  double tolerance = 1e-4;  // of the slab: where the largest step ends the iteration
};

struct IteratedMinimum {
  Eigen::VectorXd u;
  std::vector<double> change;  // of each iteration: largest distance from u to the minimum, as a share of the slab
  bool converged = false;
};

/// `energy_at`: the energy with the operators of the surface deformed by u. `start`: allowed.
IteratedMinimum iterate(const std::function<LeastSquares(const Eigen::VectorXd& u)>& energy_at,
                        const AllowedDepths& allowed, const Eigen::VectorXd& start, const Positions& positions,
                        const IterationSettings& settings, Context& context);

}  // namespace formwright::test
