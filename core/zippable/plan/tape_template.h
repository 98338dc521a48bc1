// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What is laid beside the zipper to mark it: both tapes at true size in rows on paper, with the numbers that stand on
// the cloth.
#include <vector>

#include "fabrication/sheet/cut_sheet.h"
#include "zippable/plan/pieces/tape_runs.h"

namespace formwright {

struct TapeTemplate {
  std::vector<CutSheet> sheets;  // empty without a tape
  int rows = 0;
  double row_mm = 0;  // along the zipper; a whole number of marker spacings where one fits
};

/// Rows go from left to right, the left tape above. A stroke across a tape for every marker ("tape-7-left"), again
/// without a name where a row begins with the number with which the last one ended; the piece's name where a run
/// begins, behind the letters of its split. The sheet is lying paper of this size, with a bar of 100 mm ("scale-100")
/// to check the print. Sizes in mm. Throws Error{invalid_input, "tape_width_mm"}: a row is higher than the paper.
TapeTemplate make_tape_template(const FlatDesign& design, const ZipperModel& zipper, const Markers& markers,
                                double marker_spacing_mm, const std::vector<TapeRun>& runs, double paper_x_mm,
                                double paper_y_mm);

}  // namespace formwright
