// SPDX-License-Identifier: GPL-3.0-or-later
// Reliefs in pieces: bounds, borders, and that they look as in one piece.
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <Eigen/Geometry>

#include "relief/forest/forest_fixture.h"

namespace formwright {
namespace {
using test::round_pillar;
using test::square_pillar;
using test::viewpoint;

struct OnWalls {
  ForestScene scene;
  ForestView view;
  std::vector<PlanView> plan_views;
  std::vector<std::vector<WallStrip>> strips;
  WallSpace space;
  std::shared_ptr<ReliefSolver> solver;
  ForestRelief relief;
};

OnWalls on_walls(const Vec3& eye, double carve_mm) {
  Context context;
  ForestScene scene;
  scene.viewpoints = {viewpoint(eye, {0, 0, 50}, 60)};
  scene.pillars = {square_pillar(-26, -10, 15, 110), round_pillar(-12, 14, 8.5, 40, 110),
                   square_pillar(2, -20, 14, 110, 30), square_pillar(16, 8, 16, 110),
                   round_pillar(32, -12, 9, 40, 110)};
  OnWalls result{scene, ForestView(scene.viewpoints[0]), {}, {}, {2, carve_mm}, nullptr, {}};
  const TriangleMesh mesh = make_sample("bust", 4000, context).mesh;
  ReliefOptions options;
  options.thickness_mm = 2;
  options.carve_depth_mm = carve_mm;
  options = result.view.relief_options(options);
  result.solver = std::make_shared<ReliefSolver>(mesh, options, context);
  PlanView plan = result.view.plan();
  const Vec2 range = range_of_tangents(result.view, result.solver->frame(), 1);
  plan.from = range[0];
  plan.to = range[1];
  result.plan_views = {plan};
  result.strips = {seen_walls(plan, result.scene.pillars, context)};
  const WallAssignment walls =
      assign_walls(result.plan_views, result.scene.pillars, result.strips, SharedWalls::bare, 0.3);
  const ReliefSpace space({result.scene.pillars, result.plan_views, result.strips}, 0, result.space, true);
  result.relief = solve_on_walls(*result.solver, result.view, space, walls.pieces[0], options, context);
  return result;
}

TEST_CASE("ForestRelief.EveryVertexIsInItsSpace") {
  // Level with the middle, and from above: then the looking direction is not level.
  for (const Vec3& eye : {Vec3(0, -400, 50), Vec3(-60, -380, 160)})
    for (const double carve : {0.0, 1.5}) {
      const OnWalls s = on_walls(eye, carve);
      CHECK(s.relief.pieces.size() >= 5);
      CHECK(s.relief.relief.bound_violation_max_mm <= 0);
      for (Eigen::Index i = 0; i < s.relief.relief.lambda_mm.size(); ++i) {
        CHECK(s.relief.relief.lambda_mm[i] >= s.relief.relief.lambda_min_mm[i]);
        CHECK(s.relief.relief.lambda_mm[i] <= s.relief.relief.lambda_max_mm[i]);
      }
      // Of the cut surface: each vertex near its pillar, and between the first and the last ray of its piece.
      double max_above = 0, max_below = 0;
      for (Eigen::Index f = 0; f < s.relief.surface.F.rows(); ++f) {
        const WallPiece& piece =
            s.relief.pieces[static_cast<std::size_t>(s.relief.face_piece[static_cast<std::size_t>(f)])];
        const Outline& outline = s.scene.pillars[static_cast<std::size_t>(piece.pillar)].outline_mm;
        for (int k = 0; k < 3; ++k) {
          const Vec3 p = s.relief.surface.V.row(s.relief.surface.F(f, k)).transpose();
          const double t = s.view.ray_point(p).aside;
          REQUIRE(t >= piece.from() - 1e-9);
          REQUIRE(t <= piece.to() + 1e-9);
          const double off = distance_to_outline(outline, p.head<2>());
          (is_inside(outline, p.head<2>()) ? max_below : max_above) =
              std::max(is_inside(outline, p.head<2>()) ? max_below : max_above, off);
        }
      }
      CHECK(max_above <= 2 + 1e-6);
      CHECK(max_above > 1.9);
      CHECK(max_below <= carve + 1e-6);
      if (carve > 0) CHECK(max_below > 0.9 * carve);
    }
}

TEST_CASE("ForestRelief.LooksAsInOnePiece") {
  const OnWalls s = on_walls({0, -400, 50}, 0);
  const ViewFrame& frame = s.solver->frame();
  const TriangleMesh whole{s.view.to_world(s.relief.relief.seen, frame.kappa), s.solver->F()};
  const RayCaster caster(whole);
  const auto normal = [](const TriangleMesh& mesh, int face) {
    const Vec3 a = mesh.V.row(mesh.F(face, 0)), b = mesh.V.row(mesh.F(face, 1)), c = mesh.V.row(mesh.F(face, 2));
    return Vec3((b - a).cross(c - a).normalized());
  };
  int rays = 0, same = 0, in_piece = 0;
  for (int row = 0; row < 200; ++row)
    for (int column = 0; column < 160; ++column) {
      const double x = (column + 0.5) / 160 - 0.5, y = frame.image_height * ((row + 0.5) / 200 - 0.5);
      const Vec3 direction = s.view.picture_ray(x, y);
      const double t = s.view.ray_point(s.view.eye() + direction).aside;
      bool is_in_piece = false;
      for (const WallPiece& piece : s.relief.pieces)
        is_in_piece = is_in_piece || (piece.from() <= t && t <= piece.to());
      const auto expected = caster.first_hit(s.view.eye(), direction, 0, 1e4);
      const auto found = s.relief.caster->first_hit(s.view.eye(), direction, 0, 1e4);
      if (!expected) {
        CHECK_FALSE(found.has_value());
        continue;
      }
      ++rays;
      CHECK(found.has_value() == is_in_piece);
      if (!found) continue;
      ++in_piece;
      // Scaling about the eye turns no normal; only triangles on borders are bent, to keep their bounds.
      same += normal(whole, expected->face).dot(normal(s.relief.surface, found->face)) > 1 - 1e-6;
    }
  CHECK(rays > 10000);
  CHECK(in_piece > 0.95 * rays);
  CHECK(same > 0.93 * in_piece);
}

}  // namespace
}  // namespace formwright
