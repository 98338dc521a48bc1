// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/plan/pieces/glue_tabs.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace formwright {
namespace {

using Triangle = std::array<Vec2, 3>;

struct TriangleBox {
  Vec2 lower = Vec2::Constant(1e300), upper = Vec2::Constant(-1e300);

  explicit TriangleBox(const Triangle& triangle) {
    for (const Vec2& p : triangle) lower = lower.cwiseMin(p), upper = upper.cwiseMax(p);
  }
  bool near(const TriangleBox& other, double margin) const {
    return (lower.array() <= other.upper.array() + margin).all() &&
           (other.lower.array() <= upper.array() + margin).all();
  }
};

struct Obstacle {
  Triangle triangle;
  TriangleBox box;
  int face = -1;  // of the ribbon, or of a tab
};

class TabMaker {
 public:
  TabMaker(const FlatDesign& design, const std::vector<Vec2>& flat, const Splitting& splitting,
           const GlueTabOptions& options)
      : design_(design), flat_(flat), options_(options), obstacles_(std::size_t(splitting.piece_count)) {
    for (int f = 0; f < design.F.rows(); ++f) {
      const Triangle triangle{flat[design.F(f, 0)], flat[design.F(f, 1)], flat[design.F(f, 2)]};
      obstacles_[splitting.piece_of_face[f]].push_back({triangle, TriangleBox(triangle), f});
    }
  }

  /// A tab on the stretch of the zipper, on one piece on either side; two on its halves where the edge is too curved
  /// for one.
  void add(const Seam& seam, double from_mm, double to_mm, int depth) {
    constexpr double min_mm = 3;
    constexpr int max_halvings = 5;
    if (to_mm - from_mm < min_mm) {
      ++result.left_out;
      return;
    }
    for (const double share : {1.0, 0.6, 0.35})
      for (const bool left : {true, false}) {
        GlueTab tab = foot(left, from_mm, to_mm);
        tab.piece = left ? seam.piece : seam.other_piece;
        const auto outward = bulge_mm(tab);
        if (outward > 0.15 * options_.depth_mm && depth < max_halvings) continue;
        if (!stands(tab, share * options_.depth_mm, std::max(outward, 0.0))) continue;
        result.shortened += share < 1;
        for (const Triangle& triangle : triangles_of(tab))
          obstacles_[tab.piece].push_back({triangle, TriangleBox(triangle), -1});
        result.tabs.push_back(tab);
        return;
      }
    if (depth < max_halvings && (to_mm - from_mm) / 2 >= min_mm) {
      const double middle = (from_mm + to_mm) / 2;
      add(seam, from_mm, middle, depth + 1);
      add(seam, middle, to_mm, depth + 1);
    } else {
      ++result.left_out;
    }
  }

  GlueTabs result;

 private:
  GlueTab foot(bool left, double from_mm, double to_mm) const {
    // A hair inside, so that a corner of the edge belongs to this stretch and not to the next one.
    const double hair = 1e-9 * (to_mm - from_mm);
    const SideMark a = side_mark(design_, flat_, left, (left ? from_mm : to_mm) + (left ? hair : -hair)),
                   b = side_mark(design_, flat_, left, (left ? to_mm : from_mm) + (left ? -hair : hair));
    GlueTab tab;
    tab.left = left;
    tab.from_edge = a.edge, tab.to_edge = b.edge;
    tab.foot_from = a.flat_mm, tab.foot_to = b.flat_mm;
    tab.from_mm = from_mm, tab.to_mm = to_mm;
    return tab;
  }

  /// How far the edge stands out of the straight foot, to either side.
  double bulge_mm(const GlueTab& tab) const {
    const Vec2 along = (tab.foot_to - tab.foot_from).normalized(), out(along.y(), -along.x());
    double bulge = 0;
    for (int v = tab.from_edge; v != tab.to_edge;) {
      v = design_.next(v);
      bulge = std::max(bulge, std::abs(out.dot(flat_[v] - tab.foot_from)));
    }
    return bulge;
  }

  /// Gives the tab its corners; does it stand clear of everything on its piece?
  bool stands(GlueTab& tab, double depth, double bulge) const {
    const Vec2 segment = tab.foot_to - tab.foot_from;
    const double length = segment.norm();
    if (!(length > 1e-6) || bulge > 0.3 * depth) return false;
    const Vec2 u = segment / length, out(u.y(), -u.x());
    const double taper = std::min(depth, length / 4);
    const auto at = [&](bool from, double height) {
      return Vec2((from ? tab.foot_from : tab.foot_to) + height * out + (from ? 1 : -1) * taper * height / depth * u);
    };
    tab.corner_from = at(true, depth), tab.corner_to = at(false, depth);
    // Its lower part may touch what it grows from and the next tabs, its upper part keeps clear of all.
    const double knee = 0.4 * depth, low = std::min(bulge + 1e-6, knee);
    const auto parts = [&](double from, double to) {
      return std::array<Triangle, 2>{Triangle{at(true, from), at(false, from), at(false, to)},
                                     Triangle{at(true, from), at(false, to), at(true, to)}};
    };
    const auto lower = parts(low, knee), upper = parts(knee, depth);
    const auto meets = [&](const std::array<Triangle, 2>& part, const Obstacle& other, double touching_mm) {
      return std::any_of(part.begin(), part.end(), [&](const Triangle& t) {
        return TriangleBox(t).near(other.box, options_.clearance_mm) &&
               triangles_overlap(t, other.triangle, touching_mm);
      });
    };
    return std::none_of(obstacles_[tab.piece].begin(), obstacles_[tab.piece].end(), [&](const Obstacle& other) {
      return meets(upper, other, -options_.clearance_mm) ||
             meets(lower, other, beside(tab, other) ? 1e-7 : -options_.clearance_mm);
    });
  }

  bool beside(const GlueTab& tab, const Obstacle& other) const {
    if (other.face < 0) {
      return std::any_of(other.triangle.begin(), other.triangle.end(), [&](const Vec2& p) {
        return std::min((p - tab.foot_from).norm(), (p - tab.foot_to).norm()) < 1e-6;
      });
    }
    // A triangle with a corner at the foot, from the vertex before it to the one behind it.
    const int count = design_.vertex_count(), length = (tab.to_edge - tab.from_edge + count) % count + 1;
    for (int k = 0; k < 3; ++k)
      if ((design_.F(other.face, k) - tab.from_edge + count) % count <= length) return true;
    return false;
  }

  const FlatDesign& design_;
  const std::vector<Vec2>& flat_;
  GlueTabOptions options_;
  std::vector<std::vector<Obstacle>> obstacles_;  // per piece
};

}  // namespace

std::array<std::array<Vec2, 3>, 2> triangles_of(const GlueTab& tab) {
  return {{{tab.foot_from, tab.corner_to, tab.foot_to}, {tab.foot_from, tab.corner_from, tab.corner_to}}};
}

GlueTabs make_glue_tabs(const FlatDesign& design, const std::vector<Vec2>& flat, const Splitting& splitting,
                        const std::vector<Seam>& seams, const GlueTabOptions& options, const Context& context) {
  TabMaker maker(design, flat, splitting, options);
  for (const Seam& seam : seams) {
    if (seam.kind != SeamKind::edge) continue;
    const int count = std::max(1, static_cast<int>(std::ceil(seam.tape_mm() / options.length_mm - 1e-9)));
    for (int i = 0; i < count; ++i) {
      context.check_cancelled();
      maker.add(seam, seam.from_mm + seam.tape_mm() * i / count, seam.from_mm + seam.tape_mm() * (i + 1) / count, 0);
    }
  }
  return std::move(maker.result);
}

}  // namespace formwright
