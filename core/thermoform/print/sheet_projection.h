// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Every point of the model's surface to the point of the flat sheet that forms over it: thesis 4.2.4, step 2.
#include <cstdint>

#include "base/context.h"
#include "thermoform/sheet/formed_sheet.h"
#include "thermoform/print/print_options.h"
#include "thermoform/print/surface_refinement.h"

namespace formwright {

/// Why a point has no place on the sheet.
enum class Coverage : std::uint8_t {
  coloured = 0,
  hidden = 1,       // an undercut, or under another part of the model
  not_touched = 2,  // the sheet spans it, farther off than the gap allowed, or is torn between two places
  below_plate = 3,
  outside = 4,  // beyond the clamp's opening
};
inline constexpr int coverage_kinds = 5;

struct ProjectedSurface {
  std::vector<Coverage> vertex;  // n
  std::vector<Coverage> face;    // m: coloured where all three corners are and land together, else the worst corner's
  TextureCoordinates sheet_mm;   // n x 2; 0 where not coloured
  Eigen::VectorXd gap_mm;        // n: to the sheet's inner surface; 0 where not coloured
  Eigen::VectorXd stretch;       // n: of the sheet there, area now over area then; 0 where not coloured
};

/// `surface` in machine coordinates, `sheet` as formed over it. A point belongs to the nearest point of the sheet's
/// inner surface (half the thickness inside the middle one) among faces that look the same way, at most options.gap_mm
/// away; with SheetProjectionMethod::along_normal to the nearest hit of the line along its normal.
///
/// The nearest point is the truer of the two: where the sheet spans a right-angled corner with gap g, it carries both
/// walls side by side onto the span, while rays lay both walls over all of it; on convex edges they agree.
/// Throws Error{invalid_input, "sheet"}: a sheet without faces, or whose columns are not one number a vertex.
ProjectedSurface project_onto_sheet(const RefinedSurface& surface, const FormedSheet& sheet,
                                    const ThermoformPrintOptions& options, Context& context);

}  // namespace formwright
