// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/samples/texture_atlas.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>

#include "base/index.h"
#include "base/parallel.h"

namespace formwright::samples {
namespace {

// Across each side of a face, by sorting the sides.
std::vector<std::array<int, 3>> neighbours_of(const Triangles& F) {
  struct Side {
    std::uint64_t key;
    int face, corner;
  };
  std::vector<Side> sides;
  sides.reserve(static_cast<std::size_t>(F.rows()) * 3);
  for (int f = 0; f < static_cast<int>(F.rows()); ++f)
    for (int c = 0; c < 3; ++c) {
      const auto a = static_cast<std::uint64_t>(F(f, c)), b = static_cast<std::uint64_t>(F(f, (c + 1) % 3));
      sides.push_back({std::min(a, b) << 32 | std::max(a, b), f, c});
    }
  std::sort(sides.begin(), sides.end(),
            [](const Side& a, const Side& b) { return a.key != b.key ? a.key < b.key : a.face < b.face; });
  std::vector<std::array<int, 3>> beside(static_cast<std::size_t>(F.rows()), {-1, -1, -1});
  for (std::size_t k = 0; k + 1 < sides.size(); ++k)
    if (sides[k].key == sides[k + 1].key) {
      beside[index(sides[k].face)][index(sides[k].corner)] = sides[k + 1].face;
      beside[index(sides[k + 1].face)][index(sides[k + 1].corner)] = sides[k].face;
    }
  return beside;
}

}  // namespace

Point Atlas::seen(int view, const Point& p) {
  switch (view) {
    case 0: return {-p.z, p.y, p.x};
    case 1: return {p.z, p.y, -p.x};
    case 2: return {p.x, -p.z, p.y};
    case 3: return {p.x, p.z, -p.y};
    case 4: return {p.x, p.y, p.z};
    default: return {-p.x, p.y, -p.z};
  }
}

Atlas::Atlas(const Model& model, const std::function<Point(const Point&)>& broad_normal, Context& context)
    : V_(model.mesh.V), F_(model.mesh.F), beside_(neighbours_of(F_)), context_(context) {
  choose_views(broad_normal);
  peel();
  collect();
}

double Atlas::pack(double gap) {
  std::vector<int> order(charts_.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return charts_[index(a)].height() > charts_[index(b)].height(); });
  double area = 0, widest = 0;
  for (const Chart& c : charts_) {
    area += (c.width() + gap) * (c.height() + gap);
    widest = std::max({widest, c.width() + 2 * gap, c.height() + 2 * gap});
  }
  for (double side = std::max(widest, std::sqrt(area));; side *= 1.03) {
    double x = gap, y = gap, row = 0;
    for (int k : order) {
      Chart& c = charts_[index(k)];
      if (x + c.width() + gap > side) {
        x = gap;
        y += row + gap;
        row = 0;
      }
      c.u = x;
      c.v = y;
      x += c.width() + gap;
      row = std::max(row, c.height());
    }
    if (y + row + gap <= side) return side;
  }
}

void Atlas::choose_views(const std::function<Point(const Point&)>& broad_normal) {
  const int faces = static_cast<int>(F_.rows());
  view_.resize(index(faces));
  parallel_for(index(faces), 2048, [&](std::size_t from, std::size_t to) {
    context_.check_cancelled();
    for (std::size_t f = from; f < to; ++f) {
      const int i = static_cast<int>(f);
      const Point centre = (corner(i, 0) + corner(i, 1) + corner(i, 2)) / 3;
      const Point n = normalized(normalized(broad_normal(centre)) * 1.5 +
                                 normalized(cross(corner(i, 1) - corner(i, 0), corner(i, 2) - corner(i, 0))));
      // The front gets more than its share: it is what is looked at.
      const double score[6] = {n.x, -n.x, n.y * 0.9, -n.y * 0.9, n.z * 1.25, -n.z};
      view_[f] = static_cast<int>(std::max_element(score, score + 6) - score);
    }
  });
  // A face follows two of its neighbours that agree.
  for (int round = 0; round < 6; ++round) {
    context_.check_cancelled();
    const std::vector<int> before = view_;
    for (int f = 0; f < faces; ++f) {
      const auto& n = beside_[index(f)];
      for (std::size_t c = 0; c < 3; ++c) {
        const int a = n[c], b = n[(c + 1) % 3];
        if (a >= 0 && b >= 0 && before[index(a)] == before[index(b)] && faces_viewer(f, before[index(a)]))
          view_[index(f)] = before[index(a)];
      }
    }
  }
}

bool Atlas::faces_viewer(int f, int view) const {
  const Point a = seen(view, corner(f, 0)), b = seen(view, corner(f, 1)), c = seen(view, corner(f, 2));
  const Point n = cross(b - a, c - a);
  return n.z > 0.2 * length(n);
}

void Atlas::peel() {
  constexpr double cell = 0.5, hidden_mm = 2.5;
  const int faces = static_cast<int>(F_.rows());
  layer_.assign(index(faces), 0);
  Point low{1e30, 1e30, 1e30}, high{-1e30, -1e30, -1e30};
  for (int v = 0; v < static_cast<int>(V_.rows()); ++v) {
    const Point p = vertex(v);
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const double reach = std::max({std::fabs(low.x), std::fabs(low.y), std::fabs(low.z), std::fabs(high.x),
                                 std::fabs(high.y), std::fabs(high.z)}) +
                       1;
  const int n = static_cast<int>(2 * reach / cell) + 2;
  parallel_for(6, 1, [&](std::size_t from, std::size_t) {
    const int view = static_cast<int>(from);
    std::vector<float> front(index(n) * index(n));
    for (int layer = 0; layer < 8; ++layer) {
      context_.check_cancelled();
      std::fill(front.begin(), front.end(), -1e30F);
      int members = 0;
      const auto cell_of = [&](double x) { return static_cast<int>((x + reach) / cell); };
      for (int f = 0; f < faces; ++f) {
        if (view_[index(f)] != view || layer_[index(f)] != layer) continue;
        ++members;
        const Point a = seen(view, corner(f, 0)), b = seen(view, corner(f, 1)), c = seen(view, corner(f, 2));
        const auto depth = static_cast<float>(std::min({a.z, b.z, c.z}));
        for (int y = cell_of(std::min({a.y, b.y, c.y})); y <= cell_of(std::max({a.y, b.y, c.y})); ++y)
          for (int x = cell_of(std::min({a.x, b.x, c.x})); x <= cell_of(std::max({a.x, b.x, c.x})); ++x) {
            float& at = front[index(y) * index(n) + index(x)];
            at = std::max(at, depth);
          }
      }
      if (members == 0) break;
      for (int f = 0; f < faces; ++f) {
        if (view_[index(f)] != view || layer_[index(f)] != layer) continue;
        const Point centre = seen(view, (corner(f, 0) + corner(f, 1) + corner(f, 2)) / 3);
        const double before =
            static_cast<double>(front[index(cell_of(centre.y)) * index(n) + index(cell_of(centre.x))]);
        // Steep faces reach far back within one cell.
        const Point a = seen(view, corner(f, 0)), b = seen(view, corner(f, 1)), c = seen(view, corner(f, 2));
        const double spread = std::max({a.z, b.z, c.z}) - std::min({a.z, b.z, c.z});
        if (before > centre.z + hidden_mm + spread) ++layer_[index(f)];
      }
    }
  });
}

void Atlas::collect() {
  const int faces = static_cast<int>(F_.rows());
  std::vector<int> chart(index(faces), -1);
  for (int pass = 0; pass < 3; ++pass) {
    context_.check_cancelled();
    std::fill(chart.begin(), chart.end(), -1);
    charts_.clear();
    std::vector<int> stack;
    for (int seed = 0; seed < faces; ++seed) {
      if (chart[index(seed)] >= 0) continue;
      Chart c;
      c.view = view_[index(seed)];
      const int id = static_cast<int>(charts_.size());
      stack.assign(1, seed);
      chart[index(seed)] = id;
      while (!stack.empty()) {
        const int f = stack.back();
        stack.pop_back();
        c.faces.push_back(f);
        for (int g : beside_[index(f)])
          if (g >= 0 && chart[index(g)] < 0 && view_[index(g)] == view_[index(f)] &&
              layer_[index(g)] == layer_[index(f)]) {
            chart[index(g)] = id;
            stack.push_back(g);
          }
      }
      charts_.push_back(std::move(c));
    }
    if (pass == 2) break;
    const std::size_t crumb = std::max<std::size_t>(12, index(faces) / 800);
    for (const Chart& c : charts_) {
      if (c.faces.size() >= crumb) continue;
      // The neighbour along most sides.
      std::vector<std::pair<int, int>> votes;  // view and layer as one number, count
      for (int f : c.faces)
        for (int g : beside_[index(f)]) {
          if (g < 0 || chart[index(g)] == chart[index(f)]) continue;
          const int key = view_[index(g)] * 16 + layer_[index(g)];
          const auto found = std::find_if(votes.begin(), votes.end(), [&](const auto& v) { return v.first == key; });
          if (found == votes.end()) {
            votes.emplace_back(key, 1);
          } else {
            ++found->second;
          }
        }
      std::stable_sort(votes.begin(), votes.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
      for (const auto& [key, count] : votes) {
        const int view = key / 16;
        const auto visible =
            std::count_if(c.faces.begin(), c.faces.end(), [&](int f) { return faces_viewer(f, view); });
        if (static_cast<std::size_t>(visible) * 10 < c.faces.size() * 9) continue;
        for (int f : c.faces) {
          view_[index(f)] = view;
          layer_[index(f)] = key % 16;
        }
        break;
      }
    }
  }
  for (Chart& c : charts_) {
    std::sort(c.faces.begin(), c.faces.end());
    for (int f : c.faces)
      for (int k = 0; k < 3; ++k) {
        const Point p = seen(c.view, corner(f, k));
        c.low = {std::min(c.low.x, p.x), std::min(c.low.y, p.y), 0};
        c.high = {std::max(c.high.x, p.x), std::max(c.high.y, p.y), 0};
      }
  }
}

}  // namespace formwright::samples
