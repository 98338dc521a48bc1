// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/sheet/contours.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <set>
#include <tuple>
#include <utility>

namespace formwright {
namespace {

using Key = std::vector<std::pair<std::int64_t, std::int64_t>>;

/// The same for any start and direction along the same points.
Key key_of(const CutPath& path) {
  Key key;
  for (const Vec2& p : path.points_mm) key.emplace_back(std::llround(1e3 * p.x()), std::llround(1e3 * p.y()));
  key.erase(std::unique(key.begin(), key.end()), key.end());
  if (!path.closed) {
    Key back(key.rbegin(), key.rend());
    return std::min(key, back);
  }
  if (key.size() > 1 && key.front() == key.back()) key.pop_back();
  std::rotate(key.begin(), std::min_element(key.begin(), key.end()), key.end());
  Key back(key.rbegin(), key.rend());
  std::rotate(back.begin(), std::min_element(back.begin(), back.end()), back.end());
  return std::min(key, back);
}

struct PathEnd {
  Vec2 at;
  int path;
  bool last;
};

/// For every end (2 path + last) the end that it is joined to, or -1.
std::vector<int> pair_ends(const std::vector<CutPath>& paths, const std::vector<int>& open, double join_mm) {
  std::vector<PathEnd> ends;
  for (const int i : open)
    for (const bool last : {false, true})
      ends.push_back({last ? paths[i].points_mm.back() : paths[i].points_mm.front(), i, last});
  std::sort(ends.begin(), ends.end(), [](const PathEnd& a, const PathEnd& b) {
    return std::tuple(a.at.x(), a.at.y(), a.path, a.last) < std::tuple(b.at.x(), b.at.y(), b.path, b.last);
  });
  std::vector<std::tuple<double, int, int>> candidates;
  for (std::size_t i = 0; i < ends.size(); ++i)
    for (std::size_t k = i + 1; k < ends.size() && ends[k].at.x() - ends[i].at.x() <= join_mm; ++k) {
      const double distance = (ends[k].at - ends[i].at).norm();
      if (distance > join_mm) continue;
      // A short line is not bent into a ring with itself.
      if (ends[k].path == ends[i].path && path_length_mm(paths[ends[i].path].points_mm, false) < 4 * join_mm) continue;
      const int a = 2 * ends[i].path + ends[i].last, b = 2 * ends[k].path + ends[k].last;
      candidates.emplace_back(distance, std::min(a, b), std::max(a, b));
    }
  std::sort(candidates.begin(), candidates.end());
  std::vector<int> partner(2 * paths.size(), -1);
  for (const auto& [distance, a, b] : candidates)
    if (partner[a] < 0 && partner[b] < 0) {
      partner[a] = b;
      partner[b] = a;
    }
  return partner;
}

void append(std::vector<Vec2>& points, const std::vector<Vec2>& more, bool reversed) {
  const auto add = [&](auto from, auto to) { points.insert(points.end(), points.empty() ? from : from + 1, to); };
  if (reversed) add(more.rbegin(), more.rend());
  else add(more.begin(), more.end());
}

}  // namespace

double path_length_mm(const std::vector<Vec2>& points, bool closed) {
  double sum = closed && !points.empty() ? (points.front() - points.back()).norm() : 0;
  for (std::size_t i = 1; i < points.size(); ++i) sum += (points[i] - points[i - 1]).norm();
  return sum;
}

TidiedPaths tidy_paths(const std::vector<CutPath>& given, double join_mm, const Context& context) {
  TidiedPaths tidied;
  std::vector<CutPath> paths;
  std::set<std::pair<CutLayer, Key>> seen;
  for (const CutPath& path : given) {
    if (paths.size() % 256 == 0) context.check_cancelled();
    if (seen.emplace(path.layer, key_of(path)).second) paths.push_back(path);
    else ++tidied.doubles_dropped;
  }
  std::vector<int> partner(2 * paths.size(), -1);
  for (int layer = 0; layer < cut_layer_count; ++layer) {
    std::vector<int> open;
    for (std::size_t i = 0; i < paths.size(); ++i)
      if (!paths[i].closed && paths[i].layer == static_cast<CutLayer>(layer)) open.push_back(static_cast<int>(i));
    const std::vector<int> found = pair_ends(paths, open, join_mm);
    for (std::size_t i = 0; i < found.size(); ++i)
      if (found[i] >= 0) partner[i] = found[i];
  }
  std::vector<bool> used(paths.size(), false);
  for (std::size_t i = 0; i < paths.size(); ++i) {
    if (used[i]) continue;
    if (partner[2 * i] < 0 && partner[2 * i + 1] < 0) {
      used[i] = true;
      tidied.paths.push_back(std::move(paths[i]));
      continue;
    }
    // Back to where the chain begins, unless it is a ring.
    int entry = static_cast<int>(2 * i);
    while (partner[entry] >= 0 && (partner[entry] ^ 1) != static_cast<int>(2 * i)) entry = partner[entry] ^ 1;
    const bool ring = partner[entry] >= 0;
    if (ring) entry = static_cast<int>(2 * i);
    CutPath joined{paths[i].layer, {}, ring, paths[static_cast<std::size_t>(entry / 2)].name};
    for (int end = entry;;) {
      const auto path = static_cast<std::size_t>(end / 2);
      used[path] = true;
      append(joined.points_mm, paths[path].points_mm, (end & 1) != 0);
      const int next = partner[end ^ 1];
      if (next >= 0) ++tidied.ends_joined;
      if (next < 0 || next == entry) break;
      end = next;
    }
    if (ring) joined.points_mm.pop_back();
    if (joined.points_mm.size() < 3) joined.closed = false;
    if (joined.points_mm.size() >= 2) tidied.paths.push_back(std::move(joined));
  }
  return tidied;
}

bool contains(const Polygon& polygon, const Vec2& p) {
  bool inside = false;
  for (std::size_t i = 0, k = polygon.size() - 1; i < polygon.size(); k = i++) {
    const Vec2 &a = polygon[i], &b = polygon[k];
    if ((a.y() > p.y()) != (b.y() > p.y()) && p.x() < (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y()) + a.x())
      inside = !inside;
  }
  return inside;
}

std::vector<int> containing_contours(const std::vector<CutPath>& paths, const std::vector<int>& containers,
                                     const Context& context) {
  struct Box {
    Vec2 low, high;
  };
  std::vector<Box> boxes;
  for (const CutPath& path : paths) {
    Box box{path.points_mm.front(), path.points_mm.front()};
    for (const Vec2& p : path.points_mm) {
      box.low = box.low.cwiseMin(p);
      box.high = box.high.cwiseMax(p);
    }
    boxes.push_back(box);
  }
  std::vector<double> area(paths.size(), 0);
  for (const int c : containers) area[c] = std::abs(signed_area_mm2(paths[c].points_mm));
  std::vector<int> by_area = containers;
  std::stable_sort(by_area.begin(), by_area.end(), [&](int a, int b) { return area[a] < area[b]; });
  std::vector<int> parents(paths.size(), -1);
  for (std::size_t i = 0; i < paths.size(); ++i) {
    if (i % 64 == 0) context.check_cancelled();
    const auto& points = paths[i].points_mm;
    for (const int c : by_area) {
      if (c == static_cast<int>(i) || area[c] <= area[i]) continue;
      const Box &inner = boxes[i], &outer = boxes[c];
      if ((inner.low.array() < outer.low.array()).any() || (inner.high.array() > outer.high.array()).any()) continue;
      int votes = 0;
      const std::size_t asked = std::min<std::size_t>(points.size(), 5);
      for (std::size_t k = 0; k < asked; ++k)
        votes += contains(paths[c].points_mm, points[k * points.size() / asked]) ? 1 : -1;
      if (votes > 0) {
        parents[i] = c;
        break;
      }
    }
  }
  return parents;
}

}  // namespace formwright
