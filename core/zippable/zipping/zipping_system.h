// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The cloth with its seams as one system: energy, gradient, and Newton's iteration with a line search on a sparse
// Cholesky factor whose pattern is analysed once, with all seams that will ever close.
#include <vector>

#include "numerics/sparse/sparse_cholesky.h"
#include "zippable/zipping/cloth_energy.h"
#include "zippable/zipping/ribbon_pattern.h"

namespace formwright {

/// A thread that draws two places together: it pulls where they are farther apart than it is long.
struct SeamThread {
  double stiffness_n_per_mm = 0;
  double length_mm = -1;  // negative: not there yet
};

struct ZippingEnergies {
  double stretch_mj = 0, bending_mj = 0, seam_mj = 0;
  double inner_mj() const { return stretch_mj + bending_mj + seam_mj; }
};

/// Half `stiffness` times the square of what `difference` is longer than `length_mm`; gradient and positive
/// semidefinite Hessian by the first place, those by the second are their opposites.
double thread_energy_mj(const SeamThread& thread, const Vec3& difference);
Vec3 thread_gradient_n(const SeamThread& thread, const Vec3& difference, Eigen::Matrix3d* hessian_n_per_mm);

/// n x 3, in N: a pressure along the outside of the triangles that `under_pressure` marks.
Positions pressure_force_n(const Triangles& F, const Positions& x, const std::vector<char>& under_pressure,
                           double pressure_mpa);

/// Takes from `force_n` what would move or turn the whole: pressure on cloth with openings is a rocket, and a maker's
/// hands hold it. `area`: n, weights.
void balance(Positions& force_n, const Positions& x, const Eigen::VectorXd& area);

class ZippingSystem {
 public:
  /// Finds the pattern and analyses it. Throws Error: cancelled, out_of_memory.
  ZippingSystem(const RibbonPattern& pattern, const ClothMaterial& material, Context& context);

  /// Two vertices that a thread may draw together.
  struct Pair {
    int left = 0, right = 0;
    double length_mm = 0;  // of the edge that it stands for
  };
  std::vector<SeamThread> threads;  // one a pair
  /// The pattern's seams, in their order, then its closures.
  const std::vector<Pair>& pairs() const { return pairs_; }
  Positions outer_force_n;      // n x 3, held while minimising
  Positions anchor_mm;          // n x 3; every vertex is drawn back to it weakly, which settles what nothing else does
  double anchor_n_per_mm3 = 0;  // that pull, for an area and a distance
  /// Newton's method with the whole Hessian where that is positive definite, as it is near a shape at rest: a few steps
  /// there instead of hundreds.
  bool whole_hessian = false;

  ZippingEnergies energies(const Positions& x) const;
  /// Everything that is minimised: energies, anchors, outer force.
  double objective_mj(const Positions& x) const;
  /// Gradient of the objective, n x 3.
  Positions gradient_n(const Positions& x) const;

  struct Progress {
    int iterations = 0;
    double decrement_mj = 0;  // what the last step promised, twice
    bool settled = false;     // it promised less than asked for
  };
  /// Newton steps from `x`, which only ever lower the objective. Throws Error: cancelled, could_not_solve.
  Progress minimise(Positions& x, int iterations_max, double decrement_mj, Context& context);

  const std::vector<ClothTriangle>& triangles() const { return triangles_; }
  const std::vector<ClothHinge>& hinges() const { return hinges_; }
  const Eigen::VectorXd& vertex_area_mm2() const { return area_; }
  int iterations() const { return iterations_; }
  /// Lower triangle as last assembled, for benchmarks.
  const SparseMatrix& lower_hessian() const { return lower_; }

 private:
  struct Slot {
    int low, place;  // block column; -1: on the diagonal, else the block's place below it
    bool transposed;
  };
  Slot slot(int i, int j) const;
  void add_block(const Slot& slot, const Eigen::Matrix3d& block);
  void add_diagonal(const Slot& slot, double value);
  void assemble(const Positions& x, Positions& gradient, bool whole);
  /// Leaves a factor of a positive definite matrix.
  void factorize(const Positions& x, Positions& gradient, Context& context);

  std::vector<Pair> pairs_;
  ClothMaterial material_;
  std::vector<ClothTriangle> triangles_;
  std::vector<ClothHinge> hinges_;
  Eigen::VectorXd area_;
  std::vector<std::vector<int>> below_;  // per block column, the rows below the diagonal, ascending
  std::vector<Slot> triangle_slots_, seam_slots_;
  std::vector<StretchTerms> terms_;
  SparseMatrix lower_;
  std::vector<double> bending_;  // constant part of the matrix
  SparseCholesky cholesky_;
  int iterations_ = 0;
  int cautious_ = 0;  // steps for which the whole Hessian is not tried
};

}  // namespace formwright
