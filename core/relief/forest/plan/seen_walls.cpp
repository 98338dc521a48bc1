// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/forest/plan/seen_walls.h"

#include <cmath>

#include "geometry/planar/plane.h"

namespace formwright {
namespace {

constexpr double nearest_mm = 1e-3;

/// An edge that is turned to the eye, as far as it lies ahead.
struct FacingEdge {
  int pillar, edge;
  Vec2 a, b;        // of the line
  double from, to;  // tangents
};

std::vector<FacingEdge> facing_edges(const PlanView& view, std::span<const Pillar> pillars) {
  std::vector<FacingEdge> edges;
  for (std::size_t p = 0; p < pillars.size(); ++p) {
    const Outline& outline = pillars[p].outline_mm;
    for (int k = 0; k < static_cast<int>(outline.size()); ++k) {
      const Vec2 a = corner(outline, k), b = corner(outline, k + 1);
      // The outline runs counter-clockwise: from outside its edges run from left to right.
      if (cross(b - a, view.eye - a) >= 0) continue;
      Vec2 left = a, right = b;
      const double ahead_a = view.ahead(a), ahead_b = view.ahead(b);
      if (std::max(ahead_a, ahead_b) <= nearest_mm) continue;
      const auto cut_at_eye = [&] { return a + (nearest_mm - ahead_a) / (ahead_b - ahead_a) * (b - a); };
      if (ahead_a < nearest_mm) left = cut_at_eye();
      if (ahead_b < nearest_mm) right = cut_at_eye();
      const double from = std::max(view.from, view.tangent(left)), to = std::min(view.to, view.tangent(right));
      if (from < to) edges.push_back({static_cast<int>(p), k, a, b, from, to});
    }
  }
  return edges;
}

}  // namespace

std::vector<WallStrip> seen_walls(const PlanView& view, std::span<const Pillar> pillars, const Context& context) {
  std::vector<FacingEdge> edges = facing_edges(view, pillars);
  std::ranges::stable_sort(edges, {}, &FacingEdge::from);
  std::vector<double> borders;
  for (const FacingEdge& e : edges) {
    borders.push_back(e.from);
    borders.push_back(e.to);
  }
  std::ranges::sort(borders);
  borders.erase(std::ranges::unique(borders).begin(), borders.end());

  // Outlines do not touch, so that between two borders the order along rays does not change.
  std::vector<WallStrip> strips;
  std::vector<const FacingEdge*> open;
  std::size_t next = 0;
  for (std::size_t k = 0; k + 1 < borders.size(); ++k) {
    if (k % 256 == 0) context.check_cancelled();
    for (; next < edges.size() && edges[next].from <= borders[k]; ++next) open.push_back(&edges[next]);
    std::erase_if(open, [&](const FacingEdge* e) { return e->to <= borders[k]; });
    const double middle = 0.5 * (borders[k] + borders[k + 1]);
    const FacingEdge* first = nullptr;
    double nearest = INFINITY;
    for (const FacingEdge* e : open) {
      const double ahead = view.meets_line(middle, e->a, e->b);
      if (ahead < nearest) {
        nearest = ahead;
        first = e;
      }
    }
    if (first == nullptr) continue;
    if (!strips.empty() && strips.back().to == borders[k] && strips.back().pillar == first->pillar &&
        strips.back().edge == first->edge)
      strips.back().to = borders[k + 1];
    else strips.push_back({first->pillar, first->edge, borders[k], borders[k + 1]});
  }
  return strips;
}

double place_on_edge(const PlanView& view, const Pillar& pillar, int edge, double t) {
  const Vec2 &a = corner(pillar.outline_mm, edge), &b = corner(pillar.outline_mm, edge + 1);
  const Vec2 p = view.at(t, view.meets_line(t, a, b));
  return std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
}

}  // namespace formwright
