// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// One viewpoint's model as a relief in pieces on its pillars: thesis, eq. (3.11) and Figs. 3.7 and 3.14.
#include <memory>
#include <span>

#include "geometry/queries/ray_caster.h"
#include "relief/forest/pieces/forest_view.h"
#include "relief/forest/plan/relief_space.h"
#include "relief/forest/plan/wall_pieces.h"
#include "relief/relief.h"

namespace formwright {

/// A solved viewpoint.
struct ForestRelief {
  std::vector<WallPiece> pieces;  // those that vertices of the model lie on
  int pieces_without_vertices = 0;
  Relief relief;
  TriangleMesh surface;                     // all pieces, in the axes of the floor
  std::vector<int> face_piece;              // index into `pieces`
  std::shared_ptr<const RayCaster> caster;  // of `surface`
};

/// Bounds of every vertex from the pillars' surface on its ray, with a group for each piece. Vertices whose rays meet
/// no piece, or one without space for a relief, are free. Pieces without vertices are taken out of `pieces`, and
/// counted.
DepthBounds wall_bounds(const ForestView& view, const ViewFrame& frame, const ReliefSpace& space,
                        std::vector<WallPiece>& pieces, const ReliefOptions& options, const Visibility& visibility,
                        int& pieces_without_vertices, Context& context);

/// `solver`: of the viewpoint's model and view.relief_options(options).
/// Throws Error: invalid_input "scene" (no vertex of the model before a pillar); see ReliefSolver::solve.
ForestRelief solve_on_walls(ReliefSolver& solver, const ForestView& view, const ReliefSpace& space,
                            std::vector<WallPiece> pieces, const ReliefOptions& options, Context& context);

}  // namespace formwright
