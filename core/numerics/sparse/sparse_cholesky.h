// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Sparse Cholesky factorisation P A P^T = L L^T, supernodal, the same code natively and in WASM.
// Davis 2006 "Direct Methods for Sparse Linear Systems"; Chen, Davis, Hager, Rajamanickam 2008.
#include <memory>
#include <vector>

#include "base/context.h"
#include "geometry/mesh/triangle_mesh.h"
#include "numerics/sparse_matrix.h"

namespace formwright {

struct SparseVector {
  std::vector<int> index;     // ascending
  std::vector<double> value;  // same length
};

class SparseCholesky {
 public:
  SparseCholesky();
  ~SparseCholesky();
  SparseCholesky(SparseCholesky&&) noexcept;
  SparseCholesky& operator=(SparseCholesky&&) noexcept;

  /// Orders the rows and finds the pattern of L. `lower` is the lower triangle (diagonal included) of a
  /// symmetric n x n matrix; only its pattern is read. `positions` (n x 3, or empty) are where the
  /// unknowns lie in space: a hint that makes nested dissection fast.
  /// Throws Error: invalid_input (not square, upper entries), cancelled, out_of_memory.
  void analyze(const SparseMatrix& lower, const Positions& positions, Context& context);

  /// Computes L for values on the analysed pattern (the diagonal must be stored). May be repeated.
  /// Throws Error: could_not_solve (not positive definite), cancelled, out_of_memory.
  void factorize(const SparseMatrix& lower, Context& context);

  /// x = A^-1 b for every column, in place. Needs factorize.
  void solve(Eigen::Ref<Eigen::MatrixXd> b) const;

  /// y = L^-1 P b for a sparse b, following its elimination-tree path only; indices in elimination order.
  /// May be called from several threads at once.
  SparseVector forward(const SparseVector& b) const;

  /// The same for many right-hand sides together: much faster than one by one, because the paths meet
  /// near the root of the tree and L is read once for a block of them. Uses all threads.
  std::vector<SparseVector> forward(const std::vector<SparseVector>& b) const;

  /// x = P^T L^-T y, in place: y in elimination order, x in the caller's order.
  void backward(Eigen::Ref<Eigen::VectorXd> y) const;

  /// y = L^-1 P b, dense, in place.
  void forward(Eigen::Ref<Eigen::VectorXd> b) const;

  int size() const;
  double factor_entries() const;  // stored entries of L, supernodal padding included
  double factor_flops() const;
  double memory_mb() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace formwright
