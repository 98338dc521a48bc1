// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/photographs/mark_sheet.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/error.h"
#include "base/index.h"
#include "base/random.h"

namespace formwright {
namespace {

constexpr std::array<const char*, 4> side_names{"front", "right", "back", "left"};
constexpr double longest_strip_mm = 270;     // what fits across A4 within a printer's margins
constexpr double board_gap_of_mark = 0.25;   // white between two marks of a strip, in sides
constexpr double board_edge_of_mark = 0.25;  // white beside them; 2 cells, so that the outline is seen
constexpr int min_board_marks = 3;           // on a strip

[[noreturn]] void refuse_value(const char* where, const std::string& message) {
  throw Error(ErrorCode::invalid_input, where, message);
}

/// All numbers in an order of their own for each seed.
std::vector<int> shuffled_numbers(int seed) {
  std::vector<int> numbers(static_cast<std::size_t>(mark_numbers));
  std::iota(numbers.begin(), numbers.end(), 0);
  Random random(static_cast<std::uint64_t>(seed));
  for (std::size_t i = numbers.size(); i > 1; --i) std::swap(numbers[i - 1], numbers[random.below(i)]);
  return numbers;
}

Vec2 turned(const Vec2& p, int quarter_turns) {
  switch (quarter_turns & 3) {
    case 1: return {-p.y(), p.x()};
    case 2: return {-p.x(), -p.y()};
    case 3: return {p.y(), -p.x()};
    default: return p;
  }
}

/// As many as fit, evenly about the middle.
int fitting(double length_mm, double mark_mm, double pitch_mm) {
  return length_mm < mark_mm ? 0 : 1 + static_cast<int>(std::floor((length_mm - mark_mm) / pitch_mm + 1e-9));
}

}  // namespace

Vec2 PlacedMark::corner_mm(int corner) const {
  const double half = side_mm / 2;
  return centre_mm + Vec2(corner == 0 || corner == 3 ? -half : half, corner < 2 ? half : -half);
}

Vec2 BoardStrip::machine_mm(const Vec2& own_mm) const { return origin_mm + turned(own_mm, quarter_turns); }

BoardStrip board_strip(const MarkSheetPlan& plan, int side, const std::vector<int>& numbers, std::size_t& next) {
  const double mark = plan.board_mark_mm, pitch = (1 + board_gap_of_mark) * mark, edge = board_edge_of_mark * mark;
  BoardStrip strip;
  strip.name = side_names[index(side)];
  strip.quarter_turns = side;
  strip.origin_mm = turned(Vec2(0, -0.5 * plan.opening_mm[side % 2 == 0 ? 1 : 0]), side);
  const double length = std::min(plan.opening_mm[side % 2 == 0 ? 0 : 1], longest_strip_mm);
  const int count = fitting(length - 2 * edge, mark, pitch);
  if (count < min_board_marks)
    refuse_value("board_mark_mm", "The strips are too short for three marks each: make the board's marks smaller.");
  for (int i = 0; i < count; ++i) {
    if (next >= numbers.size())
      refuse_value("mark_pitch_mm",
                   "There are 1000 different marks, and this sheet needs more: raise the spacing of the marks.");
    strip.marks.push_back({numbers[next++], Vec2((i - 0.5 * (count - 1)) * pitch, -edge - 0.5 * mark), mark});
  }
  strip.lower_mm = {-0.5 * length, -2 * edge - mark};
  strip.upper_mm = {0.5 * length, 0};
  return strip;
}

MarkSheet make_mark_sheet(const MarkSheetPlan& plan) {
  MarkSheet sheet;
  sheet.sheet_mm = plan.sheet_mm;
  sheet.opening_mm = plan.opening_mm;
  if (plan.opening_mm.x() > plan.sheet_mm.x())
    refuse_value("clamp_opening_x_mm",
                 "The clamp opening is wider than the sheet: give the sheet's size with its rim.");
  if (plan.opening_mm.y() > plan.sheet_mm.y())
    refuse_value("clamp_opening_y_mm",
                 "The clamp opening is longer than the sheet: give the sheet's size with its rim.");
  if (plan.mark_pitch_mm < 1.25 * plan.mark_mm)
    refuse_value("mark_pitch_mm",
                 "The marks need white around them: make their spacing at least 1.25 times their size.");
  const std::vector<int> numbers = shuffled_numbers(plan.seed);
  std::size_t next = 0;
  for (int side = 0; side < 4; ++side) sheet.strips[index(side)] = board_strip(plan, side, numbers, next);
  sheet.check_mm = sheet.strips[0].marks.back().corner_mm(1).x() - sheet.strips[0].marks.front().corner_mm(0).x();
  const Vec2 room = plan.opening_mm.array() - 2 * plan.margin_mm;
  const int columns = fitting(room.x(), plan.mark_mm, plan.mark_pitch_mm),
            rows = fitting(room.y(), plan.mark_mm, plan.mark_pitch_mm);
  if (columns < 2 || rows < 2)
    refuse_value("margin_mm", "The margin leaves no room for the marks: make it or the marks smaller.");
  if (static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows) > numbers.size() - next)
    refuse_value("mark_pitch_mm",
                 "There are 1000 different marks, and this sheet needs more: raise the spacing of the marks.");
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column)
      sheet.marks.push_back({numbers[next++],
                             plan.mark_pitch_mm * Vec2(column - 0.5 * (columns - 1), 0.5 * (rows - 1) - row),
                             plan.mark_mm});
  return sheet;
}

}  // namespace formwright
