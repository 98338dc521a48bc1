// SPDX-License-Identifier: GPL-3.0-or-later
// Marks as pictures, the board as pages, and their places as JSON.
#include <algorithm>
#include <cmath>
#include <set>

#include "base/data/json_text.h"
#include "base/error.h"
#include "base/format.h"
#include "base/index.h"
#include "evidence/photographs/mark_sheet.h"
#include "imaging/drawing/pdf.h"
#include "imaging/picture/light.h"

namespace formwright {
namespace {

constexpr const char* mark_sheet_format = "formwright mark sheet 1";
constexpr double page_width_mm = 297, page_height_mm = 210, page_margin_mm = 10;
constexpr double label_mm = 3, cut_line_mm = 0.1;

[[noreturn]] void refuse_pattern(const std::string& message) {
  throw Error(ErrorCode::invalid_input, "pattern", message);
}

/// The length that [from, to] and the pixel [at, at + 1] have in common.
double common_length(double from, double to, double at) {
  return std::max(0.0, std::min(to, at + 1) - std::max(from, at));
}

/// Black over the rectangle, in pixels from the top left, by the area of each pixel that it covers.
void blacken(std::vector<double>& black, int width, int height, const Vec2& lower, const Vec2& upper) {
  const auto clamped = [](double value, int size) {
    return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(size)));
  };
  for (int y = clamped(std::floor(lower.y()), height); y < clamped(std::ceil(upper.y()), height); ++y)
    for (int x = clamped(std::floor(lower.x()), width); x < clamped(std::ceil(upper.x()), width); ++x)
      black[index(y) * index(width) + index(x)] +=
          common_length(lower.x(), upper.x(), x) * common_length(lower.y(), upper.y(), y);
}

double number_of(const Json& value, double from, double to) {
  if (!value.is_number() || !(value.get<double>() >= from && value.get<double>() <= to))
    refuse_pattern("A number of pattern.json is missing or out of range: give the file as evidence-pattern wrote it.");
  return value.get<double>();
}
double number_at(const Json& list, std::size_t i, double from, double to) {
  return number_of(list.is_array() && list.size() > i ? list[i] : Json(), from, to);
}
const Json& member(const Json& object, const char* key) {
  if (!object.is_object() || !object.contains(key))
    refuse_pattern(std::string("The pattern has no “") + key + "”: give pattern.json as evidence-pattern wrote it.");
  return object[key];
}
Vec2 pair_of(const Json& object, const char* key, double limit) {
  const Json& value = member(object, key);
  return {number_at(value, 0, -limit, limit), number_at(value, 1, -limit, limit)};
}
std::vector<PlacedMark> marks_of(const Json& object, double side_mm) {
  const Json& list = member(object, "marks");
  if (!list.is_array() || list.empty() || list.size() > static_cast<std::size_t>(mark_numbers))
    refuse_pattern("The pattern's marks are missing: give pattern.json as evidence-pattern wrote it.");
  std::vector<PlacedMark> marks;
  for (const Json& m : list)
    marks.push_back({static_cast<int>(number_at(m, 0, 0, mark_numbers - 1)),
                     Vec2(number_at(m, 1, -1500, 1500), number_at(m, 2, -1500, 1500)), side_mm});
  return marks;
}
Json marks_json(const std::vector<PlacedMark>& marks) {
  Json list = Json::array();
  for (const PlacedMark& m : marks) list.push_back({m.number, m.centre_mm.x(), m.centre_mm.y()});
  return list;
}

}  // namespace

void draw_marks(Image& image, double pixel_mm, const Vec2& middle_mm, const std::vector<PlacedMark>& marks) {
  std::vector<double> black;
  for (const PlacedMark& mark : marks) {
    const Vec2 corner = (mark.corner_mm(0) - middle_mm) / pixel_mm;  // back left, from the picture's middle
    const Vec2 at(0.5 * image.width + corner.x(), 0.5 * image.height - corner.y());
    const int x0 = static_cast<int>(std::floor(at.x())), y0 = static_cast<int>(std::floor(at.y()));
    const double cell = mark.side_mm / mark_cells / pixel_mm;
    const int side = static_cast<int>(std::ceil(mark.side_mm / pixel_mm)) + 2;
    black.assign(index(side) * index(side), 0.0);
    for (int row = 0; row < mark_cells; ++row)
      for (int column = 0; column < mark_cells; ++column)
        if (!mark_cell_is_white(mark.number, column, row)) {
          const Vec2 lower = at - Vec2(x0, y0) + cell * Vec2(column, row);
          blacken(black, side, side, lower, lower + Vec2::Constant(cell));
        }
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        if (x0 + x < 0 || y0 + y < 0 || x0 + x >= image.width || y0 + y >= image.height) continue;
        const double share = std::min(1.0, black[index(y) * index(side) + index(x)]);
        if (share <= 0) continue;
        Rgba& pixel = image.at(x0 + x, y0 + y);
        const auto& light = light_of_byte();
        for (std::size_t k = 0; k < 3; ++k)
          pixel[k] = byte_of_light()[static_cast<std::size_t>(std::lround((1 - share) * light[pixel[k]]))];
        pixel[3] = 255;
      }
  }
}

Bytes write_board_pdf(const MarkSheet& sheet, double dots_per_inch, const Context& context) {
  PdfDocument pdf("Board for photographs");
  const double pixel_mm = 25.4 / dots_per_inch;
  double y = 0;  // lower edge of what is drawn on the page so far
  for (const BoardStrip& strip : sheet.strips) {
    context.check_cancelled();
    const Vec2 size = strip.upper_mm - strip.lower_mm;
    const double below = 6 * label_mm;
    if (y - size.y() - below < page_margin_mm) {
      pdf.add_page(page_width_mm, page_height_mm);
      y = page_height_mm - page_margin_mm;
    }
    Image image(static_cast<int>(std::ceil(size.x() / pixel_mm)), static_cast<int>(std::ceil(size.y() / pixel_mm)),
                {255, 255, 255, 255});
    const Vec2 middle = 0.5 * (strip.lower_mm + strip.upper_mm);
    draw_marks(image, pixel_mm, middle, strip.marks);
    PagePlacement placement;
    placement.origin_mm = {0.5 * page_width_mm, y - 0.5 * size.y()};
    const Vec2 lower = placement.origin_mm - 0.5 * size, upper = placement.origin_mm + 0.5 * size;
    pdf.show_picture(pdf.add_picture(image), pixel_mm, placement, lower, upper);
    Drawing drawing;
    drawing.rectangle(-0.5 * size, 0.5 * size, cut_line_mm);
    drawing.line({0, 0.5 * size.y() - 1.5}, {0, 0.5 * size.y()}, 2 * cut_line_mm);
    drawing.label({0, -0.5 * size.y() - 1.2 * label_mm}, 0.8 * label_mm,
                  strip.name + ": lay the edge with the tick along the opening, the tick at the middle of the bar");
    if (&strip == &sheet.strips[0])
      drawing.label({0, -0.5 * size.y() - 2.6 * label_mm}, 0.8 * label_mm,
                    "check: outer left edge of the first mark to outer right edge of the last = " +
                        with_decimals(sheet.check_mm, 2) + " mm");
    pdf.draw(drawing, placement, {0, 0}, {page_width_mm, page_height_mm});
    y -= size.y() + below;
  }
  return pdf.finish();
}

Json mark_sheet_json(const MarkSheet& sheet) {
  Json json = {{"format", mark_sheet_format},
               {"sheet_mm", {sheet.sheet_mm.x(), sheet.sheet_mm.y()}},
               {"clamp_opening_mm", {sheet.opening_mm.x(), sheet.opening_mm.y()}},
               {"mark_mm", sheet.marks.front().side_mm},
               {"board_mark_mm", sheet.strips[0].marks.front().side_mm},
               {"board_check_mm", sheet.check_mm},
               {"marks", marks_json(sheet.marks)},
               {"strips", Json::array()}};
  for (const BoardStrip& s : sheet.strips)
    json["strips"].push_back({{"name", s.name},
                              {"origin_mm", {s.origin_mm.x(), s.origin_mm.y()}},
                              {"quarter_turns", s.quarter_turns},
                              {"lower_mm", {s.lower_mm.x(), s.lower_mm.y()}},
                              {"upper_mm", {s.upper_mm.x(), s.upper_mm.y()}},
                              {"marks", marks_json(s.marks)}});
  return json;
}

MarkSheet read_mark_sheet(ByteView bytes) {
  const Json json = parse_json_text(as_text(bytes));
  if (!json.is_object() || !json.contains("format"))
    refuse_pattern("This is not a pattern.json: give the one that evidence-pattern wrote beside the print.");
  if (json["format"] != mark_sheet_format)
    refuse_pattern(
        "This pattern.json describes no coded marks: give the one that evidence-pattern wrote with “kind” marks.");
  MarkSheet sheet;
  sheet.sheet_mm = pair_of(json, "sheet_mm", 3000);
  sheet.opening_mm = pair_of(json, "clamp_opening_mm", 3000);
  if (sheet.opening_mm.minCoeff() < 10 || sheet.sheet_mm.minCoeff() < 10)
    refuse_pattern("The pattern's sheet has no size: give pattern.json as evidence-pattern wrote it.");
  const auto length = [&](const char* key) { return number_of(member(json, key), 0.5, 3000); };
  sheet.check_mm = length("board_check_mm");
  sheet.marks = marks_of(json, length("mark_mm"));
  const Json& strips = member(json, "strips");
  if (!strips.is_array() || strips.size() != 4)
    refuse_pattern("The pattern's board must have four strips: give pattern.json as evidence-pattern wrote it.");
  std::set<int> numbers;
  const auto take = [&](const std::vector<PlacedMark>& marks) {
    for (const PlacedMark& m : marks)
      if (!numbers.insert(m.number).second)
        refuse_pattern("Two marks of pattern.json have the same number: give the file as evidence-pattern wrote it.");
  };
  take(sheet.marks);
  for (std::size_t k = 0; k < 4; ++k) {
    BoardStrip& strip = sheet.strips[k];
    const Json& name = member(strips[k], "name");
    strip.name = name.is_string() ? name.get<std::string>().substr(0, 40) : "";
    strip.origin_mm = pair_of(strips[k], "origin_mm", 3000);
    strip.quarter_turns = static_cast<int>(number_of(member(strips[k], "quarter_turns"), 0, 3));
    strip.lower_mm = pair_of(strips[k], "lower_mm", 3000);
    strip.upper_mm = pair_of(strips[k], "upper_mm", 3000);
    strip.marks = marks_of(strips[k], length("board_mark_mm"));
    take(strip.marks);
  }
  return sheet;
}

}  // namespace formwright
