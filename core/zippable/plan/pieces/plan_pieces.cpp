// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/plan/pieces/plan_pieces.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "geometry/planar/plane.h"
#include "fabrication/sheet/word_paths.h"
#include "geometry/mesh/adjacency.h"

namespace formwright {
namespace {

class PieceMaker {
 public:
  PieceMaker(const Triangles& F, const std::vector<Vec2>& flat, const Splitting& splitting,
             const std::optional<GlueTabs>& tabs, const std::vector<EdgeFlap>& flaps, double allowance_mm,
             double kerf_mm, double text_height_mm, PlanPieces& result)
      : F_(F),
        flat_(flat),
        splitting_(splitting),
        has_tabs_(tabs.has_value()),
        allowance_mm_(allowance_mm),
        kerf_mm_(kerf_mm),
        text_height_mm_(text_height_mm),
        result_(result),
        faces_(std::size_t(splitting.piece_count)),
        texts_(faces_.size()) {
    TriangleMesh mesh;
    mesh.V = Positions::Zero(static_cast<Eigen::Index>(flat.size()), 3);
    mesh.F = F;
    const Adjacency adjacency(mesh);
    next_.resize(faces_.size());
    for (int f = 0; f < F.rows(); ++f) {
      const int piece = splitting.piece_of_face[f];
      faces_[piece].push_back(f);
      for (int h = 3 * f; h < 3 * f + 3; ++h) {
        const int o = adjacency.opposite(h);
        if (o >= 0 && splitting.piece_of_face[o / 3] == piece) continue;
        next_[piece][adjacency.from(h)] = {adjacency.to(h), o >= 0};
        if (o < 0) face_of_edge_[adjacency.from(h)] = f;
      }
    }
    if (tabs)
      for (const GlueTab& tab : tabs->tabs) {
        tabs_[tab.from_edge].push_back(&tab);
        for (const auto& triangle : triangles_of(tab)) tab_triangles_[tab.piece].push_back(triangle);
      }
    for (auto& [edge, list] : tabs_) {
      const Vec2 start = flat[edge];
      std::sort(list.begin(), list.end(), [&](const GlueTab* a, const GlueTab* b) {
        return (a->foot_from - start).norm() < (b->foot_from - start).norm();
      });
    }
    for (const EdgeFlap& flap : flaps) {
      flaps_[flap.from_vertex] = &flap;
      for (const auto& triangle : flap.triangles) tab_triangles_[flap.piece].push_back(triangle);
    }
    for (std::size_t s = 0; s < splitting.splits.size(); ++s) {
      const RibbonSplit& split = splitting.splits[s];
      letters_[{split.left, split.from}] = letters_[{split.right, split.to}] = split_letters(static_cast<int>(s));
    }
  }

  void outline(int piece) {
    PlanPiece& made = result_.pieces[piece];
    made.name = "P" + std::to_string(piece + 1);
    for (const int f : faces_[piece])
      made.ribbon_area_mm2 += cross(flat_[F_(f, 1)] - flat_[F_(f, 0)], flat_[F_(f, 2)] - flat_[F_(f, 0)]) / 2;
    // Not from a vertex in the middle of a tab's foot.
    std::set<int> covered;
    for (const auto& [edge, list] : tabs_)
      for (const GlueTab* tab : list)
        if (tab->piece == piece)
          for (int w = edge; w != tab->to_edge;) covered.insert(w = next_[piece].at(w).first);
    for (const auto& [from, flap] : flaps_)
      if (flap->piece == piece)
        for (int w = next_[piece].at(from).first; w != flap->to_vertex; w = next_[piece].at(w).first) covered.insert(w);
    int first = next_[piece].begin()->first;
    while (covered.contains(first)) first = next_[piece].at(first).first;
    int v = first;
    do {
      const auto [to, split] = next_[piece].at(v);
      if (!covered.contains(v)) add_corner(made.outline_mm, flat_[v]);
      if (const auto list = tabs_.find(v); list != tabs_.end())
        for (const GlueTab* tab : list->second)
          if (tab->piece == piece) add_tab(piece, *tab);
      if (const auto flap = flaps_.find(v); flap != flaps_.end() && flap->second->piece == piece)
        for (const Vec2& corner : flap->second->outer_mm) made.outline_mm.push_back(corner);
      if (split) {
        for (const Vec2& corner : allowance(piece, v, to)) made.outline_mm.push_back(corner);
        const Vec2 u = (flat_[to] - flat_[v]).normalized();
        made.marks.push_back(
            {CutLayer::mark, {flat_[v], flat_[to]}, false, "split-" + letters_.at({piece, v}) + "-" + made.name});
        text(piece, (flat_[v] + flat_[to]) / 2, u, letters_.at({piece, v}), 0.6 * text_height_mm_);
      }
      v = to;
    } while (v != first);
    const std::vector<Vec2> steps =
        offset_steps(made.outline_mm, std::vector<double>(made.outline_mm.size(), -kerf_mm_ / 2));
    for (std::size_t i = 0; i < steps.size(); ++i) made.cut_mm.push_back(made.outline_mm[i] + steps[i]);
    name_piece(piece);
  }

  /// A tab's corners instead of its foot, where it is folded.
  void add_tab(int piece, const GlueTab& tab) {
    PlanPiece& made = result_.pieces[piece];
    for (const Vec2& corner : {tab.foot_from, tab.corner_from, tab.corner_to, tab.foot_to})
      add_corner(made.outline_mm, corner);
    CutPath fold{CutLayer::mark, {tab.foot_from}, false, "tab-" + std::to_string(++tab_number_)};
    for (int w = tab.from_edge; w != tab.to_edge;) add_corner(fold.points_mm, flat_[w = next_[piece].at(w).first]);
    add_corner(fold.points_mm, tab.foot_to);
    made.marks.push_back(std::move(fold));
  }

  void marker(const SideMark& mark, const std::string& words, const std::string& name) {
    const int piece = splitting_.piece_of_face[face_of_edge_.at(mark.edge)];
    constexpr double length_mm = 2;
    double length = length_mm;
    while (length > length_mm / 8 && !inside(piece, mark.flat_mm + length * mark.inward)) length /= 2;
    Vec2 end = mark.flat_mm + length * mark.inward;
    if (!inside(piece, end)) {  // in a sharp corner: into the triangle at the edge
      const int f = face_of_edge_.at(mark.edge);
      const Vec2 middle = (flat_[F_(f, 0)] + flat_[F_(f, 1)] + flat_[F_(f, 2)]) / 3 - mark.flat_mm;
      end = mark.flat_mm + std::min(1.0, length_mm / std::max(middle.norm(), 1e-9)) * middle;
    }
    result_.pieces[piece].marks.push_back({CutLayer::mark, {mark.flat_mm, end}, false, name});
    text(piece, mark.flat_mm + (length + 0.4) * mark.inward, mark.along, words, 0);
  }

  /// Where the tape goes, the edge of what lies below, and their names, twice where that is long.
  void closure(const PieceClosures& closures) {
    const ClosureMarks& marks = *closures.marks;
    for (const ClosureMarker& marker_of : marks.markers)
      for (const ClosureSide side : {ClosureSide::hook, ClosureSide::loop}) {
        const std::string number = std::to_string(marker_of.cut) + "-" + std::to_string(marker_of.number);
        marker(marker_of.sides[static_cast<std::size_t>(side)], number,
               "closure-" + number + (side == ClosureSide::hook ? "-hook" : "-loop"));
      }
    int count = 0;
    for (const TapeEdge& edge : marks.tape_edges)
      result_.pieces[edge.piece].marks.push_back(
          {CutLayer::mark, edge.points_mm, false, "hook-" + std::to_string(edge.cut) + "-" + std::to_string(++count)});
    count = 0;
    for (const ClosureStretch& stretch : marks.stretches) {
      constexpr double every_mm = 200;
      CutPath path{CutLayer::mark, {}, false, "loop-" + std::to_string(stretch.cut) + "-" + std::to_string(++count)};
      for (const int v : stretch.vertices) path.points_mm.push_back(flat_[v]);
      double length = 0;
      for (std::size_t i = 0; i + 1 < path.points_mm.size(); ++i)
        length += (path.points_mm[i + 1] - path.points_mm[i]).norm();
      const int labels = std::max(1, static_cast<int>(std::lround(length / every_mm)));
      double done = 0;
      int written = 0;
      for (std::size_t i = 0; i + 1 < path.points_mm.size() && written < labels; ++i) {
        const Vec2 segment = path.points_mm[i + 1] - path.points_mm[i];
        const double step = segment.norm(), wanted = length * (written + 0.5) / labels;
        // Behind the numbers, which stand 2.4 mm from the edge.
        if (done + step >= wanted && step > 0)
          text(stretch.piece, path.points_mm[i] + (wanted - done) / step * segment, segment / step,
               closure_words(stretch.cut, stretch.side, closures.tape), 3.4 + text_height_mm_),
              ++written;
        done += step;
      }
      const bool below = std::any_of(marks.flaps.begin(), marks.flaps.end(),
                                     [&](const EdgeFlap& flap) { return flap.piece == stretch.piece; });
      if (stretch.side == ClosureSide::loop && below) result_.pieces[stretch.piece].marks.push_back(std::move(path));
    }
  }

 private:
  /// Neighbouring tabs meet in one corner; where a foot ends just before a corner of the edge, growing by the kerf
  /// would turn the short edge between them over.
  void add_corner(Polygon& polygon, const Vec2& corner) const {
    if (polygon.empty() || !has_tabs_ || (polygon.back() - corner).norm() > std::max(0.02, 0.75 * kerf_mm_))
      polygon.push_back(corner);
  }

  bool inside(int piece, const Vec2& p) const {
    return std::any_of(faces_[piece].begin(), faces_[piece].end(), [&](int f) {
      for (int k = 0; k < 3; ++k) {
        const Vec2 &a = flat_[F_(f, k)], &b = flat_[F_(f, (k + 1) % 3)];
        if (cross(b - a, p - a) < 0) return false;
      }
      return true;
    });
  }

  /// What is added beyond the split from a to b: two corners, none where it would meet the piece.
  Polygon allowance(int piece, int from, int to) {
    const Vec2 a = flat_[from], b = flat_[to], along = b - a;
    const double length = along.norm();
    const bool other_has_it =
        has_tabs_ && std::none_of(splitting_.splits.begin(), splitting_.splits.end(), [&](const RibbonSplit& split) {
          return split.left == piece && split.from == from && split.to == to;
        });
    if (!(length > 0) || other_has_it) return {};
    const Vec2 u = along / length, out(u.y(), -u.x());
    for (const double share : {1.0, 0.5, 0.25}) {
      const double depth = share * allowance_mm_, taper = std::min(depth, length / 4);
      if (!(depth > 0)) return {};
      const Vec2 c = b + depth * out - taper * u, d = a + depth * out + taper * u;
      const bool meets = std::any_of(faces_[piece].begin(), faces_[piece].end(), [&](int f) {
        const bool beside = (F_.row(f).array() == from || F_.row(f).array() == to).any();
        const double touching_mm = beside ? 1e-7 : -(kerf_mm_ + 0.1);
        const std::array<Vec2, 3> face{flat_[F_(f, 0)], flat_[F_(f, 1)], flat_[F_(f, 2)]};
        return triangles_overlap({a, c, b}, face, touching_mm) || triangles_overlap({a, d, c}, face, touching_mm);
      });
      const bool meets_tab =
          std::any_of(tab_triangles_[piece].begin(), tab_triangles_[piece].end(), [&](const auto& tab) {
            return triangles_overlap({a, c, b}, tab, 1e-7) || triangles_overlap({c, d, a}, tab, -(kerf_mm_ + 0.1));
          });
      if (!meets && !meets_tab) {
        result_.shortened_allowances += share < 1;
        return {d, c};
      }
    }
    ++result_.shortened_allowances;
    return {};
  }

  /// Words begin `clear_mm` beyond `foot`, into the piece, along `u`; moved along and made smaller until they are
  /// inside and clear of others, left out when that is too small to read.
  void text(int piece, const Vec2& foot, const Vec2& u, const std::string& words, double clear_mm) {
    const Vec2 inward(-u.y(), u.x());
    for (double height = text_height_mm_; height >= 0.3 * text_height_mm_; height *= 0.8) {
      const double width = words_width_mm(words, height);
      for (const double aside : {0.0, 0.8, -0.8, 1.6, -1.6}) {
        const Vec2 centre = foot + aside * width * u + (clear_mm + height / 2) * inward;
        const double radius = std::max(width, height) / 2;
        const bool collides = std::any_of(texts_[piece].begin(), texts_[piece].end(), [&](const auto& other) {
          return (other.first - centre).norm() < radius + other.second;
        });
        if (collides) continue;
        std::vector<CutPath> paths = word_paths(words, centre, u, height, CutLayer::engrave);
        if (!std::all_of(paths.begin(), paths.end(), [&](const CutPath& path) {
              return std::all_of(path.points_mm.begin(), path.points_mm.end(),
                                 [&](const Vec2& p) { return inside(piece, p); });
            }))
          continue;
        texts_[piece].emplace_back(centre, radius);
        auto& marks = result_.pieces[piece].marks;
        marks.insert(marks.end(), paths.begin(), paths.end());
        return;
      }
    }
    ++result_.left_out_texts;
  }

  /// On the ruling that is longest, along it.
  void name_piece(int piece) {
    double longest = 0;
    Vec2 middle = Vec2::Zero(), along = Vec2::UnitX();
    for (const int f : faces_[piece])
      for (int k = 0; k < 3; ++k) {
        const Vec2 &a = flat_[F_(f, k)], &b = flat_[F_(f, (k + 1) % 3)];
        if ((b - a).norm() > longest) longest = (b - a).norm(), middle = (a + b) / 2, along = (b - a) / longest;
      }
    const Vec2 inward(-along.y(), along.x());
    text(piece, middle - text_height_mm_ / 2 * inward, along, result_.pieces[piece].name, 0);
  }

  const Triangles& F_;
  const std::vector<Vec2>& flat_;
  const Splitting& splitting_;
  bool has_tabs_;
  double allowance_mm_, kerf_mm_, text_height_mm_;
  PlanPieces& result_;
  std::vector<std::vector<int>> faces_;                      // per piece
  std::vector<std::vector<std::pair<Vec2, double>>> texts_;  // per piece: centre and radius of what is written
  std::vector<std::map<int, std::pair<int, bool>>>
      next_;  // per piece, by vertex: the next one around it, and whether a split lies between
  std::map<int, std::vector<const GlueTab*>>
      tabs_;  // by the boundary edge where their foot begins, as they follow each other
  std::map<int, std::vector<std::array<Vec2, 3>>> tab_triangles_;  // per piece
  std::map<int, const EdgeFlap*> flaps_;                           // by the boundary's vertex where they begin
  int tab_number_ = 0;
  std::map<int, int> face_of_edge_;                     // by the boundary edge's first vertex
  std::map<std::pair<int, int>, std::string> letters_;  // by piece and the first vertex of its side of the split
};

}  // namespace

std::string split_letters(int number) {
  std::string letters;
  for (int rest = number; rest >= 0; rest = rest / 26 - 1)
    letters.insert(letters.begin(), static_cast<char>('A' + rest % 26));
  return letters;
}

PlanPieces make_pieces(const Triangles& F, const std::vector<Vec2>& flat_mm, const Splitting& splitting,
                       const Markers& markers, const std::optional<GlueTabs>& tabs, double seam_allowance_mm,
                       double kerf_mm, double text_height_mm, const PieceClosures& closures) {
  PlanPieces result;
  result.pieces.resize(std::size_t(splitting.piece_count));
  // The maker keeps pointers to them.
  const std::vector<EdgeFlap> flaps = closures.marks ? closures.marks->flaps : std::vector<EdgeFlap>();
  PieceMaker maker(F, flat_mm, splitting, tabs, flaps, seam_allowance_mm, kerf_mm, text_height_mm, result);
  for (int piece = 0; piece < splitting.piece_count; ++piece) maker.outline(piece);
  for (const Marker& marker : markers.markers) {
    const std::string number = std::to_string(marker.number);
    maker.marker(marker.left, number, "marker-" + number + "-left");
    maker.marker(marker.right, number, "marker-" + number + "-right");
  }
  if (closures.marks) maker.closure(closures);
  return result;
}

}  // namespace formwright
