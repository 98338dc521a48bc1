// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/chart/seamless_chart.h"

#include <algorithm>
#include <limits>
#include <queue>

#include "base/error.h"
#include "base/parallel.h"

namespace formwright {

int SeamlessChart::intern(std::vector<SharedTerm> sum) {
  std::sort(sum.begin(), sum.end());
  std::vector<SharedTerm> merged;
  for (const SharedTerm& term : sum) {
    if (!merged.empty() && merged.back().shared == term.shared) merged.back().factor += term.factor;
    else merged.push_back(term);
  }
  std::erase_if(merged, [](const SharedTerm& t) { return t.factor == 0; });
  const auto [found, fresh] = known_.try_emplace(merged, static_cast<int>(sums_.size()));
  if (fresh) sums_.push_back(merged);
  return found->second;
}

void SeamlessChart::cut_part(const Segmentation& s, const Adjacency& adjacency, int part,
                             std::vector<char>& shifted) const {
  // Shortest path along inner edges from the lower line's first vertex to the upper line, touching neither between.
  const Segment& segment = s.segments[part];
  constexpr double far = std::numeric_limits<double>::infinity();
  std::vector<double> distance(s.mesh.vertex_count(), far);
  std::vector<int> arriving(s.mesh.vertex_count(), -1);
  std::vector<char> lower(s.mesh.vertex_count(), 0), upper(s.mesh.vertex_count(), 0);
  for (const int v : segment.bottom.vertices) lower[v] = 1;
  for (const int v : segment.top.vertices) upper[v] = 1;
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  const int start = segment.bottom.vertices.front();
  distance[start] = 0;
  queue.emplace(0, start);
  int end = -1;
  while (!queue.empty() && end < 0) {
    const auto [d, v] = queue.top();
    queue.pop();
    if (d > distance[v]) continue;
    if (upper[v]) {
      end = v;
      break;
    }
    for (const int h : adjacency.outgoing(v)) {
      const int o = adjacency.opposite(h), w = adjacency.to(h);
      if (s.face_segment[h / 3] != part || o < 0 || s.face_segment[o / 3] != part || lower[w]) continue;
      const double reach = d + (s.mesh.V.row(w) - s.mesh.V.row(v)).norm();
      if (reach < distance[w]) distance[w] = reach, arriving[w] = h, queue.emplace(reach, w);
    }
  }
  if (end < 0)
    throw Error(
        ErrorCode::could_not_solve, "mesh",
        "Part " + std::to_string(part + 1) + " is too coarse to be cut from line to line: subdivide the model.");
  std::vector<int> path;
  for (int v = end; v != start; v = adjacency.from(path.back())) path.push_back(arriving[v]);
  std::vector<char> wall(adjacency.edge_count(), 0);
  for (const int h : path) wall[adjacency.edge_of(h)] = 1;
  // Left of the path upwards, around each of its vertices.
  const auto spread = [&](int v, int face) {
    std::vector<int> stack{face};
    while (!stack.empty()) {
      const int f = stack.back();
      stack.pop_back();
      for (int h = 3 * f; h < 3 * f + 3; ++h) {
        if (adjacency.from(h) == v) {
          if (shifted[h]) break;
          shifted[h] = 1;
          for (const int side : {h, previous_halfedge(h)}) {
            const int o = adjacency.opposite(side);
            if (!wall[adjacency.edge_of(side)] && o >= 0 && s.face_segment[o / 3] == part) stack.push_back(o / 3);
          }
        }
      }
    }
  };
  for (const int h : path) {
    spread(adjacency.from(h), h / 3);
    spread(adjacency.to(h), h / 3);
  }
}

void SeamlessChart::place_lines(const Segmentation& s) {
  periods_.resize(part_count_);
  if (part_count_ == 1) {
    periods_[0] = {{1, 1.0}};
    shared_count_ = 2;
    return;
  }
  shared_count_ = part_count_ + static_cast<int>(s.interfaces.size());
  for (int part = 0; part < part_count_; ++part)
    for (const InterfaceUse& use : s.segments[part].bottom.uses)
      periods_[part].push_back({length_of(use.interface), 1.0});
  interface_locals_.resize(s.interfaces.size());
  for (int i = 0; i < static_cast<int>(s.interfaces.size()); ++i) {
    const int count = static_cast<int>(s.interfaces[i].vertices.size());
    interface_locals_[i].assign(count, -1);
    for (int place = 1; place + 1 < count; ++place) {
      interface_variables_.push_back({i, place, local_count_});
      interface_locals_[i][place] = local_count_++;
    }
  }
}

SeamlessChart::SeamlessChart(const Segmentation& s) : part_count_(s.part_count()) {
  intern({});
  const Adjacency adjacency(s.mesh);
  place_lines(s);
  corners_.resize(3 * s.mesh.face_count());
  std::vector<char> shifted(3 * s.mesh.face_count(), 0);
  for (int part = 0; part < part_count_; ++part) cut_part(s, adjacency, part, shifted);

  constexpr ChartCoordinate unknown{-2, 1, 0};
  std::vector<std::array<ChartCoordinate, 2>> at(s.mesh.vertex_count(), {unknown, unknown});
  std::vector<std::vector<int>> faces(part_count_);
  for (int f = 0; f < s.mesh.face_count(); ++f) faces[s.face_segment[f]].push_back(f);
  for (int part = 0; part < part_count_; ++part) {
    const Segment& segment = s.segments[part];
    for (const int f : faces[part])
      for (int k = 0; k < 3; ++k) at[s.mesh.F(f, k)] = {unknown, unknown};
    for (const int v : segment.top.vertices) at[v][1] = {-1, 1, intern({{height_of(part), 1.0}})};
    for (const int v : segment.bottom.vertices) at[v][1] = {-1, 1, 0};
    if (part_count_ == 1) at[segment.bottom.vertices.front()][0] = {-1, 1, 0};
    std::vector<SharedTerm> before;
    std::size_t place_in_line = 0;
    for (const InterfaceUse& use : segment.bottom.uses) {
      const Interface& interface = s.interfaces[use.interface];
      const int count = static_cast<int>(interface.vertices.size());
      for (int step = 0; step + 1 < count; ++step) {
        const int v = segment.bottom.vertices[place_in_line++];
        ChartCoordinate& x = at[v][0];
        if (step == 0) {
          x = {-1, 1, intern(before)};
        } else if (use.forward) {
          x = {interface_locals_[use.interface][step], 1, intern(before)};
        } else {
          std::vector<SharedTerm> sum = before;
          sum.push_back({length_of(use.interface), 1.0});
          x = {interface_locals_[use.interface][count - 1 - step], -1, intern(sum)};
        }
      }
      before.push_back({length_of(use.interface), 1.0});
    }
    for (const int f : faces[part])
      for (int k = 0; k < 3; ++k) {
        auto& coordinates = at[s.mesh.F(f, k)];
        for (ChartCoordinate& c : coordinates)
          if (c.local == -2) c = {local_count_++, 1, 0};
        corners_[3 * f + k] = coordinates;
        if (!shifted[3 * f + k]) continue;
        std::vector<SharedTerm> sum = sums_[coordinates[0].terms];
        const auto& period = periods_[part];
        sum.insert(sum.end(), period.begin(), period.end());
        corners_[3 * f + k][0].terms = intern(std::move(sum));
      }
  }
}

CornerCoordinates SeamlessChart::corners(const Eigen::VectorXd& local, const Eigen::VectorXd& shared) const {
  std::vector<double> value(sums_.size(), 0.0);
  for (std::size_t i = 0; i < sums_.size(); ++i)
    for (const SharedTerm& term : sums_[i]) value[i] += term.factor * shared[term.shared];
  CornerCoordinates result(static_cast<Eigen::Index>(corners_.size()), 2);
  parallel_for(corners_.size(), 8192, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c)
      for (int axis = 0; axis < 2; ++axis) {
        const ChartCoordinate& x = corners_[c][axis];
        result(static_cast<Eigen::Index>(c), axis) = value[x.terms] + (x.local >= 0 ? x.sign * local[x.local] : 0.0);
      }
  });
  return result;
}

double SeamlessChart::period_mm(int part, const Eigen::VectorXd& shared) const {
  double period = 0;
  for (const SharedTerm& term : periods_[part]) period += term.factor * shared[term.shared];
  return period;
}

}  // namespace formwright
