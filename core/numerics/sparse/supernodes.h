// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The form of L: supernodes (neighbouring columns of the same pattern), their rows, and how L is stored.
// Ashcraft, Grimes 1989 "The influence of relaxed supernode partitions on the multifrontal method".
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/context.h"
#include "numerics/sparse/elimination_tree.h"

namespace formwright {

/// Rounds up to whole vectors of four doubles: rows of L are padded with zeros to that.
constexpr int padded(int rows) { return (rows + 3) & ~3; }

/// Supernode s holds the columns [first_column[s], first_column[s + 1]) and below them the rows rows_below(s).
/// Supernodes are numbered so that children come before parents, first the `subtrees`, each a contiguous
/// range that can be worked on by itself, then the top of the tree.
///
/// Storage of a supernode: its padded height is padded(columns) + padded(rows below); columns are kept in
/// blocks of `block_width`, each block a column-major matrix from its first diagonal entry downwards.
struct SupernodalForm {
  static constexpr int block_width = 128;

  struct Subtree {
    int begin, end;  // supernodes
    double flops;
  };

  int n = 0;
  Permutation permutation;
  std::vector<int> first_column;         // supernodes + 1
  std::vector<int> parent;               // supernode, -1 for roots
  std::vector<int> supernode_of;         // column -> supernode
  std::vector<std::size_t> first_row;    // supernodes + 1, into row
  std::vector<int> row;                  // ascending within a supernode, in elimination order
  std::vector<std::size_t> first_value;  // supernodes + 1: where the storage of each begins
  std::vector<Subtree> subtrees;
  int first_top = 0;              // supernodes from here on belong to no subtree
  double entries = 0, flops = 0;  // of L as stored without padding rows; additions and multiplications

  int count() const { return static_cast<int>(parent.size()); }
  int columns(int s) const { return first_column[s + 1] - first_column[s]; }
  std::span<const int> rows_below(int s) const { return {row.data() + first_row[s], first_row[s + 1] - first_row[s]}; }
  int height(int s) const { return padded(columns(s)) + padded(static_cast<int>(first_row[s + 1] - first_row[s])); }
  double flops_of(int s) const;
  std::size_t bytes() const;
};

/// Where block `b` of a supernode of the given padded height begins within the supernode's storage.
constexpr std::size_t block_offset(int block, int height) {
  const auto b = static_cast<std::size_t>(block), w = static_cast<std::size_t>(SupernodalForm::block_width);
  return b == 0 ? 0 : w * (b * static_cast<std::size_t>(height) - w * (b * (b - 1) / 2));
}

/// Finds the supernodes for an elimination `order` and refines the order accordingly (the fill stays the
/// same, but for zeros that merging small supernodes stores). `order` is any permutation of the vertices.
SupernodalForm find_supernodes(const Graph& graph, std::vector<int> order, Context& context);

}  // namespace formwright
