// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What is printed to measure a formed sheet by photographs: a grid of coded marks on the sheet, and four paper strips
// with larger ones that lie on the clamp frame around the opening.
#include <array>
#include <string>
#include <vector>

#include "base/bytes.h"
#include "base/data/json.h"
#include "evidence/photographs/mark_code.h"
#include "geometry/mesh/triangle_mesh.h"
#include "imaging/drawing/drawing.h"
#include "imaging/picture/image.h"

namespace formwright {

/// A square of side_mm that says `number`, upright.
struct PlacedMark {
  int number = 0;
  Vec2 centre_mm{0, 0};
  double side_mm = 0;

  /// Corner 0 to 3: back left, back right, front right, front left.
  Vec2 corner_mm(int corner) const;
};

/// A strip of paper along one side of the clamp opening. Its own coordinates: origin at the middle of its inner edge,
/// which lies flush with the opening; y into the opening, x to the right of it.
struct BoardStrip {
  std::string name;  // "front", then counter-clockwise seen from above
  std::vector<PlacedMark> marks;
  Vec2 origin_mm{0, 0};                 // where its origin is to lie, in machine coordinates
  int quarter_turns = 0;                // of its coordinates against the machine's, counter-clockwise
  Vec2 lower_mm{0, 0}, upper_mm{0, 0};  // the paper

  /// Where a point of the strip is to lie.
  Vec2 machine_mm(const Vec2& own_mm) const;
};

struct MarkSheetPlan {
  Vec2 sheet_mm{240, 260}, opening_mm{220, 240};
  int seed = 1;
  double margin_mm = 3;
  double mark_mm = 9, mark_pitch_mm = 15;
  double board_mark_mm = 16;
};

struct MarkSheet {
  Vec2 sheet_mm{240, 260}, opening_mm{220, 240};
  std::vector<PlacedMark> marks;  // in sheet coordinates: mm, x to the right, y to the back, centred on the sheet
  std::array<BoardStrip, 4> strips;
  double check_mm = 0;  // length of the line on the front strip that tells how large the board was printed
};

/// Throws Error{invalid_input}: no room for marks, or more than there are numbers.
MarkSheet make_mark_sheet(const MarkSheetPlan& plan);

/// Draws marks into a picture whose middle is `middle_mm`, y upwards; smooth edges by area. Every machine draws the
/// same bits.
void draw_marks(Image& image, double pixel_mm, const Vec2& middle_mm, const std::vector<PlacedMark>& marks);

/// The four strips on one or two A4 pages at true size, to be cut out.
Bytes write_board_pdf(const MarkSheet& sheet, double dots_per_inch, const Context& context);

Json mark_sheet_json(const MarkSheet& sheet);
/// Throws Error{invalid_input, "pattern"}, naming what is wrong.
MarkSheet read_mark_sheet(ByteView json);

}  // namespace formwright
