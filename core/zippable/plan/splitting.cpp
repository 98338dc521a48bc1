// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/plan/splitting.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "geometry/adjacency.h"

namespace formwright {
namespace {

struct Box {
  Vec2 lower = Vec2::Constant(1e300), upper = Vec2::Constant(-1e300);

  void add(const Box& other) { lower = lower.cwiseMin(other.lower), upper = upper.cwiseMax(other.upper); }
  bool meets(const Box& other, double margin) const {
    return (lower.array() <= other.upper.array() + margin).all() && (other.lower.array() <= upper.array() + margin).all();
  }
};

/// A piece while it grows.
struct Growing {
  std::vector<int> faces;
  Polygon hull;
  Box box;
};

class Overlaps {
 public:
  Overlaps(const Triangles& F, const std::vector<Vec2>& flat, double clearance_mm)
      : F_(F), flat_(flat), clearance_mm_(clearance_mm), along_(flat.size() + 1, 0.0), boxes_(std::size_t(F.rows())) {
    for (std::size_t v = 0; v < flat.size(); ++v) along_[v + 1] = along_[v] + (flat[(v + 1) % flat.size()] - flat[v]).norm();
    for (int f = 0; f < F.rows(); ++f)
      for (int k = 0; k < 3; ++k) boxes_[f].add({corner(f, k), corner(f, k)});
  }

  const Box& box(int f) const { return boxes_[f]; }
  Polygon corners(int f) const { return {corner(f, 0), corner(f, 1), corner(f, 2)}; }

  bool between(const Growing& a, const Growing& b) const {
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
    // Where the boundary leads from one to the other within a few millimetres or corners they may touch; elsewhere they keep apart.
    constexpr int near_corners = 6;
    double nearest = 1e300;
    int corners = std::numeric_limits<int>::max();
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) {
        const double way = std::abs(along_[F_(f, j)] - along_[F_(g, k)]);
        nearest = std::min({nearest, way, along_.back() - way});
        const int count = std::abs(F_(f, j) - F_(g, k));
        corners = std::min({corners, count, static_cast<int>(flat_.size()) - count});
      }
    const double touching_mm = nearest <= 4 * clearance_mm_ || corners <= near_corners ? 1e-7 : -clearance_mm_;
    return triangles_overlap({corner(f, 0), corner(f, 1), corner(f, 2)}, {corner(g, 0), corner(g, 1), corner(g, 2)}, touching_mm);
  }

  const Triangles& F_;
  const std::vector<Vec2>& flat_;
  double clearance_mm_;
  std::vector<double> along_;  // per vertex: place on the boundary; the last is its length
  std::vector<Box> boxes_;
};

/// Triangles from an end of the ribbon on, each before its neighbours that are farther away, and the half-edge that leads back.
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

Splitting split_towards(int root, const Adjacency& adjacency, const Overlaps& overlaps, const std::function<bool(const Polygon&)>& fits,
                        Context& context) {
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
      throw Error(ErrorCode::invalid_input, "bed_x_mm", "The ribbon is wider than the bed: give a larger bed or a narrower ribbon.");
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
      result.splits.push_back({adjacency.from(h), adjacency.to(h), result.piece_of_face[face], result.piece_of_face[adjacency.opposite(h) / 3]});
  }
  std::sort(result.splits.begin(), result.splits.end(), [](const RibbonSplit& a, const RibbonSplit& b) {
    const auto key = [](const RibbonSplit& s) { return std::pair(std::min(s.from, s.to), std::max(s.from, s.to)); };
    return key(a) < key(b);
  });
  return result;
}

}  // namespace

Splitting split_ribbon(const Triangles& F, const std::vector<Vec2>& flat, const std::function<bool(const Polygon&)>& fits,
                       double clearance_mm, Context& context) {
  constexpr std::size_t most_tries = 8;
  TriangleMesh mesh;
  mesh.V = Positions::Zero(static_cast<Eigen::Index>(flat.size()), 3);
  mesh.F = F;
  const Adjacency adjacency(mesh);
  const Overlaps overlaps(F, flat, clearance_mm);
  const auto smallest_mm2 = [&](const Splitting& splitting) {
    std::vector<double> area(std::size_t(splitting.piece_count), 0.0);
    for (int f = 0; f < F.rows(); ++f) area[splitting.piece_of_face[f]] += signed_area_mm2(overlaps.corners(f));
    return *std::min_element(area.begin(), area.end());
  };
  const std::vector<int> ends = ends_of(adjacency);
  const std::size_t tries = std::min(most_tries, ends.size());
  std::pair<int, double> best_value;
  Splitting best;
  for (std::size_t i = 0; i < tries; ++i) {
    const auto span = context.span(static_cast<double>(i) / static_cast<double>(tries), static_cast<double>(i + 1) / static_cast<double>(tries), "Splitting");
    Splitting splitting = split_towards(ends[i * ends.size() / tries], adjacency, overlaps, fits, context);
    const std::pair value(-splitting.piece_count, smallest_mm2(splitting));
    if (i == 0 || value > best_value) best = std::move(splitting), best_value = value;
    if (best.piece_count == 1) break;
  }
  return best;
}

}  // namespace formwright
