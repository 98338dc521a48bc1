// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Numbered crosses on the clamped rim, outlines, and the template that carries their places to the frame. All in sheet
// coordinates: mm, y to the back of the machine, the origin in the middle.
#include <optional>
#include <vector>

#include "imaging/drawing/drawing.h"
#include "thermoform/print/print_options.h"

namespace formwright {

struct RegistrationMark {
  std::string name;  // "1" at the front left, then counter-clockwise seen from above
  Vec2 place_mm;
};

/// Where the rim is narrower than this (mm) there is no room for marks.
inline constexpr double narrowest_rim_mm = 4;

/// Corners and middles of the sides, in the middle of the clamped rim. Empty when the rim is too narrow.
std::vector<RegistrationMark> registration_marks(const ThermoformPrintOptions& options);

/// What options.marks and options.outlines put onto the sheet.
Drawing sheet_drawing(const ThermoformPrintOptions& options);

/// The word MIRRORED, to be drawn as it is onto a print that has been mirrored; nothing when it has not.
std::optional<Label> mirrored_label(const ThermoformPrintOptions& options);

/// The frame seen from above: opening, sheet, marks with their coordinates, and a line of 100 mm to check the scale by.
Drawing frame_template(const ThermoformPrintOptions& options);

}  // namespace formwright
