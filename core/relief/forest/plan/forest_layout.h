// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Pillars that nobody has to set by hand.
#include <cstdint>
#include <span>
#include <string_view>

#include "base/data/parameters.h"
#include "relief/forest/plan/forest_scene.h"
#include "relief/forest/plan/plan_view.h"

namespace formwright {

enum class PillarShape { mixed, square, round, hexagon };
template <>
struct EnumNames<PillarShape> {
  static constexpr std::array<std::string_view, 4> names{"mixed", "square", "round", "hexagon"};
  static constexpr std::array<std::string_view, 4> labels{"Mixed", "Square", "Round", "Hexagonal"};
};

/// What all layouts share. Lengths in mm.
struct PillarKind {
  PillarShape shape = PillarShape::mixed;
  double width_mm = 12;  // diameter, or from side to side
  double height_mm = 120;
  double gap_mm = 4;  // between any two pillars, at least
};

/// A rectangle of the floor about its middle.
struct FloorArea {
  Vec2 centre{0, 0};
  double width_mm = 0, depth_mm = 0;
};

/// `columns` x `rows` pillars, evenly spread over the area from edge to edge, which is turned counter-clockwise about
/// its middle; the shapes of `mixed` take turns.
/// Throws Error{invalid_input, "pillar_width_mm"} where they would stand closer than the gap.
std::vector<Pillar> grid_of_pillars(const FloorArea& area, int columns, int rows, double turn_deg,
                                    const PillarKind& kind);

/// `count` pillars at random places and turns; equal seeds give equal pillars. Throws Error{invalid_input,
/// "pillar_count"} where no room is found for so many.
std::vector<Pillar> random_pillars(const FloorArea& area, int count, const PillarKind& kind, std::uint64_t seed);

/// For every viewpoint a staggered row of pillars at random distances, from `outer_mm` to `inner_mm` before what it
/// looks at, which together stop all rays to its model; their width varies with the distance. Pillars of one viewpoint
/// do not stand in the rays of another before these are stopped. Throws Error{invalid_input, "screen_outer_mm"} where
/// no room is found for that.
std::vector<Pillar> screens_of_pillars(std::span<const PlanView> views, double outer_mm, double inner_mm,
                                       const PillarKind& kind, std::uint64_t seed);

}  // namespace formwright
