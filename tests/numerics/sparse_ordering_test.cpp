// SPDX-License-Identifier: GPL-3.0-or-later
// The steps before the numbers: orders, separators, elimination trees, supernodes.
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <algorithm>
#include <cmath>
#include <set>

#include "numerics/sparse/elimination_tree.h"
#include "numerics/ordering/graph_bisection.h"
#include "numerics/ordering/minimum_degree.h"
#include "numerics/ordering/nested_dissection.h"
#include "numerics/ordering/separator_flow.h"
#include "numerics/sparse_matrices.h"
#include "numerics/sparse/supernodes.h"
#include "numerics/ordering/vertex_separator.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

bool is_permutation_of(const std::vector<int>& order, int n) {
  std::vector<int> sorted = order;
  std::sort(sorted.begin(), sorted.end());
  for (int k = 0; k < static_cast<int>(sorted.size()); ++k) {
    if (sorted[k] != k) return false;
  }
  return static_cast<int>(sorted.size()) == n;
}

// Rows of every column of L below the diagonal, by elimination as on paper.
std::vector<std::set<int>> eliminate(const Graph& graph, const Permutation& permutation) {
  const int n = graph.size();
  std::vector<std::set<int>> below(n);
  for (int k = 0; k < n; ++k) {
    for (const int u : graph.neighbours(permutation.order[k])) {
      if (permutation.position[u] > k) below[k].insert(permutation.position[u]);
    }
  }
  for (int k = 0; k < n; ++k) {
    if (below[k].empty()) continue;
    const int parent = *below[k].begin();
    below[parent].insert(std::next(below[k].begin()), below[k].end());
  }
  return below;
}

double fill_of(const Graph& graph, const std::vector<int>& order) {
  Permutation permutation = Permutation::from_order(order);
  std::vector<int> parent = elimination_tree(graph, permutation);
  reorder(postorder(parent), permutation, parent);
  double entries = 0;
  for (const int count : column_counts(graph, permutation, parent)) entries += count;
  return entries;
}

Graph path_graph(int n) { return graph_of(test::grid_laplacian(n, 1, 1.0)); }

// Every vertex but the first hangs on a random earlier one.
Graph random_tree(int n, std::uint64_t seed) {
  test::MatrixRandom random(seed);
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < n; ++i) {
    entries.emplace_back(i, i, 1.0);
    if (i > 0) entries.emplace_back(i, random.below(i), 1.0);
  }
  return graph_of(test::lower_of(n, entries));
}

std::vector<Graph> zoo() {
  std::vector<Graph> graphs;
  graphs.push_back(graph_of(SparseMatrix(0, 0)));
  graphs.push_back(path_graph(1));
  graphs.push_back(path_graph(700));
  graphs.push_back(random_tree(2000, 1));
  graphs.push_back(graph_of(test::random_spd(900, 2.0, 2)));    // falls apart into many pieces
  graphs.push_back(graph_of(test::random_spd(900, 30.0, 3)));   // has no small separators
  graphs.push_back(graph_of(test::random_spd(350, 690.0, 4)));  // nearly complete
  graphs.push_back(graph_of(test::torus_bilaplacian(90, 40, 1.0)));
  std::vector<Eigen::Triplet<double>> star;
  for (int i = 0; i < 3000; ++i) star.emplace_back(i, 0, 1.0);
  star.emplace_back(0, 0, 1.0);
  for (int i = 1; i < 3000; ++i) star.emplace_back(i, i, 1.0);
  graphs.push_back(graph_of(test::lower_of(3000, star)));
  return graphs;
}

TEST_CASE("Graph.HoldsBothDirectionsInOrder") {
  const SparseMatrix A = test::random_spd(200, 9.0, 5);
  const Graph graph = graph_of(A);
  const Eigen::MatrixXd dense = test::dense_of(A);
  for (int v = 0; v < 200; ++v) {
    std::vector<int> expected;
    for (int u = 0; u < 200; ++u) {
      if (u != v && dense(u, v) != 0) expected.push_back(u);
    }
    const auto found = graph.neighbours(v);
    CHECK(std::vector<int>(found.begin(), found.end()) == expected);
  }
}

TEST_CASE("MinimumDegree.OrdersEveryGraph") {
  for (const Graph& graph : zoo()) CHECK(is_permutation_of(minimum_degree(graph, graph.size()), graph.size()));
}

TEST_CASE("MinimumDegree.FillsNothingInATree") {
  for (const int n : {1, 2, 10, 333, 2000}) {
    const Graph graph = random_tree(n, 6);
    CHECK(fill_of(graph, minimum_degree(graph, n)) == 2 * n - 1);
  }
}

TEST_CASE("MinimumDegree.CountsTheHalo") {
  // 0 - 1, and 0 also touches a halo of five: alone they tie, with the halo 1 goes first.
  Graph graph;
  graph.neighbour = {1, 2, 3, 4, 5, 6, 0, 0, 0, 0, 0, 0};
  graph.start = {0, 6, 7, 8, 9, 10, 11, 12};
  CHECK(minimum_degree(graph, 2) == std::vector<int>{1, 0});
}

TEST_CASE("MinimumDegree.OrdersOnlyTheInside") {
  const Graph graph = graph_of(test::torus_bilaplacian(20, 20, 1.0));
  CHECK(is_permutation_of(minimum_degree(graph, 250), 250));
  CHECK(minimum_degree(graph, 0).empty());
}

void expect_separated(const Graph& graph, const std::vector<Side>& side) {
  for (int v = 0; v < graph.size(); ++v) {
    for (const int u : graph.neighbours(v)) {
      INFO(v << " touches " << u);
      CHECK_FALSE((side[v] == Side::left && side[u] == Side::right));
    }
  }
}

TEST_CASE("VertexSeparator.Separates") {
  for (const Graph& graph : zoo()) {
    if (graph.size() < 2) continue;
    for (const unsigned seed : {1u, 2u, 3u}) expect_separated(graph, bisect(graph, {}, seed));
  }
}

TEST_CASE("VertexSeparator.IsNearlyTheShortestOnATorus") {
  // The matrix couples vertices two edges apart, so a cut needs rings two vertices thick, and a torus two cuts.
  const Graph graph = graph_of(test::torus_bilaplacian(120, 24, 1.0));
  const auto weight = separation_weights(graph, bisect(graph, {}, 1));
  CHECK(weight[2] >= 4 * 24);
  CHECK(static_cast<double>(weight[2]) <= 1.2 * 4 * 24);
  CHECK(std::min(weight[0], weight[1]) > 120 * 24 / 5);
}

TEST_CASE("SeparatorFlow.FindsTheLeastCutOfTheBand") {
  // A 31 x 9 grid of weight 1 with a waist: in column 12 all but the middle vertex are gone.
  const int width = 31, height = 9;
  std::vector<int> id(width * height, -1);
  int n = 0;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (x != 12 || y == 4) id[y * width + x] = n++;
    }
  }
  std::vector<Eigen::Triplet<double>> entries;
  std::vector<Side> side(n);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const int v = id[y * width + x];
      if (v == -1) continue;
      entries.emplace_back(v, v, 1.0);
      side[v] = x < 16 ? Side::left : x == 16 ? Side::separator : Side::right;
      for (const int u : {x > 0 ? id[y * width + x - 1] : -1, y > 0 ? id[(y - 1) * width + x] : -1}) {
        if (u != -1) entries.emplace_back(std::max(u, v), std::min(u, v), 1.0);
      }
    }
  }
  const Graph graph = graph_of(test::lower_of(n, entries));
  CHECK(improve_by_flow(graph, side, {.layers = 8, .side_max = 0.8}));
  expect_separated(graph, side);
  CHECK(separation_weights(graph, side)[2] == 1);
  CHECK((side[id[4 * width + 11]] == Side::separator || side[id[4 * width + 12]] == Side::separator ||
         side[id[4 * width + 13]] == Side::separator));
  CHECK_FALSE(improve_by_flow(graph, side, {.layers = 8, .side_max = 0.8}));  // nothing left to gain
}

TEST_CASE("NestedDissection.OrdersEveryGraphAlways") {
  Context context;
  for (const Graph& graph : zoo()) {
    for (const int leaf : {1, 20, 300}) {
      const std::vector<int> order = nested_dissection(graph, {.leaf_size = leaf}, context);
      CHECK(is_permutation_of(order, graph.size()));
      CHECK(order == nested_dissection(graph, {.leaf_size = leaf}, context));
    }
  }
}

TEST_CASE("NestedDissection.DoesNotDependOnTheThreads") {
  Context context;
  const Graph graph = graph_of(test::torus_bilaplacian(150, 100, 1.0));
  CHECK(nested_dissection(graph, {.parallel = true}, context) ==
        nested_dissection(graph, {.parallel = false}, context));
}

TEST_CASE("NestedDissection.StaysWithinGeorgesBoundOnGrids") {
  // George 1973: at most 31/4 n log2 n entries on an n-vertex square grid, whatever the leaves.
  Context context;
  for (const int side : {16, 32, 64, 128}) {
    const Graph graph = graph_of(test::grid_laplacian(side, side, 1.0));
    const double n = side * side;
    const double entries = fill_of(graph, nested_dissection(graph, {.leaf_size = 30}, context));
    CHECK(entries <= 7.75 * n * std::log2(n));
    CHECK(entries <= n * side);  // the banded order's fill, roughly
  }
}

TEST_CASE("NestedDissection.FillsLessThanMinimumDegreeOnLargeSurfaces") {
  Context context;
  const Graph graph = graph_of(test::torus_bilaplacian(200, 200, 1.0));
  CHECK(fill_of(graph, nested_dissection(graph, {}, context)) < fill_of(graph, minimum_degree(graph, graph.size())));
}

TEST_CASE("EliminationTree.AgreesWithElimination") {
  for (const double per_row : {0.5, 2.0, 5.0, 20.0}) {
    const Graph graph = graph_of(test::random_spd(150, per_row, 7));
    Permutation permutation = Permutation::from_order(minimum_degree(graph, graph.size()));
    std::vector<int> parent = elimination_tree(graph, permutation);
    const std::vector<int> post = postorder(parent);
    REQUIRE(is_permutation_of(post, graph.size()));
    reorder(post, permutation, parent);
    const std::vector<int> counts = column_counts(graph, permutation, parent);
    const auto below = eliminate(graph, permutation);
    for (int k = 0; k < graph.size(); ++k) {
      CHECK(counts[k] == static_cast<int>(below[k].size()) + 1);
      CHECK(parent[k] == (below[k].empty() ? -1 : *below[k].begin()));
      CHECK(permutation.position[permutation.order[k]] == k);
    }
  }
}

TEST_CASE("Supernodes.HoldEveryEntryOfL") {
  Context context;
  for (const Graph& graph : zoo()) {
    if (graph.size() > 3600) continue;
    const SupernodalForm form = find_supernodes(graph, nested_dissection(graph, {.leaf_size = 60}, context), context);
    REQUIRE(is_permutation_of(form.permutation.order, graph.size()));
    const auto below = eliminate(graph, form.permutation);
    double entries = 0, stored = 0;
    for (int s = 0; s < form.count(); ++s) {
      const auto rows = form.rows_below(s);
      CHECK(std::is_sorted(rows.begin(), rows.end()));
      CHECK(form.parent[s] == (rows.empty() ? -1 : form.supernode_of[rows[0]]));
      CHECK((form.parent[s] == -1 ? form.count() : form.parent[s]) > s);
      std::set<int> all(rows.begin(), rows.end());
      for (int k = form.first_column[s + 1] - 1; k >= form.first_column[s]; --k) {
        CHECK(form.supernode_of[k] == s);
        CHECK(std::includes(all.begin(), all.end(), below[k].begin(), below[k].end()));
        all.insert(k);
        entries += static_cast<double>(below[k].size()) + 1;
        stored += static_cast<double>(all.size());
      }
    }
    CHECK(stored == form.entries);
    // Merging must not store too many zeros; on surfaces far fewer than on paths and trees, whose L has almost nothing.
    CHECK(stored <= (graph.size() == 3600 ? 1.25 : 3.0) * entries);
  }
}

TEST_CASE("Supernodes.SubtreesAreClosed") {
  Context context;
  const Graph graph = graph_of(test::torus_bilaplacian(100, 100, 1.0));
  const SupernodalForm form = find_supernodes(graph, nested_dissection(graph, {}, context), context);
  REQUIRE(form.subtrees.size() > 4u);
  int next = 0;
  double flops = 0;
  for (const auto& subtree : form.subtrees) {
    CHECK(subtree.begin == next);
    next = subtree.end;
    for (int s = subtree.begin; s < subtree.end; ++s) {
      flops += form.flops_of(s);
      CHECK((form.parent[s] < subtree.end || form.parent[s] >= form.first_top));
    }
  }
  CHECK(next == form.first_top);
  for (int s = form.first_top; s < form.count(); ++s) flops += form.flops_of(s);
  CHECK_THAT(flops, WithinAbs(form.flops, 1e-9 * flops));
}

}  // namespace
}  // namespace formwright
