// SPDX-License-Identifier: GPL-3.0-or-later
#include "numerics/ordering/nested_dissection.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/parallel.h"
#include "numerics/ordering/graph_bisection.h"
#include "numerics/ordering/minimum_degree.h"
#include "numerics/ordering/vertex_separator.h"

namespace formwright {
namespace {

// A set of vertices still to be ordered. Its quotient graph, of patches of a few vertices, is cut out of the
// quotient graph of the part it came from, so that only the surroundings of separators are ever looked at
// vertex by vertex.
struct Part {
  Graph quotient;
  std::vector<int> first_member;  // per patch, into members; one more at the end
  std::vector<int> members;
  int place = 0;  // in the order, of the part's first vertex
  unsigned seed = 1;

  int size() const { return static_cast<int>(members.size()); }
};

constexpr int patch_size = 6;  // vertices

// Grows patches around seeds out of the neighbours that share most neighbours with the seed: in the square of
// a mesh's graph those are the nearest ones.
std::vector<int> make_patches(const Graph& graph, const std::vector<int>& vertices, int& patches) {
  const int n = graph.size();
  std::vector<int> patch(n, -1), size, mark(n, -1), eligible(n, 0);
  for (const int v : vertices) eligible[v] = 1;
  std::vector<std::pair<int, int>> candidates;
  for (const int v : vertices) {
    if (patch[v] != -1) continue;
    candidates.clear();
    for (const int u : graph.neighbours(v)) mark[u] = v;
    for (const int u : graph.neighbours(v)) {
      if (!eligible[u] || patch[u] != -1) continue;
      int common = 0;
      for (const int x : graph.neighbours(u)) common += mark[x] == v ? 1 : 0;
      candidates.emplace_back(-common, u);
    }
    if (candidates.size() < 2) {  // hemmed in: join a patch nearby
      int best = -1;
      for (const int u : graph.neighbours(v)) {
        if (eligible[u] && patch[u] != -1 && size[patch[u]] < 2 * patch_size &&
            (best == -1 || size[patch[u]] < size[best]))
          best = patch[u];
      }
      if (best != -1) {
        patch[v] = best;
        ++size[best];
        continue;
      }
    }
    const std::size_t taken = std::min<std::size_t>(candidates.size(), patch_size - 1);
    std::partial_sort(candidates.begin(), candidates.begin() + static_cast<std::ptrdiff_t>(taken), candidates.end());
    patch[v] = static_cast<int>(size.size());
    for (std::size_t k = 0; k < taken; ++k) patch[candidates[k].second] = patch[v];
    size.push_back(static_cast<int>(taken) + 1);
  }
  patches = static_cast<int>(size.size());
  return patch;
}

Part whole_part(const Graph& graph, const std::vector<int>& vertices) {
  Part part;
  int patches = 0;
  const std::vector<int> patch = make_patches(graph, vertices, patches);
  part.first_member.assign(patches + 1, 0);
  for (const int v : vertices) ++part.first_member[patch[v] + 1];
  for (int c = 0; c < patches; ++c) part.first_member[c + 1] += part.first_member[c];
  part.members.resize(vertices.size());
  std::vector<int> next(part.first_member.begin(), part.first_member.end() - 1);
  for (const int v : vertices) part.members[next[patch[v]]++] = v;
  Graph& quotient = part.quotient;
  quotient.start.assign(1, 0);
  quotient.weight.resize(patches);
  std::vector<int> slot(patches, -1);
  for (int c = 0; c < patches; ++c) {
    const int begin = static_cast<int>(quotient.neighbour.size());
    quotient.weight[c] = part.first_member[c + 1] - part.first_member[c];
    for (int m = part.first_member[c]; m < part.first_member[c + 1]; ++m) {
      for (const int u : graph.neighbours(part.members[m])) {
        const int d = patch[u];
        if (d == c || d == -1) continue;
        if (slot[d] < begin) {
          slot[d] = static_cast<int>(quotient.neighbour.size());
          quotient.neighbour.push_back(d);
          quotient.edge_weight.push_back(1);
        } else {
          ++quotient.edge_weight[slot[d]];
        }
      }
    }
    quotient.start.push_back(quotient.neighbour.size());
  }
  return part;
}

class Dissection {
 public:
  Dissection(const Graph& graph, const NestedDissectionOptions& options, Context& context)
      : graph_(graph), options_(options), context_(context), refinement_(graph), order_(graph.size()) {}

  std::vector<int> run();

 private:
  bool is_leaf(const Part& part) const { return part.size() <= options_.leaf_size; }
  std::vector<Part> split(Part& part, bool parallel);
  Part child(const Part& part, Side which, int place, unsigned seed) const;
  void order_leaf(const Part& part, std::vector<int>& local);
  void order_below(Part part, std::vector<int>& local);

  const Graph& graph_;
  const NestedDissectionOptions& options_;
  Context& context_;
  SeparatorRefinement refinement_;
  std::vector<int> order_;
};

Part Dissection::child(const Part& part, Side which, int place, unsigned seed) const {
  Part result;
  result.place = place;
  result.seed = seed;
  const int patches = part.quotient.size();
  std::vector<int> image(patches, -1);
  result.first_member.assign(1, 0);
  for (int c = 0; c < patches; ++c) {
    for (int m = part.first_member[c]; m < part.first_member[c + 1]; ++m) {
      if (refinement_.side[part.members[m]] == which) result.members.push_back(part.members[m]);
    }
    const int count = static_cast<int>(result.members.size()) - result.first_member.back();
    if (count == 0) continue;
    image[c] = static_cast<int>(result.quotient.weight.size());
    result.quotient.weight.push_back(count);
    result.first_member.push_back(static_cast<int>(result.members.size()));
  }
  Graph& quotient = result.quotient;
  quotient.start.assign(1, 0);
  for (int c = 0; c < patches; ++c) {
    if (image[c] == -1) continue;
    for (std::size_t e = part.quotient.start[c]; e < part.quotient.start[c + 1]; ++e) {
      const int d = image[part.quotient.neighbour[e]];
      if (d == -1) continue;
      quotient.neighbour.push_back(d);
      quotient.edge_weight.push_back(part.quotient.edge_weight[e]);
    }
    quotient.start.push_back(quotient.neighbour.size());
  }
  return result;
}

// Orders a separator and returns the two sides, or orders everything and returns nothing.
std::vector<Part> Dissection::split(Part& part, bool parallel) {
  BisectionOptions options;
  options.parallel = parallel;
  const std::vector<Side> coarse = bisect(part.quotient, options, part.seed);
  SeparatorRefinement::State state;
  for (int c = 0; c < part.quotient.size(); ++c) {
    for (int m = part.first_member[c]; m < part.first_member[c + 1]; ++m) {
      const int v = part.members[m];
      refinement_.side[v] = coarse[c];
      ++state.weight[static_cast<int>(coarse[c])];
      if (coarse[c] == Side::separator) state.separator.push_back(v);
    }
  }
  refinement_.refine(state, options.separator);
  if (state.weight[0] == 0 || state.weight[1] == 0) return {};
  const int left = static_cast<int>(state.weight[0]), right = static_cast<int>(state.weight[1]);
  std::vector<Part> parts;
  parts.push_back(child(part, Side::left, part.place, 2 * part.seed));
  parts.push_back(child(part, Side::right, part.place + left, 2 * part.seed + 1));
  int place = part.place + left + right;
  for (const int v : state.separator) {
    refinement_.side[v] = Side::outside;
    order_[place++] = v;
  }
  return parts;
}

void Dissection::order_leaf(const Part& part, std::vector<int>& local) {
  Graph graph;
  std::vector<int> vertices = part.members;
  const int inner = part.size();
  for (int k = 0; k < inner; ++k) local[vertices[k]] = k;
  graph.start.assign(1, 0);
  for (int k = 0; k < inner; ++k) {
    for (const int u : graph_.neighbours(vertices[k])) {
      if (local[u] == -1) {
        local[u] = static_cast<int>(vertices.size());
        vertices.push_back(u);
      }
      graph.neighbour.push_back(local[u]);
    }
    graph.start.push_back(graph.neighbour.size());
  }
  // The halo's edges to the inside, the transpose of what was just found.
  const int halo = static_cast<int>(vertices.size()) - inner;
  std::vector<std::size_t> next(halo + 1, 0);
  const std::size_t inside = graph.neighbour.size();
  for (std::size_t k = 0; k < inside; ++k) {
    if (graph.neighbour[k] >= inner) ++next[graph.neighbour[k] - inner + 1];
  }
  next[0] = inside;
  for (int h = 0; h < halo; ++h) {
    next[h + 1] += next[h];
    graph.start.push_back(next[h + 1]);
  }
  graph.neighbour.resize(graph.start.back());
  for (int k = 0; k < inner; ++k) {
    for (std::size_t q = graph.start[k]; q < graph.start[k + 1]; ++q) {
      const int u = graph.neighbour[q];
      if (u >= inner) graph.neighbour[next[u - inner]++] = k;
    }
  }
  for (const int v : vertices) local[v] = -1;
  int place = part.place;
  for (const int k : minimum_degree(graph, inner)) order_[place++] = vertices[k];
}

void Dissection::order_below(Part part, std::vector<int>& local) {
  std::vector<Part> waiting;
  waiting.push_back(std::move(part));
  while (!waiting.empty()) {
    context_.check_cancelled();
    Part current = std::move(waiting.back());
    waiting.pop_back();
    std::vector<Part> parts;
    if (!is_leaf(current)) parts = split(current, false);
    if (parts.empty()) order_leaf(current, local);
    for (auto& p : parts) waiting.push_back(std::move(p));
  }
}

std::vector<int> Dissection::run() {
  const int n = graph_.size();
  // Rows that are almost full go last; they would tie everything together.
  const double dense = std::max(64.0, 10 * std::sqrt(static_cast<double>(n)));
  std::vector<int> vertices;
  vertices.reserve(n);
  int last = n;
  for (int v = n - 1; v >= 0; --v) {
    if (static_cast<double>(graph_.neighbours(v).size()) > dense) {
      order_[--last] = v;
      refinement_.side[v] = Side::outside;
    }
  }
  for (int v = 0; v < n; ++v) {
    if (refinement_.side[v] != Side::outside) vertices.push_back(v);
  }
  if (vertices.empty()) return std::move(order_);
  // Breadth first while the parts are large, so that every step has work for all threads; then depth first.
  std::vector<Part> parts(1);
  parts[0] = whole_part(graph_, vertices);
  const int large = std::max(options_.leaf_size, n / 12);
  std::vector<Part> small;
  while (!parts.empty()) {
    std::vector<std::vector<Part>> halves(parts.size());
    parallel_for(parts.size(), options_.parallel ? 1 : parts.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        context_.check_cancelled();
        if (parts[k].size() > large) halves[k] = split(parts[k], options_.parallel && parts.size() == 1);
      }
    });
    std::vector<Part> next;
    for (std::size_t k = 0; k < parts.size(); ++k) {
      if (halves[k].empty()) small.push_back(std::move(parts[k]));
      for (auto& half : halves[k]) next.push_back(std::move(half));
    }
    parts = std::move(next);
  }
  std::sort(small.begin(), small.end(), [](const Part& a, const Part& b) {
    return a.size() != b.size() ? a.size() > b.size() : a.place < b.place;
  });
  parallel_for(small.size(), options_.parallel ? 1 : small.size(), [&](std::size_t begin, std::size_t end) {
    std::vector<int> local(n, -1);
    for (std::size_t k = begin; k < end; ++k) order_below(std::move(small[k]), local);
  });
  return std::move(order_);
}

}  // namespace

std::vector<int> nested_dissection(const Graph& graph, const NestedDissectionOptions& options, Context& context) {
  return Dissection(graph, options, context).run();
}

}  // namespace formwright
