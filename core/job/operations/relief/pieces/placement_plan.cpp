// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/operations/relief/pieces/placement_plan.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "base/format.h"
#include "job/operations/relief/pieces/placement_view.h"

namespace formwright {
namespace {

constexpr double cross_arm_mm = 2;

PlacementView front_view(const std::vector<ReliefPiece>& pieces) {
  PlacementView view;
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    const ReliefTile& tile = pieces[k].tile;
    const std::string number = std::to_string(k + 1);
    CutPath outline{CutLayer::mark, {}, true, "piece-" + number};
    for (const Vec2& p : tile.outline) outline.points_mm.push_back(tile.on_plane(p).head<2>());
    view.add(std::move(outline));
    Vec2 middle(0, 0);
    for (const Vec2& p : tile.outline) middle += p / static_cast<double>(tile.outline.size());
    view.words(number, tile.on_plane(middle).head<2>(), plan_number_height_mm(tile.upper() - tile.lower()));
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

PlacementView section_view(const std::vector<ReliefPiece>& pieces, const BaseBands& bands, const Section& section) {
  PlacementView view;
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
    const Vec2 behind = place(0.5 * (first + last), -solid.back_mm - plan_word_height_mm);
    view.words(number, section.from_above ? behind : Vec2(behind + Vec2(plan_word_height_mm, 0)), plan_word_height_mm);
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

PlacementView table(const std::vector<ReliefPiece>& pieces, const BaseBands& bands) {
  std::vector<std::vector<std::string>> rows;
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    const auto& [tile, solid] = pieces[k];
    const Vec3 size = solid.mesh.V.colwise().maxCoeff().transpose();
    rows.push_back({std::to_string(k + 1), with_decimals(size.x(), 1), with_decimals(size.y(), 1),
                    with_decimals(size.z(), 1), with_decimals(std::max(0.0, tile.depth_mm()), 1),
                    with_decimals(signed_turn_deg(bands, tile.band), 1)});
  }
  return plan_table({"PIECE", "WIDTH", "HEIGHT", "THICK", "BEHIND", "TURN"}, rows, "MM AND DEGREES");
}

}  // namespace

CutSheet placement_plan(const std::vector<ReliefPiece>& pieces, const BaseBands& bands) {
  const Section section{bands.across(), std::abs(bands.across().x()) >= std::abs(bands.across().y())};
  const PlacementView front = front_view(pieces), cut = section_view(pieces, bands, section),
                      list = table(pieces, bands);
  CutSheet sheet;
  sheet.title = "Placement plan";
  const Vec2 views = section.from_above
                         ? Vec2(std::max(front.high.x(), cut.high.x()) - std::min(front.low.x(), cut.low.x()),
                                front.size().y() + plan_gap_mm + cut.size().y())
                         : Vec2(front.size().x() + plan_gap_mm + cut.size().x(),
                                std::max(front.high.y(), cut.high.y()) - std::min(front.low.y(), cut.low.y()));
  sheet.width_mm = std::max(views.x(), list.size().x()) + 2 * plan_gap_mm;
  sheet.height_mm = views.y() + list.size().y() + 3 * plan_gap_mm;
  add_view(sheet, list, Vec2(plan_gap_mm, plan_gap_mm));
  const Vec2 corner(plan_gap_mm, 2 * plan_gap_mm + list.size().y());
  // The same place across the base stands at the same place of both views.
  if (section.from_above) {
    const double left = std::min(front.low.x(), cut.low.x());
    add_view(sheet, cut, corner + Vec2(cut.low.x() - left, 0));
    add_view(sheet, front, corner + Vec2(front.low.x() - left, cut.size().y() + plan_gap_mm));
  } else {
    const double bottom = std::min(front.low.y(), cut.low.y());
    add_view(sheet, front, corner + Vec2(0, front.low.y() - bottom));
    add_view(sheet, cut, corner + Vec2(front.size().x() + plan_gap_mm, cut.low.y() - bottom));
  }
  return sheet;
}

}  // namespace formwright
