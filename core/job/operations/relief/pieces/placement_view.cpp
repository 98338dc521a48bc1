// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/operations/relief/pieces/placement_view.h"

#include <algorithm>
#include <utility>

#include "fabrication/sheet/word_paths.h"

namespace formwright {
namespace {

constexpr double title_height_mm = 4, max_number_height_mm = 8, number_share = 0.3;  // of a piece's smaller side
constexpr double column_mm = 22;                                                     // of a table

}  // namespace

void PlacementView::add(CutPath path) {
  for (const Vec2& p : path.points_mm) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  paths.push_back(std::move(path));
}

void PlacementView::words(const std::string& text, const Vec2& centre, double height_mm) {
  for (CutPath& path : word_paths(text, centre, Vec2(1, 0), height_mm, CutLayer::engrave)) add(std::move(path));
}

void PlacementView::title(const std::string& text) {
  words(text, Vec2(low.x() + 0.5 * words_width_mm(text, title_height_mm), high.y() + 1.5 * title_height_mm),
        title_height_mm);
}

double plan_number_height_mm(const Vec2& size) {
  return std::min(max_number_height_mm, number_share * size.minCoeff());
}

PlacementView plan_table(const std::vector<std::string>& titles, const std::vector<std::vector<std::string>>& rows,
                         const std::string& units) {
  PlacementView view;
  const double line = 2 * plan_word_height_mm;
  const auto add_row = [&](std::size_t row, const std::vector<std::string>& columns) {
    for (std::size_t c = 0; c < columns.size(); ++c)
      view.words(columns[c], Vec2(column_mm * (static_cast<double>(c) + 0.5), -line * static_cast<double>(row)),
                 plan_word_height_mm);
  };
  add_row(0, titles);
  for (std::size_t k = 0; k < rows.size(); ++k) add_row(k + 1, rows[k]);
  view.words(units,
             Vec2(0.5 * words_width_mm(units, plan_word_height_mm), -line * static_cast<double>(rows.size() + 1)),
             plan_word_height_mm);
  return view;
}

void add_view(CutSheet& sheet, const PlacementView& view, const Vec2& lower_left) {
  for (CutPath path : view.paths) {
    for (Vec2& p : path.points_mm) p += lower_left - view.low;
    sheet.paths.push_back(std::move(path));
  }
}

}  // namespace formwright
