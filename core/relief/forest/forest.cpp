// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/forest/forest.h"

#include <algorithm>
#include <cmath>

#include "base/format.h"

namespace formwright {
namespace {

constexpr double between_reliefs_mm = 0.2;      // left between the reliefs of two neighbouring pillars
constexpr double min_piece_width_mm = 0.3;      // of a surface that is worth a piece
constexpr double solid_tolerance_share = 5e-3;  // of the thickness
constexpr double max_nodes = sizeof(void*) > 4 ? 40e6 : 10e6;
constexpr double room_beside_model = 0.02;  // of its width: what a viewpoint claims beyond its model

double gap_mm(const ForestOptions& options) { return 2 * options.thickness_mm + between_reliefs_mm; }

ReliefOptions solver_options(const ForestOptions& options) {
  ReliefOptions relief;
  relief.thickness_mm = options.thickness_mm;
  relief.carve_depth_mm = options.carve_depth_mm;
  relief.bounded_vertices = options.bounded_vertices;
  relief.hidden_weight = options.hidden_weight;
  relief.depth_order = options.depth_order;
  return relief;
}

std::vector<Pillar> pillars_of_layout(const ForestPlan& plan, const ForestOptions& options) {
  const PillarKind kind{options.pillar_shape, options.pillar_width_mm, options.pillar_height_mm, gap_mm(options)};
  FloorArea area{Vec2(0, 0), options.area_width_mm, options.area_depth_mm};
  for (const ForestViewpoint& viewpoint : plan.scene.viewpoints)
    area.centre += viewpoint.look_at_mm.head<2>() / static_cast<double>(plan.scene.viewpoints.size());
  const auto seed = static_cast<std::uint64_t>(options.seed);
  switch (options.layout) {
    case PillarLayout::grid:
      return grid_of_pillars(area, options.grid_columns, options.grid_rows, options.grid_turn_deg, kind);
    case PillarLayout::random: return random_pillars(area, options.pillar_count, kind, seed);
    default:
      if (options.screen_inner_mm >= options.screen_outer_mm)
        throw Error(ErrorCode::invalid_input, "screen_outer_mm",
                    "Screens end before they begin: make screen_outer_mm larger than screen_inner_mm.");
      return screens_of_pillars(plan.plan_views, options.screen_outer_mm, options.screen_inner_mm, kind, seed);
  }
}

void check_sizes(const ForestPlan& plan, const ForestOptions& options) {
  double nodes = 0;
  for (std::size_t v = 0; v < plan.views.size(); ++v)
    for (const WallPiece& piece : plan.walls.pieces[v])
      nodes += node_count(plan.plan_views[v], plan.scene.pillars[static_cast<std::size_t>(piece.pillar)], piece,
                          {options.pixel_mm});
  if (nodes > max_nodes)
    throw Error(ErrorCode::invalid_input, "pixel_mm",
                "The pieces would have more than " + with_digits(max_nodes / 1e6, 2) +
                    " million points: raise the detail spacing (pixel_mm) to " +
                    with_digits(1.01 * options.pixel_mm * std::sqrt(nodes / max_nodes), 2) + " mm or more.");
}

std::string name_of(const ForestPlan& plan, std::size_t view) {
  const std::string& model = plan.scene.viewpoints[view].model;
  return "viewpoint " + std::to_string(view + 1) + (model.empty() ? "" : " (" + model + ")");
}

void refuse_intrusion(const ForestPlan& plan, const std::vector<ViewCheck>& checks) {
  for (std::size_t v = 0; v < checks.size(); ++v)
    if (const int worst = checks[v].worst_pillar(); worst >= 0)
      throw Error(ErrorCode::invalid_input, "intrusion",
                  "Pieces of other models cover " + with_digits(std::max(0.01, 100 * checks[v].intruding_share()), 2) +
                      " % of the picture from " + name_of(plan, v) + ", most of it on pillar " +
                      std::to_string(worst + 1) +
                      ": move this pillar, leave shared surfaces bare, or allow intrusion.");
}

/// Solids of all pillars, from the pieces of all viewpoints.
void make_solids(const ForestPlan& plan, const ForestOptions& options, SolvedForest& forest, Context& context) {
  const std::vector<Pillar>& pillars = plan.scene.pillars;
  const WallSpace space{options.thickness_mm, options.carve_depth_mm};
  std::vector<std::vector<std::pair<std::size_t, std::size_t>>> pieces(pillars.size());  // viewpoint and grid
  for (std::size_t v = 0; v < forest.grids.size(); ++v)
    for (std::size_t g = 0; g < forest.grids[v].size(); ++g)
      pieces[static_cast<std::size_t>(forest.grids[v][g].pillar)].emplace_back(v, g);
  for (std::size_t p = 0; p < pillars.size(); ++p) {
    const double begin = static_cast<double>(p) / static_cast<double>(pillars.size());
    const auto span = context.span(begin, begin + 1 / static_cast<double>(pillars.size()), "Making the pillars");
    std::vector<PieceSolids> solids;
    for (const auto& [v, g] : pieces[p])
      if (forest.grids[v][g].any_covered())
        solids.push_back(piece_solids(forest.grids[v][g], plan.views[v], space,
                                      solid_tolerance_share * (space.above_mm + space.below_mm), context));
    const int number = static_cast<int>(p) + 1;
    try {
      forest.pillars.push_back(
          pillar_solid(pillars[p], number, {options.pin_diameter_mm, options.pin_depth_mm}, solids, context));
    } catch (const Error& error) {
      if (error.code() != ErrorCode::could_not_solve && error.code() != ErrorCode::invalid_input) throw;
      if (error.where() == "pin_diameter_mm") throw;
      throw Error(ErrorCode::could_not_solve, "scene",
                  "The pieces of pillar " + std::to_string(number) +
                      " could not be joined to it: move it a little or choose another detail spacing (pixel_mm).");
    }
  }
}

}  // namespace

ForestPlan plan_forest(ForestScene scene, std::span<const ViewFrame* const> frames, const ForestOptions& options,
                       Context& context) {
  ForestPlan plan;
  plan.scene = std::move(scene);
  for (std::size_t v = 0; v < frames.size(); ++v) {
    plan.views.emplace_back(plan.scene.viewpoints[v]);
    PlanView in_plan = plan.views.back().plan();
    const Vec2 range = range_of_tangents(plan.views.back(), *frames[v], static_cast<int>(v) + 1);
    const double room = room_beside_model * (range[1] - range[0]);
    in_plan.from = range[0] - room;
    in_plan.to = range[1] + room;
    plan.plan_views.push_back(in_plan);
    plan.height_shares.push_back(frames[v]->image_height);
  }
  if (options.layout != PillarLayout::scene) plan.scene.pillars = pillars_of_layout(plan, options);
  check_forest(plan.scene, gap_mm(options));
  orient_outlines(plan.scene);
  for (const PlanView& view : plan.plan_views) plan.strips.push_back(seen_walls(view, plan.scene.pillars, context));
  for (std::size_t p = 0; p < plan.scene.pillars.size(); ++p)
    plan.pins_mm.push_back(checked_pin_place(plan.scene.pillars[p], static_cast<int>(p) + 1,
                                             {options.pin_diameter_mm, options.pin_depth_mm}));
  plan.walls = assign_walls(plan.plan_views, plan.scene.pillars, plan.strips, options.shared_walls, min_piece_width_mm);
  return plan;
}

SolvedForest solve_forest(const ForestPlan& plan,
                          const std::function<std::shared_ptr<ReliefSolver>(std::size_t, Context&)>& solver_of,
                          const ForestOptions& options, Context& context) {
  check_sizes(plan, options);
  SolvedForest forest;
  const std::size_t views = plan.views.size();
  const std::vector<Pillar>& pillars = plan.scene.pillars;
  Stopwatch watch;
  std::vector<ViewFrame> frames;
  std::vector<Triangles> faces;
  for (std::size_t v = 0; v < views; ++v) {
    const double begin = 0.4 * static_cast<double>(v) / static_cast<double>(views);
    const auto span = context.span(begin, begin + 0.4 / static_cast<double>(views), "Solving the reliefs");
    const std::shared_ptr<ReliefSolver> solver = solver_of(v, context);
    const ReliefOptions relief = plan.views[v].relief_options(solver_options(options));
    // Who shows a surface to others as well cannot hide what stands on it from them.
    const ReliefSpace space({pillars, plan.plan_views, plan.strips}, v, {options.thickness_mm, options.carve_depth_mm},
                            options.shared_walls != SharedWalls::squarest);
    forest.reliefs.push_back(solve_on_walls(*solver, plan.views[v], space, plan.walls.pieces[v], relief, context));
    frames.push_back(solver->frame());
    faces.push_back(solver->F());
    forest.grids.emplace_back();
    for (std::size_t k = 0; k < forest.reliefs[v].pieces.size(); ++k)
      forest.grids[v].push_back(
          piece_grid(forest.reliefs[v], static_cast<int>(k), plan.views[v], space, {options.pixel_mm}, context));
  }
  forest.seconds_solve = watch.lap();
  {
    const auto span = context.span(0.4, 0.9, "Making the pillars");
    make_solids(plan, options, forest, context);
  }
  forest.seconds_solids = watch.lap();
  const auto span = context.span(0.9, 1, "Looking from the viewpoints");
  std::vector<TriangleMesh> meshes;
  for (const PillarSolid& pillar : forest.pillars) meshes.push_back(pillar.mesh);
  forest.standing = standing_forest(meshes);
  forest.caster = std::make_shared<const RayCaster>(forest.standing.mesh);
  std::vector<CheckedView> checked;
  for (std::size_t v = 0; v < views; ++v) checked.push_back({plan.views[v], frames[v], faces[v], forest.grids[v]});
  for (std::size_t v = 0; v < views; ++v) {
    context.progress(static_cast<double>(v) / static_cast<double>(views));
    forest.checks.push_back(check_view(checked, v, pillars, forest.standing, *forest.caster, options.check_rays,
                                       options.pixel_mm, context));
  }
  forest.seconds_check = watch.lap();
  if (options.intrusion == Intrusion::refused) refuse_intrusion(plan, forest.checks);
  return forest;
}

}  // namespace formwright
