// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What really is seen from the viewpoints, by rays at the finished solids.
#include <span>
#include <vector>

#include "relief/forest/pieces/forest_relief.h"
#include "relief/forest/pieces/piece_grid.h"

namespace formwright {

/// All solids in one, for rays.
struct StandingForest {
  TriangleMesh mesh;
  std::vector<int> face_pillar;
};
StandingForest standing_forest(std::span<const TriangleMesh> pillars);

/// A viewpoint with what was made for it.
struct CheckedView {
  const ForestView& view;
  const ViewFrame& frame;  // of the model
  const Triangles& model_F;
  const std::vector<PieceGrid>& grids;
};

/// Of the rays through a viewpoint's model, evenly spread over the picture.
struct ViewCheck {
  int rays = 0;
  int seen = 0;                               // meet the model's own piece
  int bare = 0;                               // meet a pillar's bare surface
  int nothing = 0;                            // meet no pillar
  int intruding = 0;                          // meet a piece of another model
  std::vector<int> intruding_rays_of_pillar;  // of each pillar
  double seen_share() const { return rays > 0 ? static_cast<double>(seen) / rays : 0; }
  double intruding_share() const { return rays > 0 ? static_cast<double>(intruding) / rays : 0; }
  int worst_pillar() const;  // with most of the intruding rays; -1 without any
};

/// `across`: rays across the model's width. A ray counts as seen where it ends at the depth that its own piece has
/// there or within a pixel of `pixel_mm`, up to 0.03 mm; on the surface of a pillar, within 0.01 mm, it meets no piece.
/// `own`: index of the viewpoint in `views`. Throws Error: cancelled.
ViewCheck check_view(std::span<const CheckedView> views, std::size_t own, std::span<const Pillar> pillars,
                     const StandingForest& forest, const RayCaster& caster, int across, double pixel_mm,
                     Context& context);

}  // namespace formwright
