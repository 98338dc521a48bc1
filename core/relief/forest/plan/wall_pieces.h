// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Which viewpoint each part of the pillars' surfaces belongs to.
#include <span>
#include <string>
#include <vector>

#include "base/data/parameters.h"
#include "relief/forest/plan/seen_walls.h"

namespace formwright {

/// What becomes of a surface that several viewpoints see within their pictures.
enum class SharedWalls { bare, squarest, refused };
template <>
struct EnumNames<SharedWalls> {
  static constexpr std::array<std::string_view, 3> names{"bare", "squarest", "refused"};
  static constexpr std::array<std::string_view, 3> labels{"Leave bare", "Give to one", "Refuse"};
};

/// A part of a pillar's surface on which one viewpoint sees a part of its model: strips side by side.
struct WallPiece {
  int pillar = 0;
  std::vector<WallStrip> strips;  // in order; each begins where the one before ends
  double from() const { return strips.front().from; }
  double to() const { return strips.back().to; }
  const WallStrip& strip_at(double t) const;
};

/// A part of an edge that two viewpoints see within their pictures: places on it from 0 to 1.
struct SharedWall {
  int pillar = 0, edge = 0;
  double from = 0, to = 0;
  int views[2] = {0, 0};
};

struct WallAssignment {
  std::vector<std::vector<WallPiece>> pieces;  // of each viewpoint, in order of tangents
  std::vector<double> seen_share, used_share;  // of each viewpoint's range of tangents: met by rays, and given to it
  std::vector<SharedWall> shared;              // of every two viewpoints, whoever gets them
};

/// `strips`: of each viewpoint, as seen_walls has them. No place belongs to two viewpoints. Pieces narrower than
/// `min_width_mm` along the surface are left bare.
/// Throws Error{invalid_input}: "shared_walls", where two see one place and that is refused; "scene", where a viewpoint
/// sees no pillar, or has none left.
WallAssignment assign_walls(std::span<const PlanView> views, std::span<const Pillar> pillars,
                            const std::vector<std::vector<WallStrip>>& strips, SharedWalls shared, double min_width_mm);

}  // namespace formwright
