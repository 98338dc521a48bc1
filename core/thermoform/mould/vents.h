// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Where air is trapped: the last places to form.
#include <string>
#include <vector>

#include "base/context.h"
#include "thermoform/sheet/formed_sheet.h"
#include "thermoform/sheet/placement.h"

namespace formwright {

struct Vent {
  Vec3 position_mm = Vec3::Zero();  // on the model, machine coordinates
  double contact_s = -1;            // when the sheet arrived there; -1: it never did
  double gap_mm = 0;                // between sheet and model, straight down, less half the sheet's thickness
};

/// A sheet that was formed over a model standing at `real`, moved to where the model should stand: the machine shifts,
/// turns and scales the mould (sheet_effects.h), and a hole belongs into the mould.
FormedSheet about_the_model(FormedSheet sheet, const Placement& nominal, const Placement& real);

/// At most `count` places of `solid` (closed, on z = 0) below local maxima of the time of contact, the latest first and
/// those that were never reached, by their gap, before them; equally late ones by how deep they lie among their
/// surroundings. Centres are `spacing_mm` apart, and far enough from the model's outline that a hole of
/// `diameter_mm` does not break through a side. Throws Error{cancelled}.
std::vector<Vent> find_vents(const TriangleMesh& solid, const FormedSheet& sheet, int count, double diameter_mm,
                             double spacing_mm, Context& context);

}  // namespace formwright
