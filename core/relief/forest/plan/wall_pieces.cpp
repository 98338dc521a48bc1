// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/forest/plan/wall_pieces.h"

#include <cmath>
#include <map>

#include "geometry/planar/plane.h"

namespace formwright {
namespace {

/// A strip as a part of its edge.
struct Claim {
  int view;
  double from, to;    // places on the edge
  double squareness;  // cosine between edge normal and line of sight, in its middle
};

double squareness(const PlanView& view, const Pillar& pillar, int edge, double place) {
  const Vec2 &a = corner(pillar.outline_mm, edge), &b = corner(pillar.outline_mm, edge + 1);
  const Vec2 towards = view.eye - (a + place * (b - a)), along = b - a;
  return -cross(along, towards) / (along.norm() * towards.norm());
}

/// Whether another viewpoint's claim takes the place away.
bool yields_to(const Claim& own, const Claim& other, SharedWalls shared) {
  if (shared != SharedWalls::squarest) return true;
  return own.squareness != other.squareness ? own.squareness < other.squareness : own.view > other.view;
}

/// What remains of a strip, in places on its edge.
std::vector<std::pair<double, double>> remaining(const Claim& own, const std::vector<Claim>& claims,
                                                 SharedWalls shared) {
  std::vector<std::pair<double, double>> parts{{own.from, own.to}};
  for (const Claim& other : claims) {
    if (other.view == own.view || !yields_to(own, other, shared)) continue;
    std::vector<std::pair<double, double>> kept;
    for (const auto& [from, to] : parts) {
      if (std::min(to, other.from) > from) kept.emplace_back(from, std::min(to, other.from));
      if (to > std::max(from, other.to)) kept.emplace_back(std::max(from, other.to), to);
    }
    parts.swap(kept);
  }
  return parts;
}

double width_mm(const WallPiece& piece, const PlanView& view, const Pillar& pillar) {
  double width = 0;
  for (const WallStrip& s : piece.strips)
    width += (corner(pillar.outline_mm, s.edge + 1) - corner(pillar.outline_mm, s.edge)).norm() *
             (place_on_edge(view, pillar, s.edge, s.to) - place_on_edge(view, pillar, s.edge, s.from));
  return width;
}

double covered(const std::vector<WallStrip>& strips) {
  double sum = 0;
  for (const WallStrip& s : strips) sum += s.to - s.from;
  return sum;
}

Error refused(const std::string& where, const std::string& sentence) {
  return {ErrorCode::invalid_input, where, sentence};
}

std::string number(int index) { return std::to_string(index + 1); }

/// Side by side on one pillar: on one edge, or around a corner.
bool follows(const WallStrip& before, const WallStrip& after, const Pillar& pillar) {
  if (before.pillar != after.pillar || before.to != after.from) return false;
  const int corners = static_cast<int>(pillar.outline_mm.size());
  return before.edge == after.edge || (before.edge + 1) % corners == after.edge;
}

std::vector<WallPiece> joined_to_pieces(const std::vector<WallStrip>& strips, const PlanView& view,
                                        std::span<const Pillar> pillars, double min_width_mm) {
  std::vector<WallPiece> pieces;
  for (const WallStrip& s : strips) {
    const Pillar& pillar = pillars[static_cast<std::size_t>(s.pillar)];
    if (!pieces.empty() && follows(pieces.back().strips.back(), s, pillar)) pieces.back().strips.push_back(s);
    else pieces.push_back({s.pillar, {s}});
  }
  std::erase_if(pieces, [&](const WallPiece& piece) {
    return width_mm(piece, view, pillars[static_cast<std::size_t>(piece.pillar)]) < min_width_mm;
  });
  return pieces;
}

using Claims = std::map<std::pair<int, int>, std::vector<Claim>>;  // by pillar and edge

std::vector<SharedWall> shared_walls(const Claims& claims) {
  std::vector<SharedWall> shared;
  for (const auto& [wall, all] : claims)
    for (const Claim& a : all)
      for (const Claim& b : all) {
        const double from = std::max(a.from, b.from), to = std::min(a.to, b.to);
        if (a.view < b.view && from < to) shared.push_back({wall.first, wall.second, from, to, {a.view, b.view}});
      }
  return shared;
}

}  // namespace

const WallStrip& WallPiece::strip_at(double t) const {
  for (const WallStrip& s : strips)
    if (t <= s.to) return s;
  return strips.back();
}

WallAssignment assign_walls(std::span<const PlanView> views, std::span<const Pillar> pillars,
                            const std::vector<std::vector<WallStrip>>& strips, SharedWalls shared,
                            double min_width_mm) {
  Claims claims;
  const auto claim_of = [&](std::size_t v, const WallStrip& s) {
    const Pillar& pillar = pillars[static_cast<std::size_t>(s.pillar)];
    Claim claim{static_cast<int>(v), place_on_edge(views[v], pillar, s.edge, s.from),
                place_on_edge(views[v], pillar, s.edge, s.to), 0};
    claim.squareness = squareness(views[v], pillar, s.edge, 0.5 * (claim.from + claim.to));
    return claim;
  };
  for (std::size_t v = 0; v < views.size(); ++v)
    for (const WallStrip& s : strips[v]) claims[{s.pillar, s.edge}].push_back(claim_of(v, s));

  WallAssignment result;
  result.shared = shared_walls(claims);
  for (std::size_t v = 0; v < views.size(); ++v) {
    const double range = views[v].to - views[v].from;
    if (strips[v].empty())
      throw refused("scene", "No line of sight from viewpoint " + number(static_cast<int>(v)) +
                                 " to its model meets a pillar: move the viewpoint, turn it round, or put pillars "
                                 "between it and what it looks at.");
    std::vector<WallStrip> own;
    for (const WallStrip& s : strips[v]) {
      const Pillar& pillar = pillars[static_cast<std::size_t>(s.pillar)];
      const Claim claim = claim_of(v, s);
      const std::vector<Claim>& all = claims[{s.pillar, s.edge}];
      if (shared == SharedWalls::refused)
        for (const Claim& other : all)
          if (other.view != claim.view && std::min(other.to, claim.to) > std::max(other.from, claim.from))
            throw refused("shared_walls", "Viewpoints " + number(std::min(claim.view, other.view)) + " and " +
                                              number(std::max(claim.view, other.view)) +
                                              " see the same side of pillar " + number(s.pillar) +
                                              ": move this pillar, or let such places be left bare.");
      const Vec2 &a = corner(pillar.outline_mm, s.edge), &b = corner(pillar.outline_mm, s.edge + 1);
      for (const auto& [from, to] : remaining(claim, all, shared)) {
        WallStrip part = s;
        if (from != claim.from) part.from = views[v].tangent(a + from * (b - a));
        if (to != claim.to) part.to = views[v].tangent(a + to * (b - a));
        if (part.from < part.to) own.push_back(part);
      }
    }
    result.seen_share.push_back(covered(strips[v]) / range);
    result.pieces.push_back(joined_to_pieces(own, views[v], pillars, min_width_mm));
    double used = 0;
    for (const WallPiece& piece : result.pieces.back()) used += covered(piece.strips);
    result.used_share.push_back(used / range);
    if (result.pieces.back().empty())
      throw refused("scene",
                    "Nothing is left for viewpoint " + number(static_cast<int>(v)) +
                        ": all pillars that it sees are seen by others, too. Move its pillars or the viewpoint.");
  }
  return result;
}

}  // namespace formwright
