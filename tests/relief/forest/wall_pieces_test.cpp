// SPDX-License-Identifier: GPL-3.0-or-later
// Which viewpoint each surface belongs to.
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>

#include "relief/forest/forest_fixture.h"

namespace formwright {
namespace {
using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::WithinAbs;
using test::square_pillar;
using test::straight_view;

struct Plan {
  std::vector<PlanView> views;
  std::vector<Pillar> pillars;
  std::vector<std::vector<WallStrip>> strips;
  WallAssignment assigned(SharedWalls shared) const { return assign_walls(views, pillars, strips, shared, 0.1); }
};

/// Two viewpoints see the front of one square, which lies at y = 90: the second, 60 mm to the right, sees the part from
/// x = 2 on only, and the side at x = 10, too.
Plan two_views() {
  Plan plan;
  plan.views = {straight_view(-0.2, 0.2), straight_view(0, 0)};
  plan.views[1].eye = Vec2(60, 0);
  plan.views[1].from = (2 - 60) / 90.0;
  plan.views[1].to = 0;
  plan.pillars = {square_pillar(0, 100, 20)};
  for (const PlanView& view : plan.views) plan.strips.push_back(seen_walls(view, plan.pillars, Context()));
  return plan;
}

double front_right_end(const WallAssignment& walls) { return 90 * walls.pieces[0].front().to(); }

TEST_CASE("WallPieces.SharedPlacesStayBare") {
  const WallAssignment walls = two_views().assigned(SharedWalls::bare);
  REQUIRE(walls.pieces[0].size() == 1);
  CHECK_THAT(90 * walls.pieces[0][0].from(), WithinAbs(-10, 1e-5));
  CHECK_THAT(front_right_end(walls), WithinAbs(2, 1e-5));
  // The second keeps the side.
  REQUIRE(walls.pieces[1].size() == 1);
  CHECK(walls.pieces[1][0].strips.size() == 1);
  CHECK_THAT(walls.seen_share[0], WithinAbs(20 / 90.0 / 0.4, 1e-6));
  CHECK_THAT(walls.used_share[0], WithinAbs(12 / 90.0 / 0.4, 1e-6));
}

TEST_CASE("WallPieces.WhatTwoSeeIsNamedWhoeverGetsIt") {
  for (const SharedWalls rule : {SharedWalls::bare, SharedWalls::squarest}) {
    const Plan plan = two_views();
    const WallAssignment walls = plan.assigned(rule);
    REQUIRE(walls.shared.size() == 1);
    const SharedWall& wall = walls.shared[0];
    const Vec2 &a = corner(plan.pillars[0].outline_mm, wall.edge),
               &b = corner(plan.pillars[0].outline_mm, wall.edge + 1);
    CHECK((a + wall.from * (b - a) - Vec2(2, 90)).norm() < 1e-5);
    CHECK((a + wall.to * (b - a) - Vec2(10, 90)).norm() < 1e-5);
    CHECK((wall.views[0] == 0 && wall.views[1] == 1));
  }
}

TEST_CASE("WallPieces.TheSquarestViewGetsThem") {
  const WallAssignment walls = two_views().assigned(SharedWalls::squarest);
  CHECK_THAT(front_right_end(walls), WithinAbs(10, 1e-5));
  CHECK(walls.pieces[1].size() == 1);
}

TEST_CASE("WallPieces.RefusedNamesThePillarAndTheViews") {
  try {
    two_views().assigned(SharedWalls::refused);
    FAIL("not refused");
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::invalid_input);
    CHECK(error.where() == "shared_walls");
    CHECK_THAT(error.what(), ContainsSubstring("Viewpoints 1 and 2") && ContainsSubstring("pillar 1"));
  }
}

TEST_CASE("WallPieces.NoPlaceBelongsToTwo") {
  // A ring of squares seen from four sides, at close range so that much is shared.
  Plan plan;
  for (int side = 0; side < 4; ++side) {
    PlanView view;
    const double angle = 0.5 * std::numbers::pi * side + 0.1;
    view.eye = 200 * Vec2(std::cos(angle), std::sin(angle));
    view.forward = -view.eye.normalized();
    view.from = -0.4;
    view.to = 0.4;
    plan.views.push_back(view);
  }
  for (int k = 0; k < 9; ++k)
    plan.pillars.push_back(square_pillar(60 * std::cos(0.7 * k), 60 * std::sin(0.7 * k), 16, 100, 20 * k));
  for (const PlanView& view : plan.views) plan.strips.push_back(seen_walls(view, plan.pillars, Context()));
  for (const SharedWalls shared : {SharedWalls::bare, SharedWalls::squarest}) {
    const WallAssignment walls = plan.assigned(shared);
    struct Part {
      std::size_t view;
      int pillar, edge;
      double from, to;
    };
    std::vector<Part> parts;
    for (std::size_t v = 0; v < 4; ++v)
      for (const WallPiece& piece : walls.pieces[v])
        for (const WallStrip& s : piece.strips) {
          const Pillar& pillar = plan.pillars[static_cast<std::size_t>(s.pillar)];
          parts.push_back({v, s.pillar, s.edge, place_on_edge(plan.views[v], pillar, s.edge, s.from),
                           place_on_edge(plan.views[v], pillar, s.edge, s.to)});
        }
    for (const Part& a : parts)
      for (const Part& b : parts)
        if (a.view < b.view && a.pillar == b.pillar && a.edge == b.edge)
          CHECK(std::min(a.to, b.to) - std::max(a.from, b.from) < 1e-9);
    for (std::size_t v = 0; v < 4; ++v) CHECK(walls.used_share[v] <= walls.seen_share[v] + 1e-12);
  }
}

TEST_CASE("WallPieces.AViewpointWithoutPillarsIsRefused") {
  Plan plan = two_views();
  plan.strips[1].clear();
  CHECK_THROWS_WITH(plan.assigned(SharedWalls::bare),
                    ContainsSubstring("viewpoint 2") && ContainsSubstring("meets a pillar"));
}

}  // namespace
}  // namespace formwright
