// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The print and the frame's template on paper: one page where it fits, several to be joined where it does not.
#include <string_view>

#include "base/bytes.h"
#include "thermoform/print/print_marks.h"
#include "thermoform/print/print_render.h"

namespace formwright {

/// The part of the sheet on one page. As it lies on the paper: mirrored prints are mirrored first, then tiled.
struct Tile {
  std::string name;         // "A1": rows are letters from the top, columns numbers from the left
  Vec2 lower_mm, upper_mm;  // of the sheet as printed, origin in its middle
};

struct PageLayout {
  double width_mm = 0, height_mm = 0;  // of the paper as it is turned
  bool landscape = false;
  int columns = 1, rows = 1;
  std::vector<Tile> tiles;  // in the order in which they are joined: row by row

  /// Where the middle of the sheet lies on a tile's page, in mm from its lower left corner.
  Vec2 origin_mm(const Tile& tile) const;
};

/// The paper's orientation that needs fewer pages, upright when that does not matter. Tiles are of equal size and
/// have exactly options.overlap_mm in common.
/// Throws Error{invalid_input, "paper"}: more than 400 pages.
PageLayout page_layout(const ThermoformPrintOptions& options);

/// All tiles of `picture` (the print without marks, not mirrored), then those of the frame's template where marks are
/// asked for. Lines and words are vectors. Everything is drawn options.sent_scale() times as large, about the middle of
/// the page; paper of the sheet's size is, too. `title`: what a viewer shows above the document.
Bytes write_print_pdf(const Image& picture, const PrintGrid& grid, const PageLayout& layout,
                      const ThermoformPrintOptions& options, std::string_view title, Context& context);

/// Pixels per metre along x and y for the picture's file, rounded: the printer makes each print_factors() times as
/// large as the file says.
Eigen::Vector2i sent_per_metre(const PrintGrid& grid, const ThermoformPrintOptions& options);

/// The picture as one file would show it: with marks, and mirrored where asked for.
Image with_marks(const Image& picture, const PrintGrid& grid, const ThermoformPrintOptions& options);

}  // namespace formwright
