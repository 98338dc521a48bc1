// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Parts of a placement plan: a drawing with the room that it takes.
#include <cmath>
#include <string>
#include <vector>

#include "fabrication/sheet/cut_sheet.h"

namespace formwright {

inline constexpr double plan_gap_mm = 12, plan_word_height_mm = 3;

struct PlacementView {
  std::vector<CutPath> paths;
  Vec2 low = Vec2::Constant(INFINITY), high = Vec2::Constant(-INFINITY);

  void add(CutPath path);
  void words(const std::string& text, const Vec2& centre, double height_mm);
  /// Above what is there so far, from its left edge on.
  void title(const std::string& text);
  Vec2 size() const { return high - low; }
};

/// Of the number of a piece that takes so much room.
double plan_number_height_mm(const Vec2& size);

/// Rows of words under a line of titles, each as long as `titles`.
PlacementView plan_table(const std::vector<std::string>& titles, const std::vector<std::vector<std::string>>& rows,
                         const std::string& units);

/// Adds a view with its lower left corner at a place of the sheet.
void add_view(CutSheet& sheet, const PlacementView& view, const Vec2& lower_left);

}  // namespace formwright
