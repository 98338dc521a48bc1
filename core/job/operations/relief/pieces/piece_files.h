// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The files of a relief in pieces.
#include <functional>
#include <vector>

#include "job/contract/operation.h"
#include "fabrication/sheet/cut_sheet.h"
#include "relief/parts/parted_relief.h"
#include "relief/tiles/tiled_relief.h"

namespace formwright {

/// Their declarations, none of which is made without being asked for.
std::vector<OutputInfo> piece_outputs();
/// What the report says of them.
std::vector<ReportField> piece_report_fields();

bool wants_pieces(const OperationCall& call);

/// A piece as the files have it, all in mm.
struct PlacedPiece {
  TriangleMesh lying;     // on its back, from 0, 0, 0
  TriangleMesh standing;  // where it belongs: x right, y up, z towards the viewer, the middle of the plate's front at 0
  double depth_mm = 0, turn_deg = 0, volume_mm3 = 0;
  bool numbered = false, watertight = false;
};
std::vector<PlacedPiece> placed(const std::vector<ReliefPiece>& pieces);
std::vector<PlacedPiece> placed(const std::vector<PartPiece>& pieces);

/// The files that the call wants; adds to the report. `plan`: draws where the pieces go, where that is asked for.
/// Throws Error: could_not_solve, cancelled.
void add_piece_files(const OperationCall& call, const std::vector<PlacedPiece>& pieces,
                     const std::function<CutSheet()>& plan, OperationResult& result);

}  // namespace formwright
