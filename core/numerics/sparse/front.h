// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// One step of the multifrontal method: assemble a supernode, factor it, form its update matrix.
#include <atomic>
#include <vector>

#include "base/context.h"
#include "numerics/sparse/multifrontal.h"

namespace formwright {

/// A full lower triangle, column-major with `stride` rows; what a supernode subtracts from its ancestors.
struct UpdateMatrix {
  double* value = nullptr;
  int size = 0;  // rows below the supernode; the stride is padded(size)
};

/// Working memory of one thread.
struct FrontScratch {
  std::vector<int> target;  // row of L -> padded row of the current front
  std::vector<double> packed;
  std::vector<double> minimum;
  struct Run {
    int from, to, length;
  };
  std::vector<Run> runs;  // of consecutive rows of a child that stay consecutive in its parent
};

class FrontFactorization {
 public:
  FrontFactorization(const SupernodalForm& form, const AssemblyMap& map, const double* values,
                     const std::vector<double>& min_pivot, double* factor, Context& context)
      : form_(form), map_(map), values_(values), min_pivot_(min_pivot), factor_(factor), context_(context) {}

  /// Factors supernode `s`. `children` are the update matrices of its children, in a fixed order, with their
  /// supernodes; `update` has room for this one's. With `parallel`, large steps use all threads.
  /// Returns the first column that is not positive definite, or -1.
  struct Child {
    int supernode;
    UpdateMatrix update;
  };
  int run(int s, const std::vector<Child>& children, const UpdateMatrix& update, bool parallel,
          FrontScratch& scratch) const;

 private:
  void assemble(int s, const std::vector<Child>& children, const UpdateMatrix& update, bool parallel,
                FrontScratch& scratch) const;
  void add_child(int s, const Child& child, const UpdateMatrix& update, bool parallel, FrontScratch& scratch) const;
  void eliminate_block(int s, int block, const UpdateMatrix& update, bool fresh, bool parallel,
                       FrontScratch& scratch) const;

  const SupernodalForm& form_;
  const AssemblyMap& map_;
  const double* values_;
  const std::vector<double>& min_pivot_;
  double* factor_;
  Context& context_;
};

}  // namespace formwright
