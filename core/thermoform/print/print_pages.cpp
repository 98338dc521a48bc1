// SPDX-License-Identifier: GPL-3.0-or-later
#include "thermoform/print/print_pages.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "imaging/drawing/pdf.h"

namespace formwright {
namespace {

constexpr int max_pages = 400;
constexpr double frame_mm = 5;   // around each tile, for its joining marks and its name
constexpr double name_mm = 2.2;  // height of its letters
constexpr double tick_from_mm = 0.7, tick_to_mm = 2.2, tick_line_mm = 0.15;

Vec2 paper_mm(const ThermoformPrintOptions& options) {
  switch (options.paper) {
    case Paper::sheet: return {options.sheet_x_mm, options.sheet_y_mm};
    case Paper::a4: return {210, 297};
    case Paper::a3: return {297, 420};
    case Paper::a2: return {420, 594};
    case Paper::letter: return {215.9, 279.4};
    case Paper::tabloid: return {279.4, 431.8};
  }
  return {210, 297};
}

std::string row_name(int row) {
  std::string name(1, static_cast<char>('A' + row % 26));
  return row >= 26 ? static_cast<char>('A' + row / 26 - 1) + name : name;
}

/// Number of tiles along one side, and their size.
struct Division {
  int count = 1;
  double size_mm = 0;
};
Division divide(double sheet_mm, double usable_mm, double overlap_mm) {
  Division division;
  if (sheet_mm > usable_mm + 1e-9)
    division.count =
        static_cast<int>(std::min(1e6, std::ceil((sheet_mm - overlap_mm) / (usable_mm - overlap_mm) - 1e-9)));
  division.size_mm = (sheet_mm + (division.count - 1) * overlap_mm) / division.count;
  return division;
}

/// Ticks outside of a tile, in line with its edges and, where a neighbour overlaps it, with that neighbour's edge.
Drawing joining_marks(const Tile& tile, const Vec2& half_sheet, double overlap_mm) {
  Drawing drawing;
  for (int axis = 0; axis < 2; ++axis) {
    std::vector<double> at{tile.lower_mm[axis], tile.upper_mm[axis]};
    if (tile.lower_mm[axis] > -half_sheet[axis] + 1e-6) at.push_back(tile.lower_mm[axis] + overlap_mm);
    if (tile.upper_mm[axis] < half_sheet[axis] - 1e-6) at.push_back(tile.upper_mm[axis] - overlap_mm);
    for (const double place : at)
      for (const bool upper : {false, true}) {
        const double edge = upper ? tile.upper_mm[1 - axis] : tile.lower_mm[1 - axis], outwards = upper ? 1 : -1;
        Vec2 from, to;
        from[axis] = to[axis] = place;
        from[1 - axis] = edge + outwards * tick_from_mm;
        to[1 - axis] = edge + outwards * tick_to_mm;
        drawing.line(from, to, tick_line_mm);
      }
  }
  return drawing;
}

std::string joining_order(const PageLayout& layout) {
  if (layout.tiles.size() == 1) return "PRINT AT 100 %";
  std::string order = "PRINT AT 100 %, JOIN " + layout.tiles.front().name;
  if (layout.columns > 1) order += " TO " + row_name(0) + std::to_string(layout.columns) + " FROM THE LEFT";
  if (layout.rows > 1)
    order +=
        std::string(layout.columns > 1 ? ", THEN ROWS A" : "") + " TO " + row_name(layout.rows - 1) + " FROM THE TOP";
  return order + ", TICKS ON TICKS";
}

}  // namespace

Vec2 PageLayout::origin_mm(const Tile& tile) const {
  return Vec2(width_mm, height_mm) / 2 - (tile.lower_mm + tile.upper_mm) / 2;
}

PageLayout page_layout(const ThermoformPrintOptions& options) {
  const Vec2 sheet(options.sheet_x_mm, options.sheet_y_mm), paper = paper_mm(options);
  PageLayout best;
  Vec2 tile_size = sheet;
  if (options.paper == Paper::sheet) {
    best.width_mm = sheet.x();
    best.height_mm = sheet.y();
    best.landscape = sheet.x() > sheet.y();
  } else {
    long long fewest = max_pages + 1;
    for (const bool landscape : {false, true}) {
      const Vec2 turned = landscape ? Vec2(paper.y(), paper.x()) : paper;
      // A printer that prints too small does not reach the paper's edge.
      const Vec2 reached = options.sent_scale().cwiseInverse().cwiseMin(1).cwiseProduct(turned);
      const Vec2 usable = reached.array() - 2 * (options.paper_margin_mm + frame_mm);
      // The widest margins leave 100 mm of the smallest paper, and overlaps end at 50 mm.
      const Division x = divide(sheet.x(), usable.x(), options.overlap_mm),
                     y = divide(sheet.y(), usable.y(), options.overlap_mm);
      const long long pages = static_cast<long long>(x.count) * y.count;
      if (pages >= fewest) continue;
      fewest = pages;
      best = {turned.x(), turned.y(), landscape, x.count, y.count, {}};
      tile_size = {x.size_mm, y.size_mm};
    }
    if (fewest > max_pages)
      throw Error(ErrorCode::invalid_input, "paper", "The sheet would need more than 400 pages: choose larger paper.");
  }
  for (int row = 0; row < best.rows; ++row)
    for (int column = 0; column < best.columns; ++column) {
      const Vec2 lower(-sheet.x() / 2 + column * (tile_size.x() - options.overlap_mm),
                       sheet.y() / 2 - tile_size.y() - row * (tile_size.y() - options.overlap_mm));
      best.tiles.push_back({row_name(row) + std::to_string(column + 1), lower, lower + tile_size});
    }
  return best;
}

Bytes write_print_pdf(const Image& picture, const PrintGrid& grid, const PageLayout& layout,
                      const ThermoformPrintOptions& options, std::string_view title, Context& context) {
  PdfDocument pdf{std::string(title)};
  const int stored = pdf.add_picture(picture);
  context.check_cancelled();
  const Vec2 half(options.sheet_x_mm / 2, options.sheet_y_mm / 2), page(layout.width_mm, layout.height_mm);
  const bool framed = options.paper != Paper::sheet;
  const Vec2 scale = options.sent_scale();
  const auto add_pages = [&](const Drawing& content, bool is_print) {
    for (const Tile& tile : layout.tiles) {
      const bool mirrored = is_print && options.mirror;
      const Vec2 origin = layout.origin_mm(tile), lower = origin + tile.lower_mm, upper = origin + tile.upper_mm;
      if (scale == Vec2(1, 1)) pdf.add_page(page.x(), page.y());
      else pdf.add_page(framed ? page : Vec2(scale.cwiseProduct(page)), scale, page / 2);
      if (is_print) pdf.show_picture(stored, grid.pixel_mm(), {origin, mirrored}, lower, upper);
      pdf.draw(content, {origin, mirrored}, lower, upper);
      Drawing plain;
      if (const auto label = mirrored_label(options); label && is_print) plain.labels.push_back(*label);
      if (!plain.labels.empty()) pdf.draw(plain, {origin, false}, lower, upper);
      if (!framed) continue;
      Drawing around = joining_marks(tile, half, options.overlap_mm);
      std::string name =
          tile.name + (is_print ? "" : " OF THE FRAME") + (mirrored ? " MIRRORED" : "") + " - " + joining_order(layout);
      around.label(Vec2((tile.lower_mm + tile.upper_mm).x() / 2, tile.lower_mm.y() - frame_mm + name_mm / 2 + 0.2),
                   name_mm, std::move(name));
      pdf.draw(around, {origin, false}, Vec2(0, 0), page);
      context.check_cancelled();
    }
  };
  add_pages(sheet_drawing(options), true);
  if (options.marks && !registration_marks(options).empty()) add_pages(frame_template(options), false);
  return pdf.finish();
}

Eigen::Vector2i sent_per_metre(const PrintGrid& grid, const ThermoformPrintOptions& options) {
  return (grid.per_metre * options.sent_scale().cwiseInverse()).array().round().matrix().cast<int>();
}

Image with_marks(const Image& picture, const PrintGrid& grid, const ThermoformPrintOptions& options) {
  Image marked = picture;
  draw(marked, sheet_drawing(options), grid.pixel_mm());
  if (!options.mirror) return marked;
  mirror_left_right(marked);
  if (const auto label = mirrored_label(options)) draw(marked, Drawing{{}, {*label}}, grid.pixel_mm());
  return marked;
}

}  // namespace formwright
