// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/plan/pieces/splitting.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "geometry/mesh/adjacency.h"

namespace formwright {
namespace {

struct FaceBox {
  Vec2 lower = Vec2::Constant(1e300), upper = Vec2::Constant(-1e300);

  void add(const FaceBox& other) { lower = lower.cwiseMin(other.lower), upper = upper.cwiseMax(other.upper); }
  bool meets(const FaceBox& other, double margin) const {
    return (lower.array() <= other.upper.array() + margin).all() &&
           (other.lower.array() <= upper.array() + margin).all();
  }
};

/// A piece while it grows.
struct Growing {
  std::vector<int> faces;
  Polygon hull;
  FaceBox box;
};

class Overlaps {
 public:
  Overlaps(const Triangles& F, const std::vector<Vec2>& flat, double clearance_mm, const std::vector<int>& kind_of_face)
      : F_(F),
        flat_(flat),
        clearance_mm_(clearance_mm),
        kind_of_face_(kind_of_face),
        along_(flat.size() + 1, 0.0),
        boxes_(std::size_t(F.rows())) {
    for (std::size_t v = 0; v < flat.size(); ++v)
      along_[v + 1] = along_[v] + (flat[(v + 1) % flat.size()] - flat[v]).norm();
    for (int f = 0; f < F.rows(); ++f)
      for (int k = 0; k < 3; ++k) boxes_[f].add({corner(f, k), corner(f, k)});
  }

  const FaceBox& box(int f) const { return boxes_[f]; }
  bool alike(int f, int g) const { return kind_of_face_.empty() || kind_of_face_[f] == kind_of_face_[g]; }
  Polygon corners(int f) const { return {corner(f, 0), corner(f, 1), corner(f, 2)}; }

  /// May the two not be one piece?
  bool between(const Growing& a, const Growing& b) const {
    if (!alike(a.faces.front(), b.faces.front())) return true;
    for (const int f : a.faces) {
      if (!boxes_[f].meets(b.box, clearance_mm_)) continue;
      for (const int g : b.faces)
        if (boxes_[f].meets(boxes_[g], clearance_mm_) && between(f, g)) return true;
    }
    return false;
  }

 private:
  const Vec2& corner(int f, int k) const { return flat_[F_(f, k)]; }

  bool between(int f, int g) const {
    // Where the boundary leads from one to the other within a few millimetres or corners they may touch; elsewhere they
    // keep apart.
    constexpr int near_corners = 6;
    double nearest = 1e300;
    int corners = std::numeric_limits<int>::max();
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) {
        const double gap = std::abs(along_[F_(f, j)] - along_[F_(g, k)]);
        nearest = std::min({nearest, gap, along_.back() - gap});
        const int count = std::abs(F_(f, j) - F_(g, k));
        corners = std::min({corners, count, static_cast<int>(flat_.size()) - count});
      }
    const double touching_mm = nearest <= 4 * clearance_mm_ || corners <= near_corners ? 1e-7 : -clearance_mm_;
    return triangles_overlap({corner(f, 0), corner(f, 1), corner(f, 2)}, {corner(g, 0), corner(g, 1), corner(g, 2)},
                             touching_mm);
  }

  const Triangles& F_;
  const std::vector<Vec2>& flat_;
  double clearance_mm_;
  const std::vector<int>& kind_of_face_;
  std::vector<double> along_;  // per vertex: place on the boundary; the last is its length
  std::vector<FaceBox> boxes_;
};

/// Triangles from an end of the ribbon on, each before its neighbours that are farther away, and the half-edge that
/// leads back.
struct Tree {
  std::vector<int> order, parent_halfedge;
};

Tree tree_of(const Adjacency& adjacency, int root) {
  Tree tree;
  tree.parent_halfedge.assign(std::size_t(adjacency.face_count()), -1);
  tree.order.push_back(root);
  for (std::size_t i = 0; i < tree.order.size(); ++i)
    for (int h = 3 * tree.order[i]; h < 3 * tree.order[i] + 3; ++h) {
      const int o = adjacency.opposite(h);
      if (o < 0 || h == tree.parent_halfedge[tree.order[i]]) continue;
      tree.parent_halfedge[o / 3] = o;
      tree.order.push_back(o / 3);
    }
  return tree;
}

/// Triangles with one neighbour at most.
std::vector<int> ends_of(const Adjacency& adjacency) {
  std::vector<int> ends;
  for (int f = 0; f < adjacency.face_count(); ++f) {
    int neighbours = 0;
    for (int h = 3 * f; h < 3 * f + 3; ++h) neighbours += adjacency.opposite(h) >= 0;
    if (neighbours <= 1) ends.push_back(f);
  }
  return ends;
}

void sort_along_boundary(std::vector<RibbonSplit>& splits) {
  std::sort(splits.begin(), splits.end(), [](const RibbonSplit& a, const RibbonSplit& b) {
    const auto key = [](const RibbonSplit& s) { return std::pair(std::min(s.from, s.to), std::max(s.from, s.to)); };
    return key(a) < key(b);
  });
}

Splitting split_towards(int root, const Adjacency& adjacency, const Overlaps& overlaps,
                        const std::function<bool(const Polygon&)>& fits, Context& context) {
  const Tree tree = tree_of(adjacency, root);
  const std::size_t count = tree.order.size();
  std::vector<Growing> growing(count);
  std::vector<std::vector<int>> children(count);
  std::vector<char> is_top(count, 0);  // of a finished piece
  for (std::size_t i = count; i-- > 0;) {
    const int face = tree.order[i];
    if (i % 64 == 0) context.progress(1 - static_cast<double>(i) / static_cast<double>(count));
    Growing mine{{face}, convex_hull(overlaps.corners(face)), overlaps.box(face)};
    if (!fits(mine.hull))
      throw Error(ErrorCode::invalid_input, "bed_x_mm",
                  "The ribbon is wider than the bed: give a larger bed or a narrower ribbon.");
    // The largest first: what cannot be joined is cut off and done with.
    std::stable_sort(children[face].begin(), children[face].end(),
                     [&](int a, int b) { return growing[a].faces.size() > growing[b].faces.size(); });
    for (const int child : children[face]) {
      Growing& other = growing[child];
      Polygon both = mine.hull;
      both.insert(both.end(), other.hull.begin(), other.hull.end());
      both = convex_hull(std::move(both));
      if (!fits(both) || overlaps.between(mine, other)) {
        is_top[child] = 1;
        continue;
      }
      if (mine.faces.size() < other.faces.size()) std::swap(mine.faces, other.faces);
      mine.faces.insert(mine.faces.end(), other.faces.begin(), other.faces.end());
      mine.hull = std::move(both);
      mine.box.add(other.box);
      other = {};
    }
    growing[face] = std::move(mine);
    if (const int h = tree.parent_halfedge[face]; h >= 0) children[adjacency.opposite(h) / 3].push_back(face);
    else is_top[face] = 1;
  }
  Splitting result;
  result.piece_of_face.assign(count, -1);
  for (const int face : tree.order) {
    const int h = tree.parent_halfedge[face];
    result.piece_of_face[face] = is_top[face] ? result.piece_count++ : result.piece_of_face[adjacency.opposite(h) / 3];
    if (is_top[face] && h >= 0)
      result.splits.push_back({adjacency.from(h), adjacency.to(h), result.piece_of_face[face],
                               result.piece_of_face[adjacency.opposite(h) / 3]});
  }
  sort_along_boundary(result.splits);
  return result;
}

/// Joins pieces that are too small to others, or moves the splits beside them.
class CrumbSweeper {
 public:
  CrumbSweeper(const Adjacency& adjacency, const Overlaps& overlaps, const std::function<bool(const Polygon&)>& fits,
               double min_area_mm2, Splitting& splitting)
      : adjacency_(adjacency),
        overlaps_(overlaps),
        fits_(fits),
        min_area_mm2_(min_area_mm2),
        splitting_(splitting),
        pieces_(std::size_t(splitting.piece_count)),
        area_mm2_(pieces_.size(), 0.0) {
    for (int f = 0; f < adjacency.face_count(); ++f) add(splitting.piece_of_face[f], f);
  }

  void sweep(Context& context) {
    for (int piece = 0; piece < splitting_.piece_count; ++piece) {
      context.check_cancelled();
      if (area_mm2_[piece] >= min_area_mm2_ || merge(piece)) continue;
      // At every split of it in turn: half-edges of its triangles that lead to another piece.
      for (const int h : exits(piece))
        if (grow(piece, h)) break;
    }
    if (splitting_.merged_crumbs + splitting_.moved_splits > 0) renumber();
  }

 private:
  std::vector<int> exits(int piece) const {
    std::vector<int> gaps;
    for (const int f : pieces_[piece].faces)
      for (int h = 3 * f; h < 3 * f + 3; ++h)
        if (const int o = adjacency_.opposite(h); o >= 0 && splitting_.piece_of_face[o / 3] != piece) gaps.push_back(h);
    return gaps;
  }

  void add(int piece, int face) {
    Growing& growing = pieces_[piece];
    growing.faces.push_back(face);
    const Polygon corners = overlaps_.corners(face);
    growing.hull.insert(growing.hull.end(), corners.begin(), corners.end());
    growing.hull = convex_hull(std::move(growing.hull));
    growing.box.add(overlaps_.box(face));
    area_mm2_[piece] += signed_area_mm2(corners);
    splitting_.piece_of_face[face] = piece;
  }

  bool may_be_one(const Growing& a, const Growing& b) const {
    Polygon both = a.hull;
    both.insert(both.end(), b.hull.begin(), b.hull.end());
    return fits_(convex_hull(std::move(both))) && !overlaps_.between(a, b);
  }

  bool merge(int piece) {
    for (const int h : exits(piece)) {
      const int other = splitting_.piece_of_face[adjacency_.opposite(h) / 3];
      if (!may_be_one(pieces_[piece], pieces_[other])) continue;
      for (const int face : pieces_[piece].faces) add(other, face);
      pieces_[piece] = {};
      area_mm2_[piece] = 0;
      ++splitting_.merged_crumbs;
      return true;
    }
    return false;
  }

  /// Takes triangles from the piece beyond half-edge h as long as it stays in one part; all or none.
  bool grow(int piece, int h) {
    const int other = splitting_.piece_of_face[adjacency_.opposite(h) / 3];
    Growing grown = pieces_[piece];
    double area = area_mm2_[piece], rest = area_mm2_[other];
    std::vector<int> taken;
    for (int into = adjacency_.opposite(h); area < min_area_mm2_;) {
      const int face = into / 3;
      const Growing next{{face}, convex_hull(overlaps_.corners(face)), overlaps_.box(face)};
      const double face_mm2 = signed_area_mm2(overlaps_.corners(face));
      if (rest - face_mm2 < min_area_mm2_ || !may_be_one(grown, next)) return false;
      grown.faces.push_back(face);
      grown.hull.insert(grown.hull.end(), next.hull.begin(), next.hull.end());
      grown.hull = convex_hull(std::move(grown.hull));
      grown.box.add(next.box);
      area += face_mm2, rest -= face_mm2;
      taken.push_back(face);
      const std::vector<int> onward = exits_on(face, into);
      if (onward.empty()) return false;
      if (onward.size() == 2) {  // a branch: all beyond one of its sides comes along, lest the rest be two parts
        if (!take_a_side(onward, grown, rest, taken)) return false;
        break;
      }
      into = onward.front();
    }
    for (const int face : taken) add(piece, face);
    const std::vector<int> before = std::move(pieces_[other].faces);
    pieces_[other] = {};
    area_mm2_[other] = 0;
    for (const int face : before)
      if (splitting_.piece_of_face[face] == other) add(other, face);
    ++splitting_.moved_splits;
    return true;
  }

  /// Half-edges of the same piece's triangles beside this one, except for `into`, its own.
  std::vector<int> exits_on(int face, int into) const {
    std::vector<int> gaps;
    for (int g = 3 * face; g < 3 * face + 3; ++g)
      if (const int o = adjacency_.opposite(g);
          g != into && o >= 0 && splitting_.piece_of_face[o / 3] == splitting_.piece_of_face[face])
        gaps.push_back(o);
    return gaps;
  }

  bool take_a_side(const std::vector<int>& sides, const Growing& grown, double rest_mm2,
                   std::vector<int>& taken) const {
    for (const int first : sides) {
      Growing side;
      double area = 0;
      for (std::vector<int> open{first}; !open.empty();) {
        const int into = open.back(), face = into / 3;
        open.pop_back();
        side.faces.push_back(face);
        side.box.add(overlaps_.box(face));
        const Polygon corners = overlaps_.corners(face);
        side.hull.insert(side.hull.end(), corners.begin(), corners.end());
        area += signed_area_mm2(corners);
        const std::vector<int> onward = exits_on(face, into);
        open.insert(open.end(), onward.begin(), onward.end());
      }
      if (rest_mm2 - area < min_area_mm2_ || !may_be_one(grown, side)) continue;
      taken.insert(taken.end(), side.faces.begin(), side.faces.end());
      return true;
    }
    return false;
  }

  void renumber() {
    std::vector<int> number(pieces_.size(), -1);
    splitting_.piece_count = 0;
    for (std::size_t piece = 0; piece < pieces_.size(); ++piece)
      if (!pieces_[piece].faces.empty()) number[piece] = splitting_.piece_count++;
    for (int& piece : splitting_.piece_of_face) piece = number[piece];
    splitting_.splits.clear();
    for (int h = 0; h < 3 * adjacency_.face_count(); ++h)
      if (const int o = adjacency_.opposite(h), a = splitting_.piece_of_face[h / 3];
          o > h && splitting_.piece_of_face[o / 3] != a)
        splitting_.splits.push_back({adjacency_.from(h), adjacency_.to(h), a, splitting_.piece_of_face[o / 3]});
    sort_along_boundary(splitting_.splits);
  }

  const Adjacency& adjacency_;
  const Overlaps& overlaps_;
  const std::function<bool(const Polygon&)>& fits_;
  double min_area_mm2_;
  Splitting& splitting_;
  std::vector<Growing> pieces_;
  std::vector<double> area_mm2_;
};

}  // namespace

Splitting split_ribbon(const Triangles& F, const std::vector<Vec2>& flat,
                       const std::function<bool(const Polygon&)>& fits, double clearance_mm, double min_area_mm2,
                       Context& context, const std::vector<int>& kind_of_face) {
  constexpr std::size_t max_tries = 8;
  TriangleMesh mesh;
  mesh.V = Positions::Zero(static_cast<Eigen::Index>(flat.size()), 3);
  mesh.F = F;
  const Adjacency adjacency(mesh);
  const Overlaps overlaps(F, flat, clearance_mm, kind_of_face);
  const auto smallest_mm2 = [&](const Splitting& splitting) {
    std::vector<double> area(std::size_t(splitting.piece_count), 0.0);
    for (int f = 0; f < F.rows(); ++f) area[splitting.piece_of_face[f]] += signed_area_mm2(overlaps.corners(f));
    return *std::min_element(area.begin(), area.end());
  };
  const std::vector<int> ends = ends_of(adjacency);
  const std::size_t tries = std::min(max_tries, ends.size());
  std::pair<int, double> best_value;
  Splitting best;
  for (std::size_t i = 0; i < tries; ++i) {
    const auto span = context.span(static_cast<double>(i) / static_cast<double>(tries),
                                   static_cast<double>(i + 1) / static_cast<double>(tries), "Splitting");
    Splitting splitting = split_towards(ends[i * ends.size() / tries], adjacency, overlaps, fits, context);
    CrumbSweeper(adjacency, overlaps, fits, min_area_mm2, splitting).sweep(context);
    const std::pair value(-splitting.piece_count, smallest_mm2(splitting));
    if (i == 0 || value > best_value) best = std::move(splitting), best_value = value;
    if (best.piece_count == 1) break;
  }
  return best;
}

}  // namespace formwright
