// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Thickness of the rim that the clamp holds: it is never stretched, so calipers there say how thick the sheet was.
#include <string>
#include <vector>

#include "evidence/models/thermoform/formed_object.h"

namespace formwright {

/// Held by the clamp: outside of its opening.
bool is_on_rim(const Vec2& sheet_mm, const ThermoformOptions& options);

struct RimPlace {
  std::string side;  // "left", "right", "front", "back"
  Vec2 sheet_mm;
};

/// The middle of each side of the rim, midway between the opening and the sheet's edge; sides of less than 2 mm are
/// left out.
std::vector<RimPlace> rim_places(const ThermoformOptions& options);

/// A sentence where readings on opposite sides of the rim say that the sheet was thicker or thinner than its set-up
/// has it; else empty.
std::string thickness_note(const FormedObject& object);

}  // namespace formwright
