// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The files of a relief in pieces.
#include <string_view>

#include "job/contract/operation.h"
#include "relief/tiles/tiled_relief.h"

namespace formwright {

/// Their declarations, none of which is made without being asked for.
std::vector<OutputInfo> piece_outputs();
/// What the report says of them.
std::vector<ReportField> piece_report_fields();

bool wants_pieces(const OperationCall& call);

/// The files that the call wants, of `pieces` on `bands`; adds to the report. Throws Error: could_not_solve, cancelled.
void add_piece_files(const OperationCall& call, const std::vector<ReliefPiece>& pieces, const BaseBands& bands,
                     OperationResult& result);

}  // namespace formwright
