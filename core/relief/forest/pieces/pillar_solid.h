// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A pillar with its pieces and its pin as one watertight solid.
#include <span>
#include <string>

#include "relief/forest/pieces/piece_solid.h"

namespace formwright {

/// The round pin below a pillar, which goes into a hole of the floor.
struct BasePin {
  double diameter_mm = 0, depth_mm = 0;
};

/// What is made of one pillar. In its underside are a groove from the pin towards +y of the floor, so that it can be
/// turned as the floor plan shows, and, where there is room, its number.
struct PillarSolid {
  TriangleMesh mesh;  // in the axes of the floor
  Vec2 pin_mm{0, 0};  // place of the pin
  double volume_mm3 = 0;
  bool watertight = false;
};

/// Throws Error{invalid_input, "pin_diameter_mm"} where a pillar is too narrow for its pin.
Vec2 checked_pin_place(const Pillar& pillar, int number, const BasePin& pin);

/// The pillar without pieces, with pin and mark, has the rooms cut out and then the raised pieces added, exactly.
/// Crumbs that carving cuts loose are left out. `number` counts from 1. Throws Error: see checked_pin_place;
/// could_not_solve, cancelled.
PillarSolid pillar_solid(const Pillar& pillar, int number, const BasePin& pin, std::span<const PieceSolids> pieces,
                         Context& context);

}  // namespace formwright
