// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Gradient and Hessian of a sum over triangles in the variables of a SeamlessChart, and Newton's step from them. Local
// variables make a sparse matrix of fixed pattern, analysed once; the few shared ones are its dense border.
#include <Eigen/Core>
#include <functional>
#include <vector>

#include "numerics/sparse/sparse_cholesky.h"
#include "zippable/chart/seamless_chart.h"
#include "zippable/chart/symmetric_dirichlet.h"

namespace formwright {

/// Weighted energy, gradient and Hessian of one triangle by its corners' coordinates.
using TriangleTerms = std::function<DirichletTerms(int face)>;

struct NewtonStep {
  Eigen::VectorXd local, shared;
  double slope = 0;  // gradient times step; negative
};

/// Of the progress of a parameterisation, what analysing the pattern takes.
inline constexpr double ordering_share = 0.15;

class NewtonSystem {
 public:
  /// Finds the pattern and analyses it. Throws Error: cancelled, out_of_memory.
  NewtonSystem(const SeamlessChart& chart, Context& context);

  /// Sums the terms of all triangles. Parallel, and the same bits for any number of threads.
  void assemble(const TriangleTerms& terms);
  /// Keeps a local variable at its value: its row becomes that of the identity with gradient 0.
  void hold(int local);
  /// Keeps all shared variables at their values.
  void hold_shared() { shared_held_ = true; }

  double energy() const { return energy_; }
  const Eigen::VectorXd& gradient_local() const { return gradient_; }
  const Eigen::VectorXd& gradient_shared() const { return gradient_shared_; }
  /// H times a vector, for tests.
  void apply(const Eigen::VectorXd& local, const Eigen::VectorXd& shared, Eigen::VectorXd& out_local,
             Eigen::VectorXd& out_shared) const;

  /// False when the matrix is not positive definite. Diagonal entries of local variables count 1 + `damping` times.
  bool solve(NewtonStep& step, double damping, Context& context);
  double factor_entries() const { return cholesky_.factor_entries(); }
  /// Lower triangle over the local variables as last assembled, for benchmarks.
  const SparseMatrix& lower_hessian() const { return lower_; }

 private:
  const SeamlessChart& chart_;
  SparseMatrix lower_;
  std::vector<int> slot_;      // per triangle 36: place of the pair of corner coordinates among the values; -1: none or
                               // above the diagonal
  std::vector<int> bordered_;  // triangles that touch a shared variable
  std::vector<DirichletTerms> terms_;
  Eigen::VectorXd gradient_, gradient_shared_;
  Eigen::MatrixXd border_, corner_;
  std::vector<char> held_;
  bool shared_held_ = false, any_held_ = false;
  double energy_ = 0;
  SparseCholesky cholesky_;
};

}  // namespace formwright
