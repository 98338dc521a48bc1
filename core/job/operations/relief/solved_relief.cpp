// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/operations/relief/solved_relief.h"

#include <algorithm>

#include "job/operations/relief/relief_base.h"

namespace formwright {
namespace {

// Of the time until the relief is solved, roughly; core/job/progress measures it.
constexpr double read_by = 0.1 / 0.9, set_up_by = 0.55 / 0.9;

}  // namespace

SolvedRelief solve_relief(const OperationCall& call, const ReliefOptions& options) {
  Context& context = call.context;
  SolvedRelief solved;
  std::shared_ptr<const LoadedModel> base_model;
  {
    const auto span = context.span(0, read_by, "Reading the model");
    solved.loaded = load_model(call);
    base_model = load_base(call, options);
    solved.painted = load_painting(call, *solved.loaded);
  }
  const Painting& painting = solved.painted.painting;
  const std::string of_model = "relief:" + solved.loaded->key + ":",
                    key = of_model + ReliefSolver::key(options, painting.weight);
  solved.solver = call.session.find<ReliefSolver>(key);
  solved.reused = solved.solver != nullptr;
  if (!solved.solver) {
    // The old factorisation goes first: two at once would not fit where one does.
    call.session.drop(of_model);
    const auto span = context.span(read_by, set_up_by, "Finding the visible surface");
    solved.solver = std::make_shared<ReliefSolver>(solved.loaded->model.mesh, options, context, painting.weight);
    call.session.keep(key, solved.solver, solved.solver->memory_mb());
  }
  const Stopwatch watch;
  solved.base_from_file = base_model != nullptr;
  solved.base = relief_base(base_model.get(), options, solved.solver->frame(), context);
  {
    const auto span = context.span(set_up_by, 1, "Fitting into the thickness");
    solved.relief = solved.solver->solve(options, solved.base, context, painting);
  }
  // The balanced appearance has a factorisation of its own, made by its first solve.
  if (options.appearance == Appearance::balanced) call.session.keep(key, solved.solver, solved.solver->memory_mb());
  solved.seconds_solve = watch.seconds();
  return solved;
}

CoveringMesh covering(const ReliefSolver& solver, const Relief& relief) {
  CoveringMesh mesh = relief.pieces.band.empty() ? CoveringMesh{relief.moved, solver.F()}
                                                 : CoveringMesh{relief.pieces.V, relief.pieces.F, &relief.pieces.band};
  if (relief.above_mm.size() > 0) {
    mesh.above_mm = &relief.above_mm;
    mesh.below_mm = &relief.below_mm;
  }
  return mesh;
}

PlateSize plate_of(const ViewFrame& frame, const ReliefOptions& options) {
  return {options.width_mm + 2 * options.margin_mm, frame.image_height * options.width_mm + 2 * options.margin_mm};
}

AllowedSpace allowed_space(const SolvedRelief& solved, const ReliefOptions& options) {
  const Relief& relief = solved.relief;
  AllowedSpace space{solved.base, options.thickness_mm, options.carve_depth_mm};
  if (relief.above_mm.size() == 0) return space;
  // Free regions stand out as far as they do; the space grows with them.
  const Positions& V = covering(*solved.solver, relief).V;
  for (Eigen::Index i = 0; i < V.rows(); ++i) {
    const double base_depth = solved.base.is_flat() ? 0 : solved.base.depth_at(V(i, 0), V(i, 1)).value_or(0);
    const double height_mm = options.width_mm * (base_depth - V(i, 2));
    space.above_mm = std::max(space.above_mm, std::min(height_mm, relief.above_mm[i]));
    space.below_mm = std::max(space.below_mm, relief.below_mm[i]);
  }
  return space;
}

}  // namespace formwright
