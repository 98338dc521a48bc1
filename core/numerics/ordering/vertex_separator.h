// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Vertex separators: few vertices whose removal splits a graph into two parts of similar weight.
// Fiduccia, Mattheyses 1982 in the form for vertex separators (Ashcraft, Liu 1997; Karypis, Kumar 1998).
#include <array>
#include <cstdint>
#include <vector>

#include "numerics/ordering/graph.h"

namespace formwright {

/// Where a vertex is. `outside` vertices take no part: they belong to separators found earlier.
enum class Side : std::uint8_t { left = 0, right = 1, separator = 2, outside = 3 };

/// What a separation costs a factorisation, up to a factor: W_2 (1 + 0.38 d^2), d = (W_0 - W_1) / W. In two
/// dimensions the work on a part grows as n^1.5, so an uneven split raises the work below it by the bracket.
/// Infinite if a side is empty.
double separator_score(const std::array<std::int64_t, 3>& weight);

/// Weights by Side; `outside` is left out.
std::array<std::int64_t, 3> separation_weights(const Graph& graph, const std::vector<Side>& side);

struct SeparatorOptions {
  double side_max = 0.7;  // largest allowed weight of one side, of the whole
  int passes = 8;         // of refinement, at most
  int patience = 120;     // moves without improvement before a pass ends
};

/// Improves separators by moving vertices out of them, one at a time, pulling their neighbours on the
/// other side in. The arrays are as long as the graph, but a call touches only what is in play, so that
/// parts of one graph that are not adjacent may be worked on by several threads.
class SeparatorRefinement {
 public:
  explicit SeparatorRefinement(const Graph& graph);

  std::vector<Side> side;  // of every vertex; set by the caller

  struct State {
    std::vector<int> separator;            // its vertices, in no order
    std::array<std::int64_t, 3> weight{};  // by Side
  };

  /// Starts from `seed` with everything else (`vertices`, now on the right) and grows the left side until it
  /// is as heavy as the right one.
  void grow(int seed, const std::vector<int>& vertices, State& state);

  /// Lowers the separator's weight until no pass improves it.
  void refine(State& state, const SeparatorOptions& options);

 private:
  struct Move {
    int vertex;
    Side to;
    int pulled_begin;  // where the vertices it pulled in begin
  };
  struct Queue;
  struct Pass;

  std::array<std::vector<int>, 2> pull_;   // of separator vertices: weight of the neighbours on either side
  std::array<std::vector<int>, 2> place_;  // in the queue towards either side; -1: not in it, -2: moved already
  const Graph& graph_;
};

}  // namespace formwright
