// SPDX-License-Identifier: GPL-3.0-or-later
// Pillars that are made: where they stand, and that seeds decide it.
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include "relief/forest/forest_fixture.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

std::vector<PlanView> four_views() {
  std::vector<PlanView> views;
  const Vec2 sides[] = {{0, -1}, {1, 0}, {0, 1}, {-1, 0}};
  for (const Vec2& side : sides) {
    PlanView view;
    view.eye = 600 * side;
    view.forward = -side;
    view.from = -0.07;
    view.to = 0.07;
    view.distance_mm = 600;
    views.push_back(view);
  }
  return views;
}

double closest(const std::vector<Pillar>& pillars) {
  double nearest = INFINITY;
  for (std::size_t p = 0; p < pillars.size(); ++p)
    for (std::size_t q = 0; q < p; ++q)
      nearest = std::min(nearest, distance_between(pillars[p].outline_mm, pillars[q].outline_mm));
  return nearest;
}

bool are_equal(const std::vector<Pillar>& a, const std::vector<Pillar>& b) {
  return std::ranges::equal(a, b, [](const Pillar& p, const Pillar& q) { return p.outline_mm == q.outline_mm; });
}

TEST_CASE("ForestLayout.AGridIsEven") {
  const auto pillars = grid_of_pillars({{10, 20}, 100, 60}, 5, 3, 0, {PillarShape::square, 8, 50, 2});
  REQUIRE(pillars.size() == 15);
  CHECK((outline_centroid(pillars[0].outline_mm) - Vec2(-40, -10)).norm() < 1e-5);
  CHECK((outline_centroid(pillars[14].outline_mm) - Vec2(60, 50)).norm() < 1e-5);
  CHECK_THAT(closest(pillars), WithinAbs(25 - 8, 1e-5));
  CHECK_THROWS_AS(grid_of_pillars({{0, 0}, 100, 60}, 13, 3, 0, {PillarShape::square, 8, 50, 2}), Error);
}

TEST_CASE("ForestLayout.TooManyPillarsAreRefusedAtOnce") {
  CHECK_THROWS_AS(grid_of_pillars({{0, 0}, 1e5, 1e5}, 100, 100, 0, {PillarShape::square, 8, 50, 2}), Error);
  CHECK_THROWS_AS(screens_of_pillars(four_views(), 160, 60, {PillarShape::round, 0.1, 100, 4}, 1), Error);
}

TEST_CASE("ForestLayout.RandomPillarsKeepTheirDistanceAndFollowTheSeed") {
  const PillarKind kind{PillarShape::mixed, 12, 100, 4};
  const FloorArea area{{0, 0}, 240, 240};
  const auto pillars = random_pillars(area, 60, kind, 5);
  REQUIRE(pillars.size() == 60);
  CHECK(closest(pillars) >= 4);
  CHECK(are_equal(pillars, random_pillars(area, 60, kind, 5)));
  CHECK_FALSE(are_equal(pillars, random_pillars(area, 60, kind, 6)));
  CHECK_THROWS_AS(random_pillars({{0, 0}, 40, 40}, 60, kind, 5), Error);
}

TEST_CASE("ForestLayout.ScreensStopAllRaysAndNoOthers") {
  for (const std::uint64_t seed : {1, 2, 3, 4, 5}) {
    const auto views = four_views();
    const auto pillars = screens_of_pillars(views, 160, 60, {PillarShape::mixed, 12, 100, 4}, seed);
    CHECK(closest(pillars) >= 4);
    std::vector<std::vector<WallStrip>> strips;
    for (const PlanView& view : views) strips.push_back(seen_walls(view, pillars, Context()));
    const WallAssignment walls = assign_walls(views, pillars, strips, SharedWalls::refused, 0.3);
    for (std::size_t v = 0; v < 4; ++v) {
      INFO("seed " << seed << ", viewpoint " << v);
      CHECK_THAT(walls.seen_share[v], WithinAbs(1, 1e-12));
      CHECK(walls.used_share[v] > 0.999);
    }
    CHECK(are_equal(pillars, screens_of_pillars(views, 160, 60, {PillarShape::mixed, 12, 100, 4}, seed)));
  }
  CHECK_THROWS_AS(screens_of_pillars(four_views(), 60, 59, {PillarShape::mixed, 12, 100, 4}, 1), Error);
}

}  // namespace
}  // namespace formwright
