// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Numerical factorisation by the multifrontal method: Duff, Reid 1983; Liu 1992 "The multifrontal method
// for sparse matrix solution: theory and practice".
#include <cstdint>
#include <memory>
#include <vector>

#include "base/context.h"
#include "numerics/sparse/supernodes.h"

namespace formwright {

/// Where the entries of A go in the storage of L: for supernode s, entries [first[s], first[s + 1]).
struct AssemblyMap {
  std::vector<std::size_t> first;
  std::vector<int> source;            // into A's values
  std::vector<std::uint32_t> target;  // into the supernode's storage

  std::size_t bytes() const { return first.capacity() * 8 + (source.capacity() + target.capacity()) * 4; }
};

/// `graph` must have come from `lower`.
AssemblyMap map_assembly(const SparseMatrix& lower, const Graph& graph, const SupernodalForm& form);

/// L, supernode by supernode as SupernodalForm describes.
struct SupernodalFactor {
  std::unique_ptr<double[]> value;  // form.first_value.back() of them
};

struct MultifrontalOptions {
  bool parallel = true;
};

/// Factors the matrix of these values and diagonal (both of A, in its own order). With `parallel` it uses all
/// threads; the result does not depend on their number.
/// Throws Error: could_not_solve (not positive definite), cancelled, out_of_memory.
void factorize_multifrontal(const SupernodalForm& form, const AssemblyMap& map, const double* values,
                            const std::vector<double>& diagonal, SupernodalFactor& factor,
                            const MultifrontalOptions& options, Context& context);

}  // namespace formwright
