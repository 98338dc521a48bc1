// SPDX-License-Identifier: GPL-3.0-or-later
#include "numerics/ordering/vertex_separator.h"

#include <algorithm>
#include <limits>

namespace formwright {

double separator_score(const std::array<std::int64_t, 3>& weight) {
  if (weight[0] == 0 || weight[1] == 0) return std::numeric_limits<double>::infinity();
  const double total = static_cast<double>(weight[0] + weight[1] + weight[2]);
  const double imbalance = static_cast<double>(weight[0] - weight[1]) / total;
  return static_cast<double>(weight[2]) * (1 + 0.38 * imbalance * imbalance);
}

std::array<std::int64_t, 3> separation_weights(const Graph& graph, const std::vector<Side>& side) {
  std::array<std::int64_t, 3> weight{};
  for (int v = 0; v < graph.size(); ++v) {
    if (side[v] != Side::outside) weight[static_cast<int>(side[v])] += graph.weight_of(v);
  }
  return weight;
}

// A binary heap of separator vertices, the largest gain on top.
struct SeparatorRefinement::Queue {
  struct Entry {
    int gain, vertex;
  };
  std::vector<Entry> heap;
  std::vector<int>* place = nullptr;

  bool empty() const { return heap.empty(); }
  void put(int k, Entry entry) {
    heap[k] = entry;
    (*place)[entry.vertex] = k;
  }
  void rise(int k, Entry entry) {
    for (; k > 0 && heap[(k - 1) / 2].gain < entry.gain; k = (k - 1) / 2) put(k, heap[(k - 1) / 2]);
    put(k, entry);
  }
  void sink(int k, Entry entry) {
    const int count = static_cast<int>(heap.size());
    for (int child = 2 * k + 1; child < count; child = 2 * k + 1) {
      if (child + 1 < count && heap[child + 1].gain > heap[child].gain) ++child;
      if (heap[child].gain <= entry.gain) break;
      put(k, heap[child]);
      k = child;
    }
    put(k, entry);
  }
  void push(int vertex, int gain) {
    heap.push_back({});
    rise(static_cast<int>(heap.size()) - 1, {gain, vertex});
  }
  void change(int vertex, int difference) {
    const int k = (*place)[vertex];
    if (k < 0) return;
    const Entry entry{heap[k].gain + difference, vertex};
    if (difference > 0) {
      rise(k, entry);
    } else {
      sink(k, entry);
    }
  }
  void remove(int vertex, int mark) {
    const int k = (*place)[vertex];
    (*place)[vertex] = mark;
    if (k < 0) return;
    const Entry last = heap.back();
    heap.pop_back();
    if (last.vertex == vertex) return;
    if (k > 0 && heap[(k - 1) / 2].gain < last.gain) {
      rise(k, last);
    } else {
      sink(k, last);
    }
  }
};

// One sweep of moves with everything needed to take them back.
struct SeparatorRefinement::Pass {
  SeparatorRefinement& owner;
  State& state;
  std::array<Queue, 2> queue;
  std::vector<Move> moves;
  std::vector<int> pulled;
  std::vector<int> touched;  // all that have been in the separator since the pass began

  Pass(SeparatorRefinement& refinement, State& current) : owner(refinement), state(current) {
    queue[0].place = &owner.place_[0];
    queue[1].place = &owner.place_[1];
  }
  ~Pass() {
    for (const int v : touched) owner.place_[0][v] = owner.place_[1][v] = -1;
  }

  void enter(int v) {
    const Graph& graph = owner.graph_;
    std::array<int, 4> pull{};
    for (const int u : graph.neighbours(v)) pull[static_cast<int>(owner.side[u])] += graph.weight_of(u);
    owner.pull_[0][v] = pull[0];
    owner.pull_[1][v] = pull[1];
    if (owner.place_[0][v] == -2) return;  // moved before in this pass
    touched.push_back(v);
    queue[0].push(v, graph.weight_of(v) - pull[1]);
    queue[1].push(v, graph.weight_of(v) - pull[0]);
  }

  void move(int v, int to) {
    const Graph& graph = owner.graph_;
    const int from = 1 - to, weight = graph.weight_of(v);
    moves.push_back({v, static_cast<Side>(to), static_cast<int>(pulled.size())});
    queue[0].remove(v, -2);
    queue[1].remove(v, -2);
    owner.side[v] = static_cast<Side>(to);
    state.weight[2] -= weight;
    state.weight[to] += weight;
    for (const int u : graph.neighbours(v)) {
      const Side where = owner.side[u];
      if (where == Side::separator) {
        owner.pull_[to][u] += weight;
        queue[from].change(u, -weight);
      } else if (where == static_cast<Side>(from)) {
        const int other = graph.weight_of(u);
        owner.side[u] = Side::separator;
        state.weight[from] -= other;
        state.weight[2] += other;
        pulled.push_back(u);
        for (const int x : graph.neighbours(u)) {
          if (owner.side[x] != Side::separator || x == u) continue;
          owner.pull_[from][x] -= other;
          queue[to].change(x, other);
        }
        enter(u);
      }
    }
  }

  void undo_to(std::size_t kept) {
    const Graph& graph = owner.graph_;
    while (moves.size() > kept) {
      const Move last = moves.back();
      moves.pop_back();
      const int to = static_cast<int>(last.to), from = 1 - to;
      while (static_cast<int>(pulled.size()) > last.pulled_begin) {
        const int u = pulled.back();
        pulled.pop_back();
        owner.side[u] = static_cast<Side>(from);
        state.weight[from] += graph.weight_of(u);
        state.weight[2] -= graph.weight_of(u);
      }
      owner.side[last.vertex] = Side::separator;
      state.weight[to] -= graph.weight_of(last.vertex);
      state.weight[2] += graph.weight_of(last.vertex);
    }
  }

  // Every vertex that is in the separator now has entered it once.
  void collect() {
    state.separator.clear();
    for (const int v : touched) {
      if (owner.side[v] == Side::separator) state.separator.push_back(v);
    }
  }
};

SeparatorRefinement::SeparatorRefinement(const Graph& graph) : side(graph.size(), Side::left), graph_(graph) {
  for (int k = 0; k < 2; ++k) {
    pull_[k].assign(graph.size(), 0);
    place_[k].assign(graph.size(), -1);
  }
}

void SeparatorRefinement::grow(int seed, const std::vector<int>& vertices, State& state) {
  state.separator.assign(1, seed);
  state.weight = {0, 0, graph_.weight_of(seed)};
  for (const int v : vertices) {
    side[v] = Side::right;
    state.weight[1] += graph_.weight_of(v);
  }
  state.weight[1] -= graph_.weight_of(seed);
  side[seed] = Side::separator;
  Pass pass(*this, state);
  pass.enter(seed);
  std::size_t next = 0;
  while (state.weight[0] < state.weight[1]) {
    if (pass.queue[0].empty()) {  // a component is used up: go on in another one
      while (next < vertices.size() && side[vertices[next]] != Side::right) ++next;
      if (next == vertices.size()) break;
      const int v = vertices[next];
      side[v] = Side::separator;
      state.weight[1] -= graph_.weight_of(v);
      state.weight[2] += graph_.weight_of(v);
      pass.enter(v);
    }
    pass.move(pass.queue[0].heap.front().vertex, 0);
  }
  pass.collect();
}

void SeparatorRefinement::refine(State& state, const SeparatorOptions& options) {
  const std::int64_t total = state.weight[0] + state.weight[1] + state.weight[2];
  const auto side_max = static_cast<std::int64_t>(options.side_max * static_cast<double>(total));
  for (int k = 0; k < options.passes; ++k) {
    const double before = separator_score(state.weight);
    Pass pass(*this, state);
    for (const int v : state.separator) pass.enter(v);
    double best = before;
    std::size_t best_moves = 0;
    while (pass.moves.size() < best_moves + static_cast<std::size_t>(options.patience)) {
      int to = -1, gain = 0;
      for (const int t : {0, 1}) {
        if (pass.queue[t].empty()) continue;
        const auto top = pass.queue[t].heap.front();
        if (state.weight[t] + graph_.weight_of(top.vertex) > std::max(side_max, state.weight[1 - t])) continue;
        if (to == -1 || top.gain > gain || (top.gain == gain && state.weight[t] < state.weight[1 - t])) {
          to = t;
          gain = top.gain;
        }
      }
      if (to == -1) break;
      pass.move(pass.queue[to].heap.front().vertex, to);
      const double now = separator_score(state.weight);
      if (now < best) {
        best = now;
        best_moves = pass.moves.size();
      }
    }
    pass.undo_to(best_moves);
    pass.collect();
    if (best >= before) break;
  }
}

}  // namespace formwright
