// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/strips/band_network.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "geometry/mesh/adjacency.h"

namespace formwright {
namespace {

class NetworkBuilder {
 public:
  NetworkBuilder(const Bands& bands, double sample_mm)
      : bands_(bands),
        adjacency_(bands.mesh),
        sample_mm_(sample_mm),
        chain_of_edge_(std::size_t(adjacency_.edge_count()), -1),
        forward_(std::size_t(adjacency_.edge_count()), 0),
        borders_at_(std::size_t(bands.mesh.vertex_count())) {}

  BandNetwork build() {
    for (int e = 0; e < adjacency_.edge_count(); ++e)
      if (is_border(e))
        for (const int v : {adjacency_.edges()[e].lower, adjacency_.edges()[e].higher}) borders_at_[v].push_back(e);
    for (int v = 0; v < bands_.mesh.vertex_count(); ++v)
      if (is_node(v))
        for (const int e : borders_at_[v])
          if (chain_of_edge_[e] < 0) walk(v, e);
    for (int e = 0; e < adjacency_.edge_count(); ++e)
      if (is_border(e) && chain_of_edge_[e] < 0) walk(adjacency_.edges()[e].lower, e);
    find_loops();
    return std::move(network_);
  }

 private:
  struct Chain {
    bool closed = false;
    std::vector<int> points;  // of the network, from end to end; a closed one does not repeat its first
  };

  bool is_border(int e) const {
    const auto halfedges = adjacency_.halfedges_of_edge(e);
    return halfedges.size() != 2 || bands_.band[halfedges[0] / 3] != bands_.band[halfedges[1] / 3];
  }
  bool is_node(int v) const { return !borders_at_[v].empty() && borders_at_[v].size() != 2; }
  bool divides_parts(int e) const {
    const auto halfedges = adjacency_.halfedges_of_edge(e);
    return halfedges.size() == 2 && bands_.part[halfedges[0] / 3] != bands_.part[halfedges[1] / 3];
  }
  Vec3 position(int v) const { return bands_.mesh.V.row(v).transpose(); }

  void walk(int start, int edge) {
    std::vector<int> vertices{start};
    const int number = static_cast<int>(chains_.size());
    const bool smooth = divides_parts(edge);
    Chain chain;
    for (int e = edge;;) {
      const auto [lower, higher] = adjacency_.edges()[e];
      const int from = vertices.back(), to = lower == from ? higher : lower;
      chain_of_edge_[e] = number;
      forward_[e] = lower == from;
      vertices.push_back(to);
      if (is_node(to)) break;
      if (to == start) {
        chain.closed = true;
        break;
      }
      e = borders_at_[to][0] == e ? borders_at_[to][1] : borders_at_[to][0];
    }
    sample(vertices, smooth, chain);
    chains_.push_back(std::move(chain));
  }

  int node(int v) {
    const auto [found, fresh] = nodes_.try_emplace(v, static_cast<int>(network_.points_mm.size()));
    if (fresh) network_.points_mm.push_back(position(v));
    return found->second;
  }

  void sample(const std::vector<int>& vertices, bool smooth, Chain& chain) {
    std::vector<double> along{0};
    for (std::size_t i = 0; i + 1 < vertices.size(); ++i)
      along.push_back(along.back() + (position(vertices[i + 1]) - position(vertices[i])).norm());
    const int minimum = chain.closed ? 4 : vertices.front() == vertices.back() ? 3 : 2;
    const int steps = std::max(minimum, static_cast<int>(std::lround(along.back() / sample_mm_)));
    std::vector<Vec3> points;
    for (int k = 0; k <= steps; ++k) {
      const double place = along.back() * k / steps;
      const auto next = std::clamp<std::ptrdiff_t>(std::upper_bound(along.begin(), along.end(), place) - along.begin(),
                                                   1, static_cast<std::ptrdiff_t>(along.size()) - 1);
      const double length = along[next] - along[next - 1], share = length > 0 ? (place - along[next - 1]) / length : 0;
      points.push_back(position(vertices[next - 1]) +
                       share * (position(vertices[next]) - position(vertices[next - 1])));
    }
    if (smooth && !chain.closed)
      for (int sweep = 0; sweep < 2; ++sweep) {
        const std::vector<Vec3> before = points;
        for (int k = 1; k < steps; ++k) points[k] = (before[k - 1] + 2 * before[k] + before[k + 1]) / 4;
      }
    for (int k = 0; k <= steps; ++k) {
      if (!chain.closed && (k == 0 || k == steps)) {
        chain.points.push_back(node(k == 0 ? vertices.front() : vertices.back()));
      } else if (k < steps) {
        chain.points.push_back(static_cast<int>(network_.points_mm.size()));
        network_.points_mm.push_back(points[k]);
      }
    }
  }

  void find_loops() {
    network_.loops.resize(std::size_t(bands_.band_count));
    std::vector<char> walked(std::size_t(3 * bands_.mesh.face_count()), 0);
    for (int h = 0; h < 3 * bands_.mesh.face_count(); ++h) {
      if (walked[h] || chain_of_edge_[adjacency_.edge_of(h)] < 0) continue;
      std::vector<int> ring;
      for (int g = h; !walked[g]; g = onward(g)) walked[g] = 1, ring.push_back(g);
      // From a node on, if there is one.
      const auto start = std::find_if(ring.begin(), ring.end(), [&](int g) { return is_node(adjacency_.from(g)); });
      if (start != ring.end()) std::rotate(ring.begin(), start, ring.end());
      std::vector<int> loop;
      for (std::size_t i = 0; i < ring.size(); ++i) {
        const int e = adjacency_.edge_of(ring[i]);
        if (i > 0 && chain_of_edge_[e] == chain_of_edge_[adjacency_.edge_of(ring[i - 1])] &&
            !is_node(adjacency_.from(ring[i])))
          continue;
        const Chain& chain = chains_[chain_of_edge_[e]];
        std::vector<int> points = chain.points;
        if ((adjacency_.from(ring[i]) == adjacency_.edges()[e].lower) != (forward_[e] != 0))
          std::reverse(points.begin(), points.end());
        if (!chain.closed) points.pop_back();
        loop.insert(loop.end(), points.begin(), points.end());
      }
      network_.loops[bands_.band[h / 3]].push_back(std::move(loop));
    }
  }

  /// The border of the band after half-edge g, turning around its end inside the band.
  int onward(int g) const {
    int h = next_halfedge(g);
    while (chain_of_edge_[adjacency_.edge_of(h)] < 0) h = next_halfedge(adjacency_.opposite(h));
    return h;
  }

  const Bands& bands_;
  Adjacency adjacency_;
  double sample_mm_;
  std::vector<int> chain_of_edge_;
  std::vector<char> forward_;  // per edge: the chain runs from its first vertex to its second
  std::vector<std::vector<int>> borders_at_;
  std::vector<Chain> chains_;
  std::map<int, int> nodes_;
  BandNetwork network_;
};

}  // namespace

BandNetwork band_network(const Bands& bands, double sample_mm) { return NetworkBuilder(bands, sample_mm).build(); }

}  // namespace formwright
