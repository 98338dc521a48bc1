// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// From the relief of eq. (3.13) to the one of BalancedSolver, in the same bounds.
#include "relief/balanced_solver.h"
#include "relief/base/depth_bounds.h"

namespace formwright {

struct SlabProblem {
  const ViewFrame& frame;
  const Visibility& visibility;
  const DepthBounds& bounds;
  bool flat;                               // all bounds are the same two planes
  double thickness;                        // between the bounds, in units of the width
  const Eigen::VectorXd &lower, &upper;    // n, u of the bounds; -inf / +inf where free
  const std::vector<InequalityRow>& rows;  // depth order
};

/// `start` (n): the optimum of eq. (3.13); its energy in the solver's is E0. On a flat base the result fills
/// the slab. It lies within its bounds exactly, keeps the rows, and its normals are not worse than the start's:
/// NormalTerm is not larger. Throws Error: could_not_solve, cancelled, out_of_memory.
BalancedResult balanced_relief(BalancedSolver& solver, const SlabProblem& problem, const Eigen::VectorXd& start,
                               const BalancedSettings& settings, Context& context);

}  // namespace formwright
