// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/operations/relief/pieces/placement_plan.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "base/format.h"
#include "fabrication/sheet/word_paths.h"

namespace formwright {
namespace {

constexpr double gap_mm = 12, title_height_mm = 4, word_height_mm = 3, max_number_height_mm = 8,
                 number_share = 0.3;                // of a piece's smaller side
constexpr double cross_arm_mm = 2, column_mm = 22;  // of the table

/// Paths with the room that they take.
struct View {
  std::vector<CutPath> paths;
  Vec2 low = Vec2::Constant(INFINITY), high = Vec2::Constant(-INFINITY);

  void add(CutPath path) {
    for (const Vec2& p : path.points_mm) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
    paths.push_back(std::move(path));
  }
  void words(const std::string& text, const Vec2& centre, double height_mm) {
    for (CutPath& path : word_paths(text, centre, Vec2(1, 0), height_mm, CutLayer::engrave)) add(std::move(path));
  }
  /// Above what is there so far, from its left edge on.
  void title(const std::string& text) {
    words(text, Vec2(low.x() + 0.5 * words_width_mm(text, title_height_mm), high.y() + 1.5 * title_height_mm),
          title_height_mm);
  }
  Vec2 size() const { return high - low; }
};

double number_height(const Vec2& size) { return std::min(max_number_height_mm, number_share * size.minCoeff()); }

View front_view(const std::vector<ReliefPiece>& pieces) {
  View view;
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    const ReliefTile& tile = pieces[k].tile;
    const std::string number = std::to_string(k + 1);
    CutPath outline{CutLayer::mark, {}, true, "piece-" + number};
    for (const Vec2& p : tile.outline) outline.points_mm.push_back(tile.on_plane(p).head<2>());
    view.add(std::move(outline));
    Vec2 middle(0, 0);
    for (const Vec2& p : tile.outline) middle += p / static_cast<double>(tile.outline.size());
    view.words(number, tile.on_plane(middle).head<2>(), number_height(tile.upper() - tile.lower()));
  }
  view.title("FRONT");
  return view;
}

/// Place across the base and depth behind its front, laid into the drawing.
struct Section {
  Vec2 across;
  bool from_above = true;
  Vec2 operator()(const Vec3& p) const {
    const double t = across.dot(p.head<2>()), depth = -p.z();
    return from_above ? Vec2(t, depth) : Vec2(depth, t);
  }
};

View section_view(const std::vector<ReliefPiece>& pieces, const BaseBands& bands, const Section& section) {
  View view;
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    const auto& [tile, solid] = pieces[k];
    const auto place = [&](const Vec2& corner, double height) { return section(tile.raised(corner, height)); };
    const auto across = [&](const Vec2& corner) { return section.across.dot(tile.on_plane(corner).head<2>()); };
    const Vec2 first = *std::ranges::min_element(tile.outline, {}, across),
               last = *std::ranges::max_element(tile.outline, {}, across);
    const std::string number = std::to_string(k + 1);
    view.add({CutLayer::mark,
              {place(first, 0), place(last, 0), place(last, -solid.back_mm), place(first, -solid.back_mm)},
              true,
              "plate-" + number});
    const Vec2 behind = place(0.5 * (first + last), -solid.back_mm - word_height_mm);
    view.words(number, section.from_above ? behind : Vec2(behind + Vec2(word_height_mm, 0)), word_height_mm);
    const bool is_fold = tile.band + 1 < bands.count() && bands.slope(tile.band) != bands.slope(tile.band + 1);
    if (!is_fold) continue;
    const Vec2 fold = place(last, 0);
    for (const Vec2& arm : {Vec2(cross_arm_mm, 0), Vec2(0, cross_arm_mm)})
      view.add({CutLayer::note, {fold - arm, fold + arm}, false, ""});
  }
  view.title(section.from_above ? "FROM ABOVE" : "FROM THE SIDE");
  return view;
}

double signed_turn_deg(const BaseBands& bands, int band) {
  return std::atan(bands.slope(band)) * 180 / std::numbers::pi;
}

View table(const std::vector<ReliefPiece>& pieces, const BaseBands& bands) {
  View view;
  const double line = 2 * word_height_mm;
  const auto add_row = [&](std::size_t row, const std::vector<std::string>& columns) {
    for (std::size_t c = 0; c < columns.size(); ++c)
      view.words(columns[c], Vec2(column_mm * (static_cast<double>(c) + 0.5), -line * static_cast<double>(row)),
                 word_height_mm);
  };
  add_row(0, {"PIECE", "WIDTH", "HEIGHT", "THICK", "BEHIND", "TURN"});
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    const auto& [tile, solid] = pieces[k];
    const Vec3 size = solid.mesh.V.colwise().maxCoeff().transpose();
    add_row(k + 1,
            {std::to_string(k + 1), with_decimals(size.x(), 1), with_decimals(size.y(), 1), with_decimals(size.z(), 1),
             with_decimals(std::max(0.0, tile.depth_mm()), 1), with_decimals(signed_turn_deg(bands, tile.band), 1)});
  }
  const std::string units = "MM AND DEGREES";
  view.words(units, Vec2(0.5 * words_width_mm(units, word_height_mm), -line * static_cast<double>(pieces.size() + 1)),
             word_height_mm);
  return view;
}

void place(CutSheet& sheet, const View& view, const Vec2& lower_left) {
  for (CutPath path : view.paths) {
    for (Vec2& p : path.points_mm) p += lower_left - view.low;
    sheet.paths.push_back(std::move(path));
  }
}

}  // namespace

CutSheet placement_plan(const std::vector<ReliefPiece>& pieces, const BaseBands& bands) {
  const Section section{bands.across(), std::abs(bands.across().x()) >= std::abs(bands.across().y())};
  const View front = front_view(pieces), cut = section_view(pieces, bands, section), list = table(pieces, bands);
  CutSheet sheet;
  sheet.title = "Placement plan";
  const Vec2 views = section.from_above
                         ? Vec2(std::max(front.high.x(), cut.high.x()) - std::min(front.low.x(), cut.low.x()),
                                front.size().y() + gap_mm + cut.size().y())
                         : Vec2(front.size().x() + gap_mm + cut.size().x(),
                                std::max(front.high.y(), cut.high.y()) - std::min(front.low.y(), cut.low.y()));
  sheet.width_mm = std::max(views.x(), list.size().x()) + 2 * gap_mm;
  sheet.height_mm = views.y() + list.size().y() + 3 * gap_mm;
  place(sheet, list, Vec2(gap_mm, gap_mm));
  const Vec2 corner(gap_mm, 2 * gap_mm + list.size().y());
  // The same place across the base stands at the same place of both views.
  if (section.from_above) {
    const double left = std::min(front.low.x(), cut.low.x());
    place(sheet, cut, corner + Vec2(cut.low.x() - left, 0));
    place(sheet, front, corner + Vec2(front.low.x() - left, cut.size().y() + gap_mm));
  } else {
    const double bottom = std::min(front.low.y(), cut.low.y());
    place(sheet, front, corner + Vec2(0, front.low.y() - bottom));
    place(sheet, cut, corner + Vec2(front.size().x() + gap_mm, cut.low.y() - bottom));
  }
  return sheet;
}

}  // namespace formwright
