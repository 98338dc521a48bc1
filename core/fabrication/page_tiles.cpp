// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/page_tiles.h"

#include <algorithm>
#include <cmath>

#include "imaging/drawing/pdf.h"

namespace formwright {
namespace {

struct Layout {
  double page_width_mm, page_height_mm, left_mm, bottom_mm, room_x_mm, room_y_mm, step_x_mm, step_y_mm;
  int columns, rows;
};

int pages_along(double length_mm, double room_mm, double step_mm) {
  return length_mm <= room_mm + 1e-6 ? 1 : 1 + static_cast<int>(std::ceil((length_mm - room_mm) / step_mm - 1e-6));
}

Layout layout_of(const PageContent& content, const PageTilesOptions& o, bool sideways) {
  constexpr double sizes[][2] = {{210, 297}, {297, 420}, {420, 594}, {215.9, 279.4}, {279.4, 431.8}};
  const auto media = static_cast<std::size_t>(o.media);
  double width = o.media == PageMedia::custom ? o.media_width_mm : sizes[media][0],
         height = o.media == PageMedia::custom ? o.media_height_mm : sizes[media][1];
  double left = o.margin_left_mm, right = o.margin_right_mm, top = o.margin_top_mm, bottom = o.margin_bottom_mm;
  if (sideways) {
    std::swap(width, height);
    const double across = std::max(o.margin_top_mm, o.margin_bottom_mm),
                 along = std::max(o.margin_left_mm, o.margin_right_mm);
    left = right = across;
    top = bottom = along;
  }
  Layout layout{width, height, left, bottom, width - left - right, height - top - bottom, 0, 0, 0, 0};
  if (std::min(layout.room_x_mm, layout.room_y_mm) < 10)
    throw Error(ErrorCode::invalid_input, "margin_left_mm",
                "The margins leave less than 10 mm of the page: make them smaller.");
  layout.step_x_mm = layout.room_x_mm - o.overlap_mm;
  layout.step_y_mm = layout.room_y_mm - o.overlap_mm;
  if (std::min(layout.step_x_mm, layout.step_y_mm) < 5)
    throw Error(ErrorCode::invalid_input, "overlap_mm", "The overlap leaves no room on the page: make it smaller.");
  layout.columns = pages_along(content.width_mm, layout.room_x_mm, layout.step_x_mm);
  layout.rows = pages_along(content.height_mm, layout.room_y_mm, layout.step_y_mm);
  return layout;
}

Layout best_layout(const PageContent& content, const PageTilesOptions& o) {
  if (o.turn != PageTurn::automatic) return layout_of(content, o, o.turn == PageTurn::sideways);
  const Layout upright = layout_of(content, o, false), sideways = layout_of(content, o, true);
  return sideways.columns * sideways.rows < upright.columns * upright.rows ? sideways : upright;
}

/// From the content's middle, as the picture has it.
Drawing drawn(const CutSheet& sheet, const PageContent& content) {
  Drawing drawing;
  const double scale = content.width_mm / sheet.width_mm;
  const Vec2 middle(sheet.width_mm / 2, sheet.height_mm / 2);
  for (const CutPath& path : sheet.paths)
    for (std::size_t i = 0; i + (path.closed ? 0 : 1) < path.points_mm.size(); ++i)
      drawing.line(scale * (path.points_mm[i] - middle),
                   scale * (path.points_mm[(i + 1) % path.points_mm.size()] - middle), 0.2,
                   path.layer == CutLayer::note);
  return drawing;
}

/// In the middle of every overlap, halfway along each page's side: both neighbours show the same cross. Not mirrored
/// with the content.
Drawing crosses(const Layout& layout, const PageTilesOptions& o) {
  Drawing drawing;
  for (int c = 0; c < layout.columns; ++c)
    for (int r = 0; r < layout.rows; ++r) {
      const Vec2 corner(c * layout.step_x_mm,
                        -r * layout.step_y_mm);  // of the page's room, from the content's upper left
      if (c > 0)
        drawing.cross(corner + Vec2(o.overlap_mm / 2, -layout.room_y_mm / 2), std::min(3.0, o.overlap_mm / 2), 0.1);
      if (r > 0)
        drawing.cross(corner + Vec2(layout.room_x_mm / 2, -o.overlap_mm / 2), std::min(3.0, o.overlap_mm / 2), 0.1);
    }
  return drawing;
}

Drawing ruler(const Vec2& start) {
  Drawing drawing;
  drawing.line(start, start + Vec2(100, 0), 0.15);
  for (int i = 0; i <= 10; ++i) drawing.line(start + Vec2(10 * i, 0), start + Vec2(10 * i, i % 5 == 0 ? 2 : 1.2), 0.15);
  drawing.label(start + Vec2(110, 1), 2, "100 mm");
  return drawing;
}

}  // namespace

PageTiles make_page_tiles(const PageContent& content, const PageTilesOptions& options, Context& context) {
  const Layout layout = best_layout(content, options);
  if (layout.columns * layout.rows > 400)
    throw Error(ErrorCode::invalid_input, "width_mm",
                "The print would need more than 400 pages: make it smaller or choose larger paper.");
  PageTiles tiles;
  tiles.columns = layout.columns;
  tiles.rows = layout.rows;
  tiles.page_width_mm = layout.page_width_mm;
  tiles.page_height_mm = layout.page_height_mm;
  tiles.room_width_mm = layout.room_x_mm;
  tiles.room_height_mm = layout.room_y_mm;
  PdfDocument document("Pages");
  const int picture = content.picture != nullptr ? document.add_picture(*content.picture) : -1;
  const Drawing drawing = content.drawing != nullptr ? drawn(*content.drawing, content) : Drawing{};
  const Drawing marks = options.marks && options.overlap_mm >= 2 ? crosses(layout, options) : Drawing{};
  const bool words = options.marks && layout.bottom_mm >= 4,
             has_ruler = options.ruler && layout.bottom_mm >= 4 && layout.room_x_mm >= 125;
  if (options.ruler && !has_ruler)
    tiles.notes.push_back("There is no room for the ruler: it needs a lower margin of 4 mm and a page 125 mm wide.");
  for (int r = 0; r < layout.rows; ++r)
    for (int c = 0; c < layout.columns; ++c) {
      context.progress(static_cast<double>(r * layout.columns + c) / (layout.rows * layout.columns), "Pages");
      document.add_page(layout.page_width_mm, layout.page_height_mm);
      const Vec2 low(layout.left_mm, layout.bottom_mm), high = low + Vec2(layout.room_x_mm, layout.room_y_mm);
      // The content's upper left corner on this page; its middle stays where it is when it is mirrored.
      const Vec2 corner(low.x() - c * layout.step_x_mm, high.y() + r * layout.step_y_mm);
      const PagePlacement middle{corner + Vec2(content.width_mm / 2, -content.height_mm / 2), options.mirrored};
      if (picture >= 0) document.show_picture(picture, content.width_mm / content.picture->width, middle, low, high);
      else document.draw(drawing, middle, low, high);
      document.draw(marks, {corner, false}, low, high);
      const Vec2 page(layout.page_width_mm, layout.page_height_mm);
      Drawing around;
      if (options.marks) around.rectangle(low, high, 0.05, true);
      if (words)
        around.label({high.x() - 15, low.y() / 2}, 2,
                     "row " + std::to_string(r + 1) + "/" + std::to_string(layout.rows) + " column " +
                         std::to_string(c + 1) + "/" + std::to_string(layout.columns));
      if (has_ruler && r == 0 && c == 0) {
        const Drawing scale = ruler({low.x(), low.y() / 2 - 1});
        around.strokes.insert(around.strokes.end(), scale.strokes.begin(), scale.strokes.end());
        if (layout.room_x_mm >= 150)
          around.labels.insert(around.labels.end(), scale.labels.begin(), scale.labels.end());
      }
      document.draw(around, {}, {0, 0}, page);
    }
  tiles.pdf = document.finish();
  return tiles;
}

}  // namespace formwright
