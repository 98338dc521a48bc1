// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/plan/tape_template.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/error.h"
#include "fabrication/sheet/word_paths.h"

namespace formwright {
namespace {

constexpr double page_margin_mm = 10, caption_mm = 6, header_mm = 12, between_rows_mm = 5, text_mm = 2.6;

class RowWriter {
 public:
  RowWriter(const ZipperModel& zipper, const std::vector<Marker>& markers, const std::vector<TapeRun>& runs,
            double row_mm)
      : teeth_(zipper.teeth_width_mm / 2),
        tape_(zipper.tape_width_mm),
        markers_(markers),
        runs_(runs),
        row_mm_(row_mm) {}

  double height_mm() const { return 2 * (teeth_ + tape_) + caption_mm; }

  /// The zipper's stretch that is row `row`; `upper_left`: of the row with its caption.
  void write(CutSheet& sheet, const Vec2& upper_left, int row, double zipper_mm) const {
    const double from = row * row_mm_, to = std::min(from + row_mm_, zipper_mm);
    const Vec2 middle(upper_left.x(), upper_left.y() - caption_mm - tape_ - teeth_);
    const auto at = [&](double arclength, double y) { return Vec2(middle.x() + arclength - from, middle.y() + y); };
    const std::string name = "row-" + std::to_string(row + 1);
    std::string caption = "ROW " + std::to_string(row + 1) + "   " + std::to_string(std::lround(from)) + " - " +
                          std::to_string(std::lround(to)) + " MM";
    if (row == 0) caption += "   SLIDER STARTS AT 0";
    if (to >= zipper_mm) caption += "   END";
    say(sheet, at(from, tape_ + teeth_ + caption_mm / 2), caption);
    for (const double side : {1.0, -1.0}) {
      const double inner = side * teeth_, outer = side * (teeth_ + tape_);
      sheet.paths.push_back({CutLayer::note,
                             {at(from, inner), at(to, inner), at(to, outer), at(from, outer)},
                             true,
                             name + (side > 0 ? "-left" : "-right")});
      // Numbers beside the teeth, pieces towards the tape's outer edge.
      const double height = std::min(text_mm, tape_ / 4), number_y = inner + side * 0.28 * tape_,
                   piece_y = inner + side * 0.75 * tape_;
      for (const Marker& marker : markers_) {
        if (marker.arclength_mm < from - 1e-9 || marker.arclength_mm > to + 1e-9) continue;
        const bool again = row > 0 && marker.arclength_mm <= from + 1e-9;
        const std::string number = std::to_string(marker.number);
        sheet.paths.push_back({CutLayer::mark,
                               {at(marker.arclength_mm, inner), at(marker.arclength_mm, outer)},
                               false,
                               again ? "" : "tape-" + number + (side > 0 ? "-left" : "-right")});
        if (marker.arclength_mm + 0.8 + words_width_mm(number, height) <= to)
          say(sheet, at(marker.arclength_mm + 0.8, number_y), number, height);
      }
      for (const TapeRun& run : runs_) {
        if (run.left != (side > 0) || run.to_mm <= from || run.from_mm >= to) continue;
        const bool begins = run.from_mm >= from;
        const double x = std::max(run.from_mm, from), end = std::min(run.to_mm, to);
        const std::string piece =
            (begins && !run.splits.empty() ? run.splits + "/" : "") + "P" + std::to_string(run.piece + 1);
        if (begins && run.from_mm > 0)
          sheet.paths.push_back({CutLayer::note, {at(x, inner + side * tape_ / 2), at(x, outer)}, false, ""});
        if (x + 1.6 + words_width_mm(piece, height) <= end) say(sheet, at(x + 0.8, piece_y), piece, height);
      }
    }
  }

  /// Words that begin at this place, at their middle height.
  static void say(CutSheet& sheet, const Vec2& begin, const std::string& words, double height = text_mm) {
    const Vec2 centre = begin + Vec2(words_width_mm(words, height) / 2, 0);
    for (CutPath& path : word_paths(words, centre, Vec2(1, 0), height, CutLayer::engrave))
      sheet.paths.push_back(std::move(path));
  }

 private:
  double teeth_, tape_;
  const std::vector<Marker>& markers_;
  const std::vector<TapeRun>& runs_;
  double row_mm_;
};

void draw_scale(CutSheet& sheet) {
  const double y = sheet.height_mm - page_margin_mm - 4, from = sheet.width_mm - page_margin_mm - 100,
               to = sheet.width_mm - page_margin_mm;
  sheet.paths.push_back({CutLayer::mark, {{from, y}, {to, y}}, false, "scale-100"});
  for (const double x : {from, to}) sheet.paths.push_back({CutLayer::mark, {{x, y - 2}, {x, y + 2}}, false, ""});
  const std::string words = "THIS BAR IS 100 MM LONG";
  RowWriter::say(sheet, Vec2((from + to - words_width_mm(words, text_mm)) / 2, y - 4.5), words);
}

}  // namespace

TapeTemplate make_tape_template(const FlatDesign& design, const ZipperModel& zipper, const Markers& markers,
                                double marker_spacing_mm, const std::vector<TapeRun>& runs, double paper_x_mm,
                                double paper_y_mm) {
  TapeTemplate result;
  if (!(zipper.tape_width_mm > 0)) return result;
  const double free_x = paper_x_mm - 2 * page_margin_mm;
  result.row_mm = marker_spacing_mm <= free_x ? marker_spacing_mm * std::floor(free_x / marker_spacing_mm) : free_x;
  result.rows = std::max(1, static_cast<int>(std::ceil(design.zipper_mm / result.row_mm - 1e-9)));
  const RowWriter writer(zipper, markers.markers, runs, result.row_mm);
  const double step = writer.height_mm() + between_rows_mm, free_y = paper_y_mm - 2 * page_margin_mm - header_mm;
  const int rows_a_sheet = static_cast<int>(std::floor((free_y + between_rows_mm) / step));
  if (rows_a_sheet < 1)
    throw Error(ErrorCode::invalid_input, "tape_width_mm",
                "The tapes are wider than the paper of their template: correct the tape width.");
  const int sheets = (result.rows + rows_a_sheet - 1) / rows_a_sheet;
  for (int i = 0; i < sheets; ++i) {
    CutSheet sheet{"Zipper tape", paper_x_mm, paper_y_mm, {}};
    draw_scale(sheet);
    RowWriter::say(
        sheet, Vec2(page_margin_mm, paper_y_mm - page_margin_mm - 4),
        "ZIPPER TAPE " + std::to_string(i + 1) + "/" + std::to_string(sheets) + "   LEFT ABOVE - RIGHT BELOW");
    for (int row = i * rows_a_sheet; row < std::min(result.rows, (i + 1) * rows_a_sheet); ++row)
      writer.write(sheet, Vec2(page_margin_mm, paper_y_mm - page_margin_mm - header_mm - (row % rows_a_sheet) * step),
                   row, design.zipper_mm);
    result.sheets.push_back(std::move(sheet));
  }
  return result;
}

}  // namespace formwright
