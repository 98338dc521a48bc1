// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The flattened model as a picture of the whole sheet.
#include "imaging/picture/image.h"
#include "thermoform/print/model_colours.h"
#include "thermoform/print/sheet_projection.h"

namespace formwright {

/// Whole pixels of 1 / per_metre for the sheet, its middle in the middle of the picture: as near to the sheet's size as
/// they get, at most half a pixel off in all.
struct PrintGrid {
  int width = 0, height = 0;
  int per_metre = 0;

  double pixel_mm() const { return 1000.0 / per_metre; }
  /// From sheet coordinates (mm, y up, origin in the middle) to pixels from the top left.
  Vec2 pixel(const Vec2& sheet_mm) const {
    return {width / 2.0 + sheet_mm.x() / pixel_mm(), height / 2.0 - sheet_mm.y() / pixel_mm()};
  }
};

/// Throws Error{invalid_input, "dots_per_inch"} when the picture would have more than max_image_pixels.
PrintGrid print_grid(const ThermoformPrintOptions& options);

/// Draws the coloured faces at their places on the flat sheet; where faces overlap, the one nearest to the formed sheet
/// shows. Pixels are means of the covered ones of 2 x 2 points, in linear light; a picture is filtered over each
/// pixel's footprint. Pixels without any have alpha 0, the others 255.
Image render_print(const RefinedSurface& surface, const ProjectedSurface& projected, const ModelColours& colours,
                   const PrintGrid& grid, Context& context);

}  // namespace formwright
