// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/operations/relief/made_pieces.h"

#include "job/operations/relief/pieces/parts_plan.h"
#include "job/operations/relief/pieces/piece_files.h"
#include "job/operations/relief/pieces/placement_plan.h"

namespace formwright {

std::vector<std::string> notes_on_parts(const SolvedRelief& solved) {
  std::vector<std::string> notes;
  const BaseParts* const parts = solved.base.parts();
  if (parts == nullptr) return notes;
  int hidden = 0;
  for (int part = 0; part < parts->count(); ++part) hidden += parts->seen(part).empty();
  if (hidden > 0)
    notes.push_back(std::to_string(hidden) + (hidden == 1 ? " part" : " parts") +
                    " of the base cannot be seen from the viewpoint, and will be no pieces.");
  if (solved.relief.vertices_beyond_base > 0)
    notes.push_back("What the model has between the parts of the base or beside them is left out.");
  return notes;
}

bool has_pieces(const SolvedRelief& solved) { return solved.base.bands() != nullptr || solved.base.parts() != nullptr; }

void add_pieces(const OperationCall& call, const SolvedRelief& solved, const ReliefOptions& options,
                OperationResult& result) {
  const double tolerance_mm = solid_tolerance_share * options.thickness_mm;
  const ViewFrame& frame = solved.solver->frame();
  const ReliefPieces& cut = solved.relief.pieces;
  if (const BaseBands* const bands = solved.base.bands()) {
    const std::vector<ReliefPiece> pieces =
        tiled_relief(frame, *bands, cut, plate_of(frame, options), options, tolerance_mm, true, call.context);
    add_piece_files(
        call, placed(pieces), [&] { return placement_plan(pieces, *bands); }, result);
  } else if (const BaseParts* const parts = solved.base.parts()) {
    const std::vector<PartPiece> pieces = parted_relief(*parts, cut, options, tolerance_mm, true, call.context);
    add_piece_files(
        call, placed(pieces), [&] { return parts_plan(pieces); }, result);
  }
}

}  // namespace formwright
