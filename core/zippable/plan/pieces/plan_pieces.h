// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Pieces of the ribbon as they are cut: outline with seam allowances, marks and numbers inside.
#include <optional>
#include <string>
#include <vector>

#include "fabrication/sheet/cut_sheet.h"
#include "zippable/plan/pieces/closure_marks.h"
#include "zippable/plan/pieces/glue_tabs.h"
#include "zippable/plan/pieces/markers.h"
#include "zippable/plan/pieces/splitting.h"

namespace formwright {

struct PlanPiece {
  std::string name;  // "P1", ...
  double ribbon_area_mm2 = 0;
  Polygon outline_mm;          // finished size: with seam allowances, without kerf
  Polygon cut_mm;              // where the cutter's middle runs
  std::vector<CutPath> marks;  // everything but the cut, in the ribbon's plane
};

struct PlanPieces {
  std::vector<PlanPiece> pieces;
  int shortened_allowances = 0;  // edges of splits where the allowance would have met the piece itself
  int left_out_texts = 0;        // numbers and letters for which the ribbon is too narrow
};

/// A, B, ..., Z, AA, AB, ...: the name of a split.
std::string split_letters(int number);

/// What closures add to the pieces; null: nothing. With tape, or of paper.
struct PieceClosures {
  const ClosureMarks* marks = nullptr;
  bool tape = true;
};

/// `flat_mm`: as split. Kerf, allowance and text's height in mm. With tabs, splits have an allowance on their left side
/// only: it is one.
PlanPieces make_pieces(const Triangles& F, const std::vector<Vec2>& flat_mm, const Splitting& splitting,
                       const Markers& markers, const std::optional<GlueTabs>& tabs, double seam_allowance_mm,
                       double kerf_mm, double text_height_mm, const PieceClosures& closures = {});

}  // namespace formwright
