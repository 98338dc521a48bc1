// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// From the flat ribbon to sheets that are cut: room for the zipper, markers, pieces, nesting. Thesis Sec. 5.3.
#include <string>
#include <vector>

#include "base/data/fix.h"
#include "base/context.h"
#include "fabrication/sheet/nesting.h"
#include "zippable/plan/pieces/plan_pieces.h"
#include "zippable/plan/plan_record.h"
#include "zippable/plan/rig.h"
#include "zippable/plan/pieces/seams.h"
#include "zippable/plan/tape_template.h"

namespace formwright {

struct ZippablePlan {
  ZipperModel zipper;
  OffsetRibbon ribbon;
  double marker_spacing_mm = 30;
  Markers markers;
  Splitting splitting;
  PlanPieces pieces;
  Nesting nesting;                   // sheets of the first fabric before those of the second
  std::vector<int> fabric_of_piece;  // 0 or 1
  std::vector<int> fabric_of_sheet;
  int fabrics = 1;
  std::vector<CutSheet> sheets;
  std::vector<TapeRun> runs;
  TapeTemplate tape;
  std::vector<Seam> seams;
  std::optional<GlueTabs> tabs;
  ClosureMarks closures;  // of cuts that the zipper does not close
  std::optional<Rig> rig;
  double edges_moved_mm = 0;   // room for the zipper, and what makes up for errors of making
  double area_before_mm2 = 0;  // of the ribbon with room for the zipper, before splitting
  double width_mean_mm = 0;    // of the ribbon as designed: its area over the zipper's length
  std::vector<std::string> notes;
  std::vector<Fix> fixes;  // of some notes
  double seconds_offset = 0, seconds_split = 0, seconds_nest = 0;

  bool has_tape() const { return zipper.tape_width_mm > 0; }
};

/// Width and height of the paper, upright, in mm.
Vec2 paper_size_mm(InstructionPaper paper);

/// "Colour 1": a fabric as a maker counts them.
std::string fabric_name(int fabric);

/// Throws Error: invalid_input (a parameter), cancelled.
ZippablePlan plan_zippable(const FlatDesign& design, const PlanOptions& options, Context& context);

/// How each triangle of `design` lies on its sheet.
PlanRecord record_of(const FlatDesign& design, const ZippablePlan& plan);

/// One page a sheet at exact size, everything in black. Throws Error{could_not_solve}: a sheet longer than 5.08 m.
Bytes write_plan_pdf(const std::vector<CutSheet>& sheets);

}  // namespace formwright
