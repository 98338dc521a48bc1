// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A solved relief in pieces, where its base has several: steps, strips, or parts of a file.
#include <string>
#include <vector>

#include "job/operations/relief/solved_relief.h"

namespace formwright {

/// What a person should know of a base in parts; nothing on other bases.
std::vector<std::string> notes_on_parts(const SolvedRelief& solved);

bool has_pieces(const SolvedRelief& solved);

/// Makes the files of pieces that the call wants, with what the report says of them. Nothing on a base of one piece.
/// Throws Error: invalid_input ("pixel_mm"; "base_mesh": parts that overlap), could_not_solve, cancelled.
void add_pieces(const OperationCall& call, const SolvedRelief& solved, const ReliefOptions& options,
                OperationResult& result);

}  // namespace formwright
