// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/plan/plan_pieces.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

#include "geometry/adjacency.h"
#include "zippable/plan/words.h"

namespace formwright {
namespace {

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

class PieceMaker {
 public:
  PieceMaker(const Triangles& F, const std::vector<Vec2>& flat, const Splitting& splitting, double allowance_mm, double kerf_mm,
             double text_height_mm, PlanPieces& result)
      : F_(F), flat_(flat), splitting_(splitting), allowance_mm_(allowance_mm), kerf_mm_(kerf_mm), text_height_mm_(text_height_mm),
        result_(result), faces_(std::size_t(splitting.piece_count)), texts_(faces_.size()) {
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
    const int first = next_[piece].begin()->first;
    int v = first;
    do {
      const auto [to, split] = next_[piece].at(v);
      made.outline_mm.push_back(flat_[v]);
      if (split) {
        for (const Vec2& corner : allowance(piece, v, to)) made.outline_mm.push_back(corner);
        const Vec2 u = (flat_[to] - flat_[v]).normalized();
        made.marks.push_back({CutLayer::mark, {flat_[v], flat_[to]}, false, "split-" + letters_.at({piece, v}) + "-" + made.name});
        text(piece, (flat_[v] + flat_[to]) / 2, u, letters_.at({piece, v}), 0.6 * text_height_mm_);
      }
      v = to;
    } while (v != first);
    const std::vector<Vec2> steps = offset_steps(made.outline_mm, std::vector<double>(made.outline_mm.size(), -kerf_mm_ / 2));
    for (std::size_t i = 0; i < steps.size(); ++i) made.cut_mm.push_back(made.outline_mm[i] + steps[i]);
    name_piece(piece);
  }

  void marker(const SideMark& mark, int number, const char* side) {
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
    result_.pieces[piece].marks.push_back({CutLayer::mark,
                                           {mark.flat_mm, end},
                                           false,
                                           "marker-" + std::to_string(number) + "-" + side});
    text(piece, mark.flat_mm + (length + 0.4) * mark.inward, mark.along, std::to_string(number), 0);
  }

 private:
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
    if (!(length > 0)) return {};
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
      if (!meets) {
        result_.shortened_allowances += share < 1;
        return {d, c};
      }
    }
    ++result_.shortened_allowances;
    return {};
  }

  /// Words begin `clear_mm` beyond `foot`, into the piece, along `u`; moved along and made smaller until they are inside and clear of
  /// others, left out when that is too small to read.
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
              return std::all_of(path.points_mm.begin(), path.points_mm.end(), [&](const Vec2& p) { return inside(piece, p); });
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
  double allowance_mm_, kerf_mm_, text_height_mm_;
  PlanPieces& result_;
  std::vector<std::vector<int>> faces_;                     // per piece
  std::vector<std::vector<std::pair<Vec2, double>>> texts_; // per piece: centre and radius of what is written
  std::vector<std::map<int, std::pair<int, bool>>> next_;   // per piece, by vertex: the next one around it, and whether a split lies between
  std::map<int, int> face_of_edge_;                         // by the boundary edge's first vertex
  std::map<std::pair<int, int>, std::string> letters_;      // by piece and the first vertex of its side of the split
};

}  // namespace

std::string split_letters(int number) {
  std::string letters;
  for (int rest = number; rest >= 0; rest = rest / 26 - 1) letters.insert(letters.begin(), static_cast<char>('A' + rest % 26));
  return letters;
}

PlanPieces make_pieces(const Triangles& F, const std::vector<Vec2>& flat_mm, const Splitting& splitting, const Markers& markers,
                       double seam_allowance_mm, double kerf_mm, double text_height_mm) {
  PlanPieces result;
  result.pieces.resize(std::size_t(splitting.piece_count));
  PieceMaker maker(F, flat_mm, splitting, seam_allowance_mm, kerf_mm, text_height_mm, result);
  for (int piece = 0; piece < splitting.piece_count; ++piece) maker.outline(piece);
  for (const Marker& marker : markers.markers) {
    maker.marker(marker.left, marker.number, "left");
    maker.marker(marker.right, marker.number, "right");
  }
  return result;
}

}  // namespace formwright
