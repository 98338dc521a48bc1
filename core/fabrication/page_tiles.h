// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A picture or a drawing at exact size over as many pages as it takes.
#include <string>
#include <vector>

#include "base/context.h"
#include "base/data/parameters.h"
#include "fabrication/sheet/cut_sheet.h"
#include "imaging/picture/image.h"

namespace formwright {

enum class PageMedia { a4, a3, a2, letter, tabloid, custom };
template <>
struct EnumNames<PageMedia> {
  static constexpr std::array<std::string_view, 6> names{"a4", "a3", "a2", "letter", "tabloid", "custom"};
  static constexpr std::array<std::string_view, 6> labels{"A4", "A3", "A2", "Letter", "Tabloid", "Custom size"};
};

enum class PageTurn { automatic, upright, sideways };
template <>
struct EnumNames<PageTurn> {
  static constexpr std::array<std::string_view, 3> names{"automatic", "upright", "sideways"};
  static constexpr std::array<std::string_view, 3> labels{"Fewest pages", "Upright", "Sideways"};
};

struct PageTilesOptions {
  PageMedia media = PageMedia::a4;
  double media_width_mm = 210, media_height_mm = 297;
  PageTurn turn = PageTurn::automatic;
  double margin_left_mm = 8, margin_right_mm = 8, margin_top_mm = 8, margin_bottom_mm = 8;
  double overlap_mm = 10;
  std::optional<double> width_mm;
  bool mirrored = false, marks = true, ruler = true;

  static constexpr auto parameters = std::tuple{
      parameter("media", &PageTilesOptions::media, "Paper", "Size of the paper in the printer.").group("Pages"),
      parameter("media_width_mm", &PageTilesOptions::media_width_mm, "Paper width", unit::mm, 30, 5000,
                "Width of the paper if its size is set to Custom size.")
          .group("Pages")
          .slider(50, 1000),
      parameter("media_height_mm", &PageTilesOptions::media_height_mm, "Paper height", unit::mm, 30, 5000,
                "Height of the paper if its size is set to Custom size.")
          .group("Pages")
          .slider(50, 1500),
      parameter("turn", &PageTilesOptions::turn, "Orientation",
                "How the paper lies: upright, sideways, or whichever needs fewer pages.")
          .group("Pages"),
      parameter("margin_left_mm", &PageTilesOptions::margin_left_mm, "Left margin", unit::mm, 0, 200,
                "White border at the left that the printer cannot print on, with the paper upright.")
          .group("Pages")
          .slider(0, 25),
      parameter("margin_right_mm", &PageTilesOptions::margin_right_mm, "Right margin", unit::mm, 0, 200,
                "White border at the right that the printer cannot print on, with the paper upright.")
          .group("Pages")
          .slider(0, 25),
      parameter("margin_top_mm", &PageTilesOptions::margin_top_mm, "Top margin", unit::mm, 0, 200,
                "White border at the top that the printer cannot print on, with the paper upright.")
          .group("Pages")
          .slider(0, 25),
      parameter("margin_bottom_mm", &PageTilesOptions::margin_bottom_mm, "Bottom margin", unit::mm, 0, 200,
                "White border at the bottom that the printer cannot print on, with the paper upright.")
          .group("Pages")
          .slider(0, 25),
      parameter("overlap_mm", &PageTilesOptions::overlap_mm, "Overlap", unit::mm, 0, 100,
                "Width of the strip that neighbouring pages share, so that they can be glued together. 10 mm is usual.")
          .group("Pages")
          .slider(0, 30),
      parameter("width_mm", &PageTilesOptions::width_mm, "Width", unit::mm, 1, 20'000,
                "Printed width of the whole picture or drawing. Automatic: the width in the file.")
          .group("Size")
          .slider(20, 1000),
      parameter("mirrored", &PageTilesOptions::mirrored, "Mirror horizontally",
                "Swaps left and right, for transfer paper and for printing on the back of clear material.")
          .group("Size"),
      parameter("marks", &PageTilesOptions::marks, "Alignment marks",
                "Prints crosses in the overlaps, a frame, and the row and column of each page, to join the pages.")
          .group("Marks"),
      parameter("ruler", &PageTilesOptions::ruler, "Ruler",
                "Prints a ruler of 100 mm on the first page, to check that the printer did not change the scale.")
          .group("Marks")};
};

/// What goes onto the pages: a picture with square pixels of `pixel_mm`, or a drawing.
struct PageContent {
  const Image* picture = nullptr;
  const CutSheet* drawing = nullptr;
  double width_mm = 0, height_mm = 0;
};

struct PageTiles {
  Bytes pdf;
  int columns = 0, rows = 0;
  double page_width_mm = 0, page_height_mm = 0;  // as the page lies
  double room_width_mm = 0, room_height_mm = 0;  // of it, within the margins
  std::vector<std::string> notes;
};

/// Pages from the upper left, row by row, each showing its part at exact size. A page that lies sideways keeps the
/// wider of the two margins that may come to lie on a side: which way the printer turns it is not known. Throws Error:
/// invalid_input ("overlap_mm", "margin_left_mm": no room is left on a page; "width_mm": over 400 pages),
/// could_not_solve (libharu), cancelled.
PageTiles make_page_tiles(const PageContent& content, const PageTilesOptions& options, Context& context);

}  // namespace formwright
