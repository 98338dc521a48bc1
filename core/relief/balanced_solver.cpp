// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/balanced_solver.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "base/index.h"
#include "numerics/convergence.h"
#include "relief/bounds/barrier.h"

namespace formwright {
namespace {

constexpr double beta_factor = 0.3, gap_factor = 0.3;  // from step to step
constexpr double min_beta = 1e-4;                      // a price below it is as good as the last one
constexpr double max_slope_left = 0.5;  // of the slope at the step's beginning: where a step has gone too far
constexpr int max_halvings = 12;
constexpr double min_length_to_go_on = 0.1;  // of a step, for beta and the barrier to fall
constexpr double smallest_shift = 1e-10;     // of the mean diagonal: parts without any bound stay determined

int slot_of(const SparseMatrix& lower, int a, int b) {
  const int column = std::min(a, b), row = std::max(a, b);
  const int *first = lower.innerIndexPtr() + lower.outerIndexPtr()[column],
            *last = lower.innerIndexPtr() + lower.outerIndexPtr()[column + 1];
  return static_cast<int>(std::lower_bound(first, last, row) - lower.innerIndexPtr());
}

}  // namespace

BalancedSolver::BalancedSolver(const ViewFrame& frame, const Triangles& F, const Visibility& visibility,
                               SparseMatrix lower_Q, Context& context, const Eigen::VectorXd& painted_weight)
    : normals_(frame, F, visibility, painted_weight), Q_(std::move(lower_Q)) {
  Q_.makeCompressed();
  matrix_ = Q_;
  slot_.reserve(normals_.corners().size());
  for (const std::array<int, 3>& c : normals_.corners())
    slot_.push_back({slot_of(Q_, c[0], c[0]), slot_of(Q_, c[1], c[1]), slot_of(Q_, c[2], c[2]), slot_of(Q_, c[1], c[0]),
                     slot_of(Q_, c[2], c[0]), slot_of(Q_, c[2], c[1])});
  factor_.analyze(Q_, frame.P, context);
}

Eigen::VectorXd BalancedSolver::energy_gradient(const Eigen::VectorXd& u) const {
  // The columns of Q add up to zero: written with differences, a large common constant costs no digits.
  Eigen::VectorXd result = Eigen::VectorXd::Zero(u.size());
  for (int j = 0; j < Q_.outerSize(); ++j)
    for (SparseMatrix::InnerIterator it(Q_, j); it; ++it) {
      const auto i = it.row();
      if (i == j) continue;
      const double force = it.value() * (u[j] - u[i]);
      result[i] += force;
      result[j] -= force;
    }
  return 2 * result;
}

double BalancedSolver::objective(const Eigen::VectorXd& u, double beta, double energy_unit) const {
  return normals_(u) + beta * energy(u) / energy_unit;
}

void BalancedSolver::load(double scale, const std::vector<NormalTerm::FaceModel>& faces,
                          const Eigen::VectorXd& diagonal) {
  double* values = matrix_.valuePtr();
  std::transform(Q_.valuePtr(), Q_.valuePtr() + Q_.nonZeros(), values, [&](double value) { return scale * value; });
  for (std::size_t f = 0; f < slot_.size(); ++f)
    for (std::size_t k = 0; k < 6; ++k) values[slot_[f][k]] += faces[f].hessian[k];
  for (int i = 0; i < diagonal.size(); ++i) values[matrix_.outerIndexPtr()[i]] += diagonal[i];
}

BalancedResult BalancedSolver::solve(const Eigen::VectorXd& start, double energy_unit, const Eigen::VectorXd& lower,
                                     const Eigen::VectorXd& upper, const BalancedSettings& settings, Context& context) {
  BalancedResult result;
  Eigen::VectorXd u = start;
  Barrier barrier(lower, upper, u);
  const double size = normals_(start);  // what the tolerances are shares of
  const double shift = smallest_shift * Q_.diagonal().mean() / energy_unit;
  double beta = settings.first_beta, gap = settings.first_gap;
  barrier.set_weight(gap * size);
  barrier.start_forces();
  struct Point {
    Eigen::VectorXd of_normals, of_energy;  // gradients
    std::vector<NormalTerm::FaceModel> faces;
  } here, there;
  const auto linearise = [&](const Eigen::VectorXd& at, Point& point) {
    normals_.linearise(at, point.of_normals, point.faces);
    point.of_energy = energy_gradient(at) / energy_unit;
  };
  linearise(u, here);
  // Both weights fall by a factor a step, then the decrease does.
  constexpr double share_of_weights = 0.6;
  Convergence weights(std::max(settings.last_beta, min_beta)), gaps(settings.gap), last(1);
  double at_end = 0;
  for (; result.steps < settings.max_steps; ++result.steps) {
    const double passed =
        share_of_weights * std::min(weights.passed(beta), gaps.passed(gap)) + (1 - share_of_weights) * at_end;
    context.progress(passed);
    load(2 * beta / energy_unit, here.faces, barrier.stiffness().array() + shift);
    {
      const auto quiet = context.span(passed, passed, "");  // one factorisation of many
      factor_.factorize(matrix_, context);
    }
    const Eigen::VectorXd slope = here.of_normals + beta * here.of_energy + barrier.gradient();
    Eigen::VectorXd step = -slope;
    factor_.solve(step);
    if (!step.allFinite())
      throw Error(ErrorCode::could_not_solve, "appearance",
                  "The relief did not converge on this model: choose the appearance \"detail\", or repair the model.");
    const double downhill = slope.dot(step);  // negative
    const bool at_the_end = beta <= settings.last_beta && gap <= settings.gap;
    if (at_the_end) at_end = last.passed(-downhill / (settings.decrease * size));
    if (at_the_end && -downhill <= settings.decrease * size) {
      result.converged = true;
      break;
    }
    Eigen::VectorXd way, trial;
    double length = 1;
    for (int halving = 0;; ++halving) {
      way = barrier.within(length * step);
      trial = u + way;
      linearise(trial, there);
      const double slope_here = slope.dot(way),
                   slope_there = (there.of_normals + beta * there.of_energy + barrier.gradient_at(trial)).dot(way);
      if ((slope_here < 0 && slope_there <= max_slope_left * -slope_here) || halving == max_halvings) break;
      length *= 0.5;
    }
    barrier.move(way);
    u = trial;
    std::swap(here, there);
    if (way.norm() < min_length_to_go_on * step.norm()) continue;
    beta = beta_factor * beta;
    if (beta < std::max(settings.last_beta, min_beta)) beta = settings.last_beta;
    gap = std::max(settings.gap, gap_factor * gap);
    barrier.set_weight(gap * size);
  }
  result.u = u;
  result.start_objective = objective(start, settings.last_beta, energy_unit);
  result.objective = objective(u, settings.last_beta, energy_unit);
  return result;
}

double BalancedSolver::memory_mb() const {
  return factor_.memory_mb() + 1e-6 * (static_cast<double>(Q_.nonZeros()) * 24 +
                                       static_cast<double>(slot_.size()) * 200 + static_cast<double>(Q_.rows()) * 150);
}

}  // namespace formwright
