// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A relief solved for a job, which its operations write, light and measure.
#include <memory>

#include "job/contract/model_input.h"
#include "job/operations/relief/painting/loaded_painting.h"
#include "relief/height_map.h"
#include "relief/relief.h"

namespace formwright {

/// Of the relief's thickness: how far the solid's larger triangles may leave the height field.
inline constexpr double solid_tolerance_share = 1e-3;

struct SolvedRelief {
  std::shared_ptr<const LoadedModel> loaded;
  std::shared_ptr<ReliefSolver> solver;
  bool reused = false;  // the solver was found in the session
  BaseSurface base;
  bool base_from_file = false;
  LoadedPainting painted;
  Relief relief;
  double seconds_solve = 0;
};

/// Reads the inputs, takes the solver from the session or makes and keeps it there, and solves; reports progress over
/// the current span. Throws Error: see load_model, load_base, ReliefSolver.
SolvedRelief solve_relief(const OperationCall& call, const ReliefOptions& options);

/// What stands before the base: the relief, or on steps its pieces. Both must outlive it.
CoveringMesh covering(const ReliefSolver& solver, const Relief& relief);

PlateSize plate_of(const ViewFrame& frame, const ReliefOptions& options);

/// `solved` must outlive it.
AllowedSpace allowed_space(const SolvedRelief& solved, const ReliefOptions& options);

}  // namespace formwright
