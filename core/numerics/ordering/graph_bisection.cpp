// SPDX-License-Identifier: GPL-3.0-or-later
#include "numerics/ordering/graph_bisection.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "base/parallel.h"
#include "numerics/ordering/separator_flow.h"

namespace formwright {
namespace {

constexpr double min_shrinking = 0.92;  // merging ends when a level keeps more than this part of the vertices
constexpr int flow_size_max = 20000;    // above, a maximum flow costs more than it saves

// Own generator: the standard's distributions differ between libraries, and orders must not.
class Random {
 public:
  explicit Random(unsigned seed) : state_(0x9e3779b97f4a7c15ull * (seed + 1ull)) {}
  int below(int count) {
    state_ ^= state_ << 13;
    state_ ^= state_ >> 7;
    state_ ^= state_ << 17;
    return static_cast<int>((state_ >> 33) % static_cast<std::uint64_t>(count));
  }

 private:
  std::uint64_t state_;
};

struct Level {
  Graph graph;
  std::vector<int> image;  // of the finer graph's vertices
};

// Merges every vertex with the free neighbour that it holds most edges with, of those the lightest one.
std::vector<int> match(const Graph& graph, int weight_max, Random& random, int& merged) {
  const int n = graph.size();
  std::vector<int> order(n), image(n, -1);
  std::iota(order.begin(), order.end(), 0);
  for (int k = n - 1; k > 0; --k) std::swap(order[k], order[random.below(k + 1)]);
  merged = 0;
  for (const int v : order) {
    if (image[v] != -1) continue;
    int best = -1, best_edge = 0, best_weight = 0;
    for (std::size_t e = graph.start[v]; e < graph.start[v + 1]; ++e) {
      const int u = graph.neighbour[e];
      if (image[u] != -1 || graph.weight_of(v) + graph.weight_of(u) > weight_max) continue;
      const int edge = graph.edge_weight_of(e), weight = graph.weight_of(u);
      if (best == -1 || edge > best_edge || (edge == best_edge && weight < best_weight)) {
        best = u;
        best_edge = edge;
        best_weight = weight;
      }
    }
    image[v] = merged;
    if (best != -1) image[best] = merged;
    ++merged;
  }
  return image;
}

Graph merge(const Graph& fine, const std::vector<int>& image, int count) {
  std::vector<std::pair<int, int>> members(count, {-1, -1});
  for (int v = 0; v < fine.size(); ++v) {
    auto& [first, second] = members[image[v]];
    (first == -1 ? first : second) = v;
  }
  Graph coarse;
  coarse.start.reserve(count + 1);
  coarse.start.push_back(0);
  coarse.weight.resize(count);
  coarse.neighbour.reserve(fine.neighbour.size() / 2);
  coarse.edge_weight.reserve(fine.neighbour.size() / 2);
  constexpr std::size_t nowhere = std::numeric_limits<std::size_t>::max();
  std::vector<std::size_t> slot(count, nowhere);
  for (int c = 0; c < count; ++c) {
    const std::size_t begin = coarse.neighbour.size();
    coarse.weight[c] = 0;
    for (const int v : {members[c].first, members[c].second}) {
      if (v == -1) continue;
      coarse.weight[c] += fine.weight_of(v);
      for (std::size_t e = fine.start[v]; e < fine.start[v + 1]; ++e) {
        const int d = image[fine.neighbour[e]];
        if (d == c) continue;
        if (slot[d] == nowhere || slot[d] < begin) {
          slot[d] = coarse.neighbour.size();
          coarse.neighbour.push_back(d);
          coarse.edge_weight.push_back(0);
        }
        coarse.edge_weight[slot[d]] += fine.edge_weight_of(e);
      }
    }
    coarse.start.push_back(coarse.neighbour.size());
  }
  return coarse;
}

std::vector<Level> coarsen(const Graph& graph, const BisectionOptions& options, Random& random) {
  std::int64_t total = 0;
  for (int v = 0; v < graph.size(); ++v) total += graph.weight_of(v);
  // Vertices much heavier than the others could not be moved to balance the sides.
  const int weight_max = static_cast<int>(std::max<std::int64_t>(2, 3 * total / (2 * options.coarsest_size)));
  std::vector<Level> levels;
  const Graph* finest = &graph;
  while (finest->size() > options.coarsest_size) {
    int count = 0;
    std::vector<int> image = match(*finest, weight_max, random, count);
    if (count > min_shrinking * finest->size()) break;
    Graph coarse = merge(*finest, image, count);
    levels.push_back({std::move(coarse), std::move(image)});
    finest = &levels.back().graph;
  }
  return levels;
}

SeparatorRefinement::State state_of(const Graph& graph, const std::vector<Side>& side) {
  SeparatorRefinement::State state;
  state.weight = separation_weights(graph, side);
  for (int v = 0; v < graph.size(); ++v) {
    if (side[v] == Side::separator) state.separator.push_back(v);
  }
  return state;
}

double improve(const Graph& graph, SeparatorRefinement& refinement, SeparatorRefinement::State& state,
               const SeparatorOptions& options) {
  refinement.refine(state, options);
  if (graph.size() <= flow_size_max &&
      improve_by_flow(graph, refinement.side, {.layers = 6, .side_max = options.side_max})) {
    state = state_of(graph, refinement.side);
    refinement.refine(state, options);
  }
  return separator_score(state.weight);
}

double split_coarsest(const Graph& graph, const BisectionOptions& options, Random& random,
                      std::vector<Side>& best_side) {
  std::vector<int> vertices(graph.size());
  std::iota(vertices.begin(), vertices.end(), 0);
  SeparatorRefinement refinement(graph);
  double best = std::numeric_limits<double>::infinity();
  best_side.assign(graph.size(), Side::left);
  for (int k = 0; k < options.starts; ++k) {
    SeparatorRefinement::State state;
    refinement.grow(random.below(graph.size()), vertices, state);
    const double score = improve(graph, refinement, state, options.separator);
    if (score < best) {
      best = score;
      best_side = refinement.side;
    }
  }
  return best;
}

double attempt(const Graph& graph, const BisectionOptions& options, unsigned seed, std::vector<Side>& side) {
  Random random(seed);
  const std::vector<Level> levels = coarsen(graph, options, random);
  double score = split_coarsest(levels.empty() ? graph : levels.back().graph, options, random, side);
  for (std::size_t k = levels.size(); k-- > 0;) {
    const Graph& fine = k == 0 ? graph : levels[k - 1].graph;
    SeparatorRefinement refinement(fine);
    for (int v = 0; v < fine.size(); ++v) refinement.side[v] = side[levels[k].image[v]];
    SeparatorRefinement::State state = state_of(fine, refinement.side);
    score = improve(fine, refinement, state, options.separator);
    side = std::move(refinement.side);
  }
  return score;
}

}  // namespace

std::vector<Side> bisect(const Graph& graph, const BisectionOptions& options, unsigned seed) {
  const auto attempts = static_cast<std::size_t>(std::max(1, options.attempts));
  std::vector<std::vector<Side>> side(attempts);
  std::vector<double> score(attempts, std::numeric_limits<double>::infinity());
  if (graph.size() == 0) return {};
  parallel_for(attempts, options.parallel ? 1 : attempts, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      score[k] = attempt(graph, options, static_cast<unsigned>(attempts * seed + k), side[k]);
    }
  });
  const auto best = static_cast<std::size_t>(std::min_element(score.begin(), score.end()) - score.begin());
  if (score[best] == std::numeric_limits<double>::infinity()) side[best].assign(graph.size(), Side::left);
  return side[best];
}

}  // namespace formwright
