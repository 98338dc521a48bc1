// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/operations/relief/thick_output.h"

#include "job/operations/relief/relief_base.h"
#include "relief/thick/thick_solid.h"

namespace formwright {

void check_thick_surface(const OperationCall& call, const ReliefOptions& options) {
  if (options.solid != SolidKind::thick) return;
  if (options.base != BaseShape::flat || call.inputs.contains(base_input_info().name))
    throw Error(
        ErrorCode::invalid_input, "solid",
        "A thick surface is joined to a flat base only: choose the base \"flat\" and leave out base_mesh, or make the solid filled.");
}

TriangleMesh thick_mesh(const SolvedRelief& solved, const ReliefOptions& options, PlateSize plate,
                        const AllowedSpace& space, Json& report, std::vector<std::string>& notes, Context& context) {
  const ThickSolid solid = thick_solid(solved.relief.moved, solved.solver->F(), solved.solver->frame().kappa,
                                       {.size_mm = options.width_mm,
                                        .plate = plate,
                                        .plate_mm = options.plate_mm,
                                        .wall_mm = options.wall_mm,
                                        .above_mm = space.above_mm,
                                        .below_mm = space.below_mm,
                                        .pixel_mm = options.pixel_mm,
                                        .tolerance_mm = solid_tolerance_share * options.thickness_mm},
                                       context);
  report["volume_mm3"] = solid.volume_mm3;
  report["hollows"] = solid.hollows;
  report["loose_parts"] = solid.loose_parts;
  report["smallest_gap_mm"] = 2 * solid.opening_mm;
  if (solid.loose_parts > 0)
    notes.push_back(std::to_string(solid.loose_parts) +
                    (solid.loose_parts == 1 ? " part of the solid touches" : " parts of the solid touch") +
                    " nothing else and would fall off: hold the outline to the base (outline_mm), or paint less of the "
                    "model free.");
  if (solid.hollows > 0)
    notes.push_back(
        "The solid encloses " + std::to_string(solid.hollows) + (solid.hollows == 1 ? " hollow" : " hollows") +
        ": empty from a printer that lays down plastic, full of resin or powder from others unless you drill "
        "a hole through the plate.");
  return solid.mesh;
}

}  // namespace formwright
