// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Several models, each seen from a viewpoint of its own, in pieces on free-standing pillars: from its viewpoint each
// lines up to the whole, from elsewhere all fall apart. Thesis, section 3.3, "3D camouflage", Figs. 3.13 and 3.14.
#include <functional>
#include <memory>

#include "relief/forest/forest_check.h"
#include "relief/forest/forest_options.h"
#include "relief/forest/pieces/pillar_solid.h"

namespace formwright {

/// What the floor plan shows, before anything is solved.
struct ForestPlan {
  ForestScene scene;  // with its pillars, outlines counter-clockwise
  std::vector<ForestView> views;
  std::vector<PlanView> plan_views;            // with the models' ranges of tangents
  std::vector<double> height_shares;           // height of each model's picture as a share of its width
  std::vector<std::vector<WallStrip>> strips;  // what each viewpoint sees
  WallAssignment walls;
  std::vector<Vec2> pins_mm;  // place of each pillar's pin
};

/// `scene`: has passed check_viewpoints. `frames`: of each viewpoint's model, by make_view_frame and
/// ForestView::relief_options. Pillars are made where
/// `options.layout` asks for them, and replace those of the scene.
/// Throws Error{invalid_input}: see check_forest, checked_pin_place, assign_walls and the layouts.
ForestPlan plan_forest(ForestScene scene, std::span<const ViewFrame* const> frames, const ForestOptions& options,
                       Context& context);

struct SolvedForest {
  std::vector<ForestRelief> reliefs;          // of each viewpoint
  std::vector<std::vector<PieceGrid>> grids;  // of each viewpoint
  std::vector<PillarSolid> pillars;
  std::vector<ViewCheck> checks;  // of each viewpoint
  StandingForest standing;
  std::shared_ptr<const RayCaster> caster;  // of `standing`
  double seconds_solve = 0, seconds_solids = 0, seconds_check = 0;
};

/// `solver_of`: (viewpoint, context) -> the solver of its model, which must live until the next call.
/// Throws Error: invalid_input "pixel_mm" (too many points), "intrusion" (a piece of another model
/// shows within a picture and that is refused); see solve_on_walls and pillar_solid.
SolvedForest solve_forest(const ForestPlan& plan,
                          const std::function<std::shared_ptr<ReliefSolver>(std::size_t, Context&)>& solver_of,
                          const ForestOptions& options, Context& context);

}  // namespace formwright
