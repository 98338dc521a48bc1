// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Small scenes with known answers.
#include <cmath>
#include <numbers>

#include "geometry/samples/samples.h"
#include "relief/forest/forest.h"

namespace formwright::test {

/// At the origin, looking along +y.
inline PlanView straight_view(double from, double to) {
  PlanView view;
  view.from = from;
  view.to = to;
  view.distance_mm = 100;
  return view;
}

inline Pillar square_pillar(double x, double y, double side, double height = 100, double turn_deg = 0) {
  return {square_outline({x, y}, side, turn_deg), height};
}

/// Corners half a step away from the ray that touches the circle, where that lies at a multiple of a step.
inline Pillar round_pillar(double x, double y, double radius, int corners, double height = 100) {
  Pillar pillar{{}, height};
  for (int k = 0; k < corners; ++k) {
    const double angle = 2 * std::numbers::pi * (k + 0.5) / corners;
    pillar.outline_mm.emplace_back(x + radius * std::cos(angle), y + radius * std::sin(angle));
  }
  return pillar;
}

inline ForestViewpoint viewpoint(const Vec3& eye, const Vec3& look_at, double width_mm) {
  ForestViewpoint view;
  view.eye_mm = eye;
  view.look_at_mm = look_at;
  view.width_mm = width_mm;
  return view;
}

struct Solved {
  ForestPlan plan;
  std::vector<std::shared_ptr<ReliefSolver>> solvers;
  SolvedForest forest;
};

/// Every viewpoint looks at `mesh`.
inline Solved solved(const ForestScene& scene, const TriangleMesh& mesh, const ForestOptions& options) {
  Context context;
  Solved result;
  std::vector<const ViewFrame*> frames;
  for (const ForestViewpoint& viewpoint : scene.viewpoints) {
    const ForestView view(viewpoint);
    result.solvers.push_back(std::make_shared<ReliefSolver>(mesh, view.relief_options({}), context));
    frames.push_back(&result.solvers.back()->frame());
  }
  result.plan = plan_forest(scene, frames, options, context);
  result.forest = solve_forest(
      result.plan, [&](std::size_t v, Context&) { return result.solvers[v]; }, options, context);
  return result;
}

}  // namespace formwright::test
