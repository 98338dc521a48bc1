// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Thick surfaces as a solid of the operation `relief`.
#include <string>
#include <vector>

#include "job/operations/relief/solved_relief.h"

namespace formwright {

/// Throws Error{invalid_input, "solid"} for a thick surface on a base that it cannot be joined to.
void check_thick_surface(const OperationCall& call, const ReliefOptions& options);

/// The solid, mm, lying on its back. Adds its figures to `report`, and to `notes` what the maker should know about it.
/// `plate` and `space`: of the solved relief. Throws Error as thick_solid does.
TriangleMesh thick_mesh(const SolvedRelief& solved, const ReliefOptions& options, PlateSize plate,
                        const AllowedSpace& space, Json& report, std::vector<std::string>& notes, Context& context);

}  // namespace formwright
