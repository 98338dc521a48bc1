// SPDX-License-Identifier: GPL-3.0-or-later
// Steps of Remesher that split and collapse edges.
#include "geometry/samples/remeshing/remesher.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "base/index.h"

namespace formwright::samples {

double Remesher::longest_edge() const {
  double longest = 0;
  for (int h = 0; h < s_.halfedge_slots(); ++h)
    if (real(h)) longest = std::max(longest, s_.edge_length2(h));
  return std::sqrt(longest);
}

void Remesher::split_longer_than(double length) {
  const double limit = length * length;
  const int slots = s_.halfedge_slots();
  for (int h = 0; h < slots; ++h) {
    poll(h);
    if (real(h) && h < s_.twin(h) && s_.edge_length2(h) > limit) split_at_middle(h);
  }
}

void Remesher::split_at_middle(int h) {
  const Point middle = (s_.point(s_.start(h)) + s_.point(s_.end(h))) / 2;
  const int m = s_.split(h, middle);
  Point slope;
  s_.move(m, limited(middle, shape_.project(middle, s_.patches(m), 0.1 * scale_, slope)));
}

void Remesher::collapse_short(double factor) {
  const double limit = factor * factor * edge_ * edge_;
  for (int h = 0; h < s_.halfedge_slots(); ++h) {
    poll(h);
    if (real(h) && s_.edge_length2(h) < limit) try_collapse(h, 4.0 / 3);
  }
}

bool Remesher::try_collapse(int h, double longest) {
  Point p;
  if (!s_.can_collapse(h, p)) return false;
  const double limit = longest * longest * edge_ * edge_;
  if (!survives(h, s_.start(h), p, limit) || !survives(h, s_.end(h), p, limit)) return false;
  s_.collapse(h, p);
  return true;
}

bool Remesher::survives(int h, int v, const Point& p, double limit) const {
  const int t = s_.twin(h), begin = s_.out(v);
  int k = begin;
  do {
    if (k / 3 != h / 3 && k / 3 != t / 3 && !touches_ghost(k)) {
      const Point& b = s_.point(s_.end(k));
      const Point& c = s_.point(s_.start(s_.previous(k)));
      if (distance2(p, b) > limit) return false;
      if (!agree(normal_of(s_.point(v), b, c), normal_of(p, b, c), 0.35)) return false;
    }
    k = s_.rotate(k);
  } while (k != begin);
  return true;
}

void Remesher::dissolve_slivers() {
  for (int h = 0; h < s_.halfedge_slots(); ++h) {
    poll(h);
    if (!s_.alive(h) || touches_ghost(h)) continue;
    const Point &a = s_.point(s_.start(h)), &b = s_.point(s_.end(h)), &c = s_.point(s_.start(s_.previous(h)));
    if (cotangent(c, a, b) > 2.25) try_collapse(h, 1.6);
  }
}

void Remesher::match_count() {
  for (int round = 0; round < 20 && s_.vertex_count() != target_; ++round) {
    context_.check_cancelled();
    const bool grow = s_.vertex_count() < target_;
    std::vector<std::pair<double, int>> edges;
    for (int h = 0; h < s_.halfedge_slots(); ++h)
      if (real(h) && h < s_.twin(h)) edges.emplace_back(grow ? -s_.edge_length2(h) : s_.edge_length2(h), h);
    const std::size_t missing = index(std::abs(target_ - s_.vertex_count()));
    const std::size_t first = std::min(edges.size(), grow ? missing : 3 * missing + 8);
    std::partial_sort(edges.begin(), edges.begin() + static_cast<std::ptrdiff_t>(first), edges.end());
    for (std::size_t e = 0; e < first && s_.vertex_count() != target_; ++e) {
      const int h = edges[e].second;
      if (!s_.alive(h)) continue;
      if (grow) {
        split_at_middle(h);
      } else if (!try_collapse(h, 1.6 + 0.1 * round)) {
        try_collapse(s_.twin(h), 1.6 + 0.1 * round);
      }
    }
  }
}

}  // namespace formwright::samples
