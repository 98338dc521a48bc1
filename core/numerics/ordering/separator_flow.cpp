// SPDX-License-Identifier: GPL-3.0-or-later
#include "numerics/ordering/separator_flow.h"

#include <algorithm>
#include <array>
#include <limits>

namespace formwright {
namespace {

constexpr int unlimited = std::numeric_limits<int>::max() / 4;

// Every vertex of the band is two nodes, 2 k (into it) and 2 k + 1 (out of it), joined by an arc that carries
// at most its weight; edges carry any amount from out to into.
class BandFlow {
 public:
  BandFlow(const Graph& graph, const std::vector<Side>& side, const SeparatorFlowOptions& options);
  bool usable() const { return usable_; }
  void maximise();
  void cut_at_source(std::vector<Side>& side);
  void cut_at_sink(std::vector<Side>& side);

 private:
  struct Arc {
    int to, capacity;
  };
  void grow_band(const std::vector<Side>& side, Side which, std::int64_t weight_max,
                 const SeparatorFlowOptions& options);
  void connect(int from, int to, int capacity);
  void build_arcs();
  bool find_levels();
  void push_along_levels();
  std::vector<char> reachable(int from, bool forward) const;
  void apply(const std::vector<char>& left_in, const std::vector<char>& left_out, std::vector<Side>& side) const;

  const Graph& graph_;
  std::vector<int> band_, local_;
  std::vector<char> is_source_, is_sink_;
  struct Raw {
    int from, to, capacity;
  };
  std::vector<Raw> raw_;
  std::vector<int> first_, arc_to_, arc_capacity_, arc_reverse_, level_, current_;
  int source_ = 0, sink_ = 0;
  bool usable_ = false;
};

BandFlow::BandFlow(const Graph& graph, const std::vector<Side>& side, const SeparatorFlowOptions& options)
    : graph_(graph), local_(graph.size(), -1) {
  std::array<std::int64_t, 4> weight{};
  for (int v = 0; v < graph.size(); ++v) {
    weight[static_cast<int>(side[v])] += graph.weight_of(v);
    if (side[v] != Side::separator) continue;
    local_[v] = static_cast<int>(band_.size());
    band_.push_back(v);
  }
  const std::size_t separators = band_.size();
  if (separators == 0) return;
  const double total = static_cast<double>(weight[0] + weight[1] + weight[2]);
  const auto minimum = static_cast<std::int64_t>((1 - options.side_max) * total);
  for (const Side which : {Side::left, Side::right}) {
    grow_band(side, which,
              std::max<std::int64_t>(weight[static_cast<int>(which)] - minimum, weight[static_cast<int>(which)] / 4),
              options);
  }
  // Terminals: band vertices next to a vertex of their own side beyond the band.
  const int count = static_cast<int>(band_.size());
  source_ = 2 * count;
  sink_ = source_ + 1;
  bool sources = false, sinks = false;
  for (int k = 0; k < count; ++k) {
    const int v = band_[k];
    connect(2 * k, 2 * k + 1, graph.weight_of(v));
    bool from_left = false, to_right = false;
    for (const int u : graph.neighbours(v)) {
      if (local_[u] != -1) {
        connect(2 * k + 1, 2 * local_[u], unlimited);
      } else if (side[u] == Side::left) {
        from_left = true;
      } else if (side[u] == Side::right) {
        to_right = true;
      }
    }
    if (from_left) connect(source_, 2 * k, unlimited);
    if (to_right) connect(2 * k + 1, sink_, unlimited);
    sources |= from_left;
    sinks |= to_right;
  }
  usable_ = sources && sinks;
  if (usable_) build_arcs();
}

void BandFlow::grow_band(const std::vector<Side>& side, Side which, std::int64_t weight_max,
                         const SeparatorFlowOptions& options) {
  std::vector<int> layer, next;
  for (int v = 0; v < graph_.size(); ++v) {
    if (side[v] == Side::separator) layer.push_back(v);
  }
  std::int64_t taken = 0;
  for (int depth = 0; depth < options.layers && !layer.empty(); ++depth) {
    next.clear();
    std::int64_t weight = 0;
    const std::size_t before = band_.size();
    for (const int v : layer) {
      for (const int u : graph_.neighbours(v)) {
        if (side[u] != which || local_[u] != -1) continue;
        local_[u] = static_cast<int>(band_.size());
        band_.push_back(u);
        next.push_back(u);
        weight += graph_.weight_of(u);
      }
    }
    if (taken + weight > weight_max) {  // the whole layer stays outside, so that the band's rim is even
      for (std::size_t k = before; k < band_.size(); ++k) local_[band_[k]] = -1;
      band_.resize(before);
      break;
    }
    taken += weight;
    layer.swap(next);
  }
}

void BandFlow::connect(int from, int to, int capacity) { raw_.push_back({from, to, capacity}); }

void BandFlow::build_arcs() {
  const int nodes = sink_ + 1;
  first_.assign(nodes + 1, 0);
  for (const auto& a : raw_) {
    ++first_[a.from + 1];
    ++first_[a.to + 1];
  }
  for (int v = 0; v < nodes; ++v) first_[v + 1] += first_[v];
  std::vector<int> next(first_.begin(), first_.end() - 1);
  arc_to_.resize(2 * raw_.size());
  arc_capacity_.resize(2 * raw_.size());
  arc_reverse_.resize(2 * raw_.size());
  for (const auto& a : raw_) {
    const int there = next[a.from]++, back = next[a.to]++;
    arc_to_[there] = a.to;
    arc_capacity_[there] = a.capacity;
    arc_reverse_[there] = back;
    arc_to_[back] = a.from;
    arc_capacity_[back] = 0;
    arc_reverse_[back] = there;
  }
  raw_ = {};
}

bool BandFlow::find_levels() {
  level_.assign(sink_ + 1, -1);
  std::vector<int> queue{source_};
  level_[source_] = 0;
  for (std::size_t k = 0; k < queue.size(); ++k) {
    const int v = queue[k];
    if (level_[sink_] != -1 && level_[v] >= level_[sink_]) break;
    for (int a = first_[v]; a < first_[v + 1]; ++a) {
      if (arc_capacity_[a] == 0 || level_[arc_to_[a]] != -1) continue;
      level_[arc_to_[a]] = level_[v] + 1;
      queue.push_back(arc_to_[a]);
    }
  }
  return level_[sink_] != -1;
}

// A blocking flow: depth first along rising levels, without recursion (paths may be thousands of arcs long).
void BandFlow::push_along_levels() {
  current_.assign(first_.begin(), first_.end() - 1);
  std::vector<int> path;  // arcs
  for (int node = source_;;) {
    if (node == sink_) {
      int amount = unlimited;
      for (const int a : path) amount = std::min(amount, arc_capacity_[a]);
      std::size_t kept = path.size();
      for (std::size_t k = path.size(); k-- > 0;) {
        arc_capacity_[path[k]] -= amount;
        arc_capacity_[arc_reverse_[path[k]]] += amount;
        if (arc_capacity_[path[k]] == 0) kept = k;
      }
      node = arc_to_[arc_reverse_[path[kept]]];  // go on from the first arc that is full now
      path.resize(kept);
      continue;
    }
    int& a = current_[node];
    while (a < first_[node + 1] && (arc_capacity_[a] == 0 || level_[arc_to_[a]] != level_[node] + 1)) ++a;
    if (a < first_[node + 1]) {
      path.push_back(a);
      node = arc_to_[a];
    } else if (node == source_) {
      return;
    } else {
      level_[node] = -1;  // a dead end
      node = arc_to_[arc_reverse_[path.back()]];
      path.pop_back();
    }
  }
}

void BandFlow::maximise() {
  while (find_levels()) push_along_levels();
}

std::vector<char> BandFlow::reachable(int from, bool forward) const {
  std::vector<char> seen(sink_ + 1, 0);
  std::vector<int> stack{from};
  seen[from] = 1;
  while (!stack.empty()) {
    const int v = stack.back();
    stack.pop_back();
    for (int a = first_[v]; a < first_[v + 1]; ++a) {
      const int to = arc_to_[a];
      const int capacity = forward ? arc_capacity_[a] : arc_capacity_[arc_reverse_[a]];
      if (capacity == 0 || seen[to]) continue;
      seen[to] = 1;
      stack.push_back(to);
    }
  }
  return seen;
}

void BandFlow::cut_at_source(std::vector<Side>& side) {
  const auto seen = reachable(source_, true);
  for (std::size_t k = 0; k < band_.size(); ++k) {
    side[band_[k]] = seen[2 * k + 1] ? Side::left : seen[2 * k] ? Side::separator : Side::right;
  }
}

void BandFlow::cut_at_sink(std::vector<Side>& side) {
  const auto seen = reachable(sink_, false);
  for (std::size_t k = 0; k < band_.size(); ++k) {
    side[band_[k]] = seen[2 * k] ? Side::right : seen[2 * k + 1] ? Side::separator : Side::left;
  }
}

}  // namespace

bool improve_by_flow(const Graph& graph, std::vector<Side>& side, const SeparatorFlowOptions& options) {
  BandFlow flow(graph, side, options);
  if (!flow.usable()) return false;
  const double before = separator_score(separation_weights(graph, side));
  flow.maximise();
  std::vector<Side> at_source = side, at_sink = side;
  flow.cut_at_source(at_source);
  flow.cut_at_sink(at_sink);
  const double score_source = separator_score(separation_weights(graph, at_source));
  const double score_sink = separator_score(separation_weights(graph, at_sink));
  if (std::min(score_source, score_sink) >= before) return false;
  side = score_source <= score_sink ? std::move(at_source) : std::move(at_sink);
  return true;
}

}  // namespace formwright
