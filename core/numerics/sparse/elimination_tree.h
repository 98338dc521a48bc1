// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The elimination tree of a symmetric matrix and what follows from it without forming L.
// Liu 1990 "The role of elimination trees in sparse factorization"; Gilbert, Ng, Peyton 1994 "An
// efficient algorithm to compute row and column counts for sparse Cholesky factorization".
#include <vector>

#include "numerics/ordering/graph.h"

namespace formwright {

/// An elimination order in both directions.
struct Permutation {
  std::vector<int> order;     // k-th eliminated -> row of the matrix
  std::vector<int> position;  // row of the matrix -> place in the elimination

  static Permutation from_order(std::vector<int> order);
};

/// parent[k] = the first row below the diagonal in column k of L, -1 for roots.
std::vector<int> elimination_tree(const Graph& graph, const Permutation& permutation);

/// Children before parents; the nodes of every subtree stand together.
std::vector<int> postorder(const std::vector<int>& parent);

/// Relabels everything so that the elimination follows `post`, which changes neither L's size nor the tree's form.
void reorder(const std::vector<int>& post, Permutation& permutation, std::vector<int>& parent);

/// Entries of every column of L, the diagonal included. The elimination must follow a postorder.
std::vector<int> column_counts(const Graph& graph, const Permutation& permutation, const std::vector<int>& parent);

}  // namespace formwright
