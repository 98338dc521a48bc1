// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/parts/polygon_dissection.h"

#include <algorithm>
#include <numeric>
#include <set>

namespace formwright {
namespace {

/// Chords kept so far, found by either end; two chords (a, b), (c, d) cross when a < c < b < d.
class ChordSet {
 public:
  explicit ChordSet(int count) : ends_(count) {}

  bool crosses(const Chord& chord) const {
    // The shorter side of the walk is looked through for a chord that leaves it.
    const int count = static_cast<int>(ends_.size());
    const bool inside = chord.to - chord.from <= count / 2;
    const int length = inside ? chord.to - chord.from : count - (chord.to - chord.from),
              start = inside ? chord.from : chord.to;
    for (int k = 1; k < length; ++k)
      for (const int other : ends_[(start + k) % count]) {
        const bool other_inside = other > chord.from && other < chord.to;
        if (other != chord.from && other != chord.to && other_inside != inside) return true;
      }
    return false;
  }
  bool contains(const Chord& chord) const { return ends_[chord.from].contains(chord.to); }
  void add(const Chord& chord) {
    ends_[chord.from].insert(chord.to);
    ends_[chord.to].insert(chord.from);
  }

 private:
  std::vector<std::set<int>> ends_;
};

}  // namespace

std::vector<Chord> without_crossings(const std::vector<Chord>& chords, int count) {
  ChordSet kept(count);
  std::vector<Chord> result;
  for (const Chord& chord : chords) {
    const int span = chord.to - chord.from;
    if (span < 2 || span > count - 2 || kept.contains(chord) || kept.crosses(chord)) continue;
    kept.add(chord);
    result.push_back(chord);
  }
  return result;
}

std::vector<std::vector<int>> dissect(int count, const std::vector<Chord>& chords) {
  std::vector<Chord> order = chords;
  std::sort(order.begin(), order.end(), [](const Chord& a, const Chord& b) {
    const int sa = a.to - a.from, sb = b.to - b.from;
    return sa != sb ? sa < sb : a.from < b.from;
  });
  std::vector<int> next(count);
  std::iota(next.begin(), next.end(), 1);
  std::vector<std::vector<int>> pieces;
  for (const Chord& chord : order) {
    std::vector<int> piece;
    for (int v = chord.from; v != chord.to; v = next[v]) piece.push_back(v);
    piece.push_back(chord.to);
    next[chord.from] = chord.to;
    pieces.push_back(std::move(piece));
  }
  std::vector<int> rest;
  for (int v = 0; v < count; v = next[v]) rest.push_back(v);
  pieces.push_back(std::move(rest));
  return pieces;
}

std::vector<std::array<int, 3>> cheapest_triangulation(const std::vector<int>& polygon,
                                                       const std::function<double(int, int)>& side,
                                                       const std::function<double(int, int, int)>& triangle) {
  const int n = static_cast<int>(polygon.size());
  std::vector<std::array<int, 3>> triangles;
  if (n < 3) return triangles;
  const auto index = [n](int i, int j) { return static_cast<std::size_t>(i) * n + j; };
  std::vector<double> best(static_cast<std::size_t>(n) * n, 0);
  std::vector<int> apex(best.size(), -1);
  for (int span = 2; span < n; ++span)
    for (int i = 0; i + span < n; ++i) {
      const int j = i + span;
      double minimum = 1e300;
      int choice = i + 1;
      for (int k = i + 1; k < j; ++k) {
        const double total = best[index(i, k)] + best[index(k, j)] + triangle(polygon[i], polygon[k], polygon[j]);
        // Of choices that differ by rounding only, as in symmetric models, the first.
        if (total < minimum * (1 - 1e-9)) minimum = total, choice = k;
      }
      best[index(i, j)] = minimum + (span + 1 < n ? side(polygon[i], polygon[j]) : 0.0);
      apex[index(i, j)] = choice;
    }
  std::vector<std::pair<int, int>> open{{0, n - 1}};
  while (!open.empty()) {
    const auto [i, j] = open.back();
    open.pop_back();
    if (j - i < 2) continue;
    const int k = apex[index(i, j)];
    triangles.push_back({polygon[i], polygon[k], polygon[j]});
    open.emplace_back(i, k);
    open.emplace_back(k, j);
  }
  return triangles;
}

}  // namespace formwright
