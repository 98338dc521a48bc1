// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/plan/piece_picture.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace formwright {
namespace {

constexpr double rim_mm = 8;  // room for what stands beside the edges
constexpr double number_mm = 1.8, letter_mm = 3, name_mm = 3.4;

class Picture {
 public:
  Picture(const PlanPiece& piece, const Nested& place, const Vec2& size_mm) : turn_(place.turn) {
    Vec2 lower = Vec2::Constant(1e300), upper = Vec2::Constant(-1e300);
    for (const Vec2& p : piece.outline_mm) lower = lower.cwiseMin(turn_ * p), upper = upper.cwiseMax(turn_ * p);
    const Vec2 extent = (upper - lower).cwiseMax(1e-9), room = size_mm - Vec2::Constant(2 * rim_mm);
    scale_ = std::min({1.0, room.x() / extent.x(), room.y() / extent.y()});
    shift_ = size_mm / 2 - scale_ * (lower + upper) / 2;
  }

  double scale() const { return scale_; }
  Vec2 operator()(const Vec2& p) const { return scale_ * (turn_ * p) + shift_; }
  Vec2 direction(const Vec2& d) const { return turn_ * d; }

 private:
  Eigen::Matrix2d turn_;
  double scale_ = 1;
  Vec2 shift_;
};

/// The least step of numbers that leaves room to read them.
int number_step(double spacing_on_page_mm) {
  constexpr double room_mm = 5;
  for (const int step : {1, 2, 5, 10, 20, 50, 100, 200, 500})
    if (step * spacing_on_page_mm >= room_mm) return step;
  return 1000;
}

void circle(Drawing& drawing, const Vec2& centre, double radius) {
  constexpr int corners = 24;
  const auto at = [&](int k) {
    const double angle = 2 * std::numbers::pi * k / corners;
    return Vec2(centre + radius * Vec2(std::cos(angle), std::sin(angle)));
  };
  for (int k = 0; k < corners; ++k) drawing.line(at(k), at(k + 1), 0.2);
}

}  // namespace

PiecePicture picture_of_piece(const FlatDesign& design, const ZippablePlan& plan, int piece, const Vec2& size_mm,
                              const std::string& seam, const std::vector<SeamTag>& tags) {
  const PlanPiece& shown = plan.pieces.pieces[piece];
  const Picture place(shown, plan.nesting.places[piece], size_mm);
  const std::vector<Vec2>& flat = plan.ribbon.flat_mm;
  PiecePicture picture{{}, place.scale()};
  Drawing& drawing = picture.drawing;
  for (std::size_t i = 0; i < shown.outline_mm.size(); ++i)
    drawing.line(place(shown.outline_mm[i]), place(shown.outline_mm[(i + 1) % shown.outline_mm.size()]),
                 outline_stroke_mm);
  const std::vector<int> face = faces_of_boundary(design.F, design.vertex_count());
  for (int v = 0; v < design.vertex_count(); ++v)
    if (design.zipper_edge(v) && plan.splitting.piece_of_face[face[v]] == piece)
      drawing.line(place(flat[v]), place(flat[design.next(v)]),
                   design.boundary[v].left ? left_edge_stroke_mm : right_edge_stroke_mm);
  for (std::size_t s = 0; s < plan.splitting.splits.size(); ++s) {
    const RibbonSplit& split = plan.splitting.splits[s];
    if (split.left != piece && split.right != piece) continue;
    const std::string letter = split_letters(static_cast<int>(s));
    const bool bold = letter == seam;
    const Vec2 from = place(flat[split.left == piece ? split.from : split.to]),
               to = place(flat[split.left == piece ? split.to : split.from]);
    drawing.line(from, to, bold ? seam_stroke_mm : right_edge_stroke_mm, !bold);
    if (!seam.empty() && !bold) continue;
    const Vec2 along = (to - from).normalized(), outward(along.y(), -along.x());  // the piece lies to the left
    drawing.label((from + to) / 2 + 4 * outward, letter_mm, letter);
  }
  const int step = number_step(plan.marker_spacing_mm * place.scale());
  for (const TapeRun& run : plan.runs) {
    if (run.piece != piece) continue;
    for (int m = run.first_marker; m <= run.last_marker; ++m) {
      const Marker& marker = plan.markers.markers[m];
      const SideMark& mark = run.left ? marker.left : marker.right;
      const Vec2 foot = place(mark.flat_mm), inward = place.direction(mark.inward);
      drawing.line(foot, foot + inward, outline_stroke_mm);
      if (marker.number % step == 0) drawing.label(foot + 2.2 * inward, number_mm, std::to_string(marker.number));
    }
  }
  for (const SeamTag& tag : tags) {
    const SideMark mark = side_mark(design, flat, tag.left, tag.arclength_mm);
    const Vec2 centre = place(mark.flat_mm) - 3.6 * place.direction(mark.inward);
    circle(drawing, centre, 2.4);
    drawing.label(centre, number_mm, std::to_string(tag.number));
  }
  drawing.label(Vec2(size_mm.x() / 2, name_mm / 2 + 0.5), name_mm, shown.name);
  return picture;
}

}  // namespace formwright
