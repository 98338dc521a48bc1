// SPDX-License-Identifier: GPL-3.0-or-later
// Space for reliefs before and behind pillars' surfaces, against closed forms.
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include "base/random.h"
#include "relief/forest/forest_fixture.h"
#include "relief/forest/plan/relief_space.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;
using test::round_pillar;
using test::square_pillar;
using test::straight_view;

int edge_at(const PlanView& view, const Pillar& pillar, double t) {
  const std::vector<Pillar> pillars{pillar};
  for (const WallStrip& s : seen_walls(view, pillars, Context()))
    if (s.from <= t && t <= s.to) return s.edge;
  FAIL("the ray misses");
  return -1;
}

TEST_CASE("WallReach.OnAFlatSide") {
  const PlanView view = straight_view(-1, 1);
  const Pillar pillar = square_pillar(0, 100, 20);
  for (const double t : {0.0, 0.02, -0.05}) {
    const WallReach reach = wall_reach(view, pillar, edge_at(view, pillar, t), t, 2, 3);
    CHECK_THAT(reach.surface, WithinAbs(90, 1e-5));
    CHECK_THAT(reach.near, WithinAbs(88, 1e-5));
    CHECK_THAT(reach.far, WithinAbs(93, 1e-5));
    CHECK_THAT(reach.exit, WithinAbs(110, 1e-5));
  }
}

TEST_CASE("WallReach.BesideACornerIsRound") {
  // Past the left corner at (-10, 90) the space before the side is a disc of radius 2 about it: of the side at x = -10,
  // met by a ray from far left, the ray leaves the space where it leaves that disc or the strip before the front.
  PlanView view = straight_view(-10, 10);
  view.eye = Vec2(-100, 0);
  const Pillar pillar = square_pillar(0, 100, 20);
  const double t = (-10 + 100) / 91.0;  // to (-10, 91)
  const WallReach reach = wall_reach(view, pillar, edge_at(view, pillar, t), t, 2, 1);
  CHECK_THAT(reach.surface, WithinAbs(91, 1e-5));
  const Vec2 near = view.at(t, reach.near);
  CHECK_THAT(distance_to_outline(pillar.outline_mm, near), WithinAbs(2, 1e-5));
  CHECK(reach.near < reach.surface);
}

TEST_CASE("WallReach.OnRoundPillarsConvergesWithSecondOrder") {
  // Circles of radius 10, 10 + 2 and 10 - 1 about (0, 40).
  double coarse[3] = {0, 0, 0}, fine[3] = {0, 0, 0};
  for (const int corners : {24, 48, 96, 192}) {
    const PlanView view = straight_view(-2, 2);
    const Pillar pillar = round_pillar(0, 40, 10, corners);
    // The mean over rays side by side, because a single ray's error depends on where its edge is met.
    double error[3] = {0, 0, 0};
    constexpr int rays = 400;
    for (int k = 0; k < rays; ++k) {
      const double aside = 14 * (k + 0.5) / rays - 7, tangent = aside / std::sqrt(1600 - aside * aside),
                   squared = 1 + tangent * tangent;
      const auto exact = [&](double radius) {
        return 40 / squared - std::sqrt((radius * radius - aside * aside) / squared);
      };
      const WallReach reach = wall_reach(view, pillar, edge_at(view, pillar, tangent), tangent, 2, 1);
      error[0] += std::abs(reach.surface - exact(10)) / rays;
      error[1] += std::abs(reach.near - exact(12)) / rays;
      error[2] += std::abs(reach.far - exact(9)) / rays;
    }
    for (int k = 0; k < 3; ++k) {
      if (corners == 24) coarse[k] = error[k];
      fine[k] = error[k];
    }
  }
  for (int k = 0; k < 3; ++k) CHECK_THAT(std::log2(coarse[k] / fine[k]) / 3, WithinAbs(2, 0.1));
}

TEST_CASE("WallReach.CarvingNeverCutsThrough") {
  const PlanView view = straight_view(-1, 1);
  const Pillar pillar = square_pillar(0, 100, 10, 100, 45);
  Random random(3);
  for (int k = 0; k < 500; ++k) {
    const double t = random.uniform(-0.06, 0.06);
    const WallReach reach = wall_reach(view, pillar, edge_at(view, pillar, t), t, 1, 50);
    CHECK(reach.near < reach.surface);
    CHECK(reach.far >= reach.surface);
    CHECK(reach.far <= reach.surface + 0.4 * (reach.exit - reach.surface) + 1e-9);
  }
}

TEST_CASE("WallReach.EveryPlaceInItIsNearTheOutline") {
  const PlanView view = straight_view(-1, 1);
  const Pillar pillar{{{-10, 100}, {0, 90}, {12, 95}, {4, 104}, {10, 115}, {-6, 112}}, 100};
  Random random(5);
  for (const WallStrip& s : seen_walls(view, std::vector<Pillar>{pillar}, Context()))
    for (int k = 0; k < 200; ++k) {
      const double t = random.uniform(s.from, s.to);
      const WallReach reach = wall_reach(view, pillar, s.edge, t, 1.5, 1);
      for (int step = 0; step <= 20; ++step) {
        const double share = step / 20.0;
        const Vec2 outside = view.at(t, reach.near + share * (reach.surface - reach.near)),
                   inside = view.at(t, reach.surface + share * (reach.far - reach.surface));
        CHECK(distance_to_outline(pillar.outline_mm, outside) <= 1.5 + 1e-9);
        CHECK(distance_to_outline(pillar.outline_mm, inside) <= 1 + 1e-9);
      }
    }
}

TEST_CASE("ReliefSpace.KeepsOutOfSightOfOthers") {
  // The second viewpoint looks along +x past the front of the pillar at y = 90: places before y = 90 at x > -10 are in
  // its sight only where its rays, from y = 80 and rising, have not met the pillar.
  PlanView first = straight_view(-0.2, 0.2), second;
  second.eye = Vec2(-200, 89);
  second.forward = Vec2(1, 0);
  second.from = -0.02;
  second.to = 0.02;
  const std::vector<Pillar> pillars{square_pillar(0, 100, 20)};
  const std::vector<PlanView> views{first, second};
  std::vector<std::vector<WallStrip>> strips;
  for (const PlanView& view : views) strips.push_back(seen_walls(view, pillars, Context()));
  const SeenPlan plan{pillars, views, strips};
  const ReliefSpace free(plan, 0, {5, 0}, false), hidden(plan, 0, {5, 0}, true);
  const int edge = strips[0].front().edge;
  // Straight ahead, at x = 0: all between the ray of tangent 0.02 to the right (y = 85) and the surface is in sight.
  CHECK_THAT(free.reach(0, edge, 0).near, WithinAbs(85, 1e-5));
  CHECK_THAT(hidden.reach(0, edge, 0).near, WithinAbs(90, 1e-5));
  CHECK(is_in_sight(plan, 1, {0, 89}));
  CHECK_FALSE(is_in_sight(plan, 1, {0, 84}));
  CHECK_FALSE(is_in_sight(plan, 1, {0, 91}));
  // Against what many places along the ray say.
  Random random(11);
  for (int k = 0; k < 300; ++k) {
    PlanView other;
    const double angle = random.uniform(0, 2 * std::numbers::pi);
    other.eye = Vec2(0, 100) + 150 * Vec2(std::cos(angle), std::sin(angle));
    other.forward = (Vec2(random.uniform(-15, 15), random.uniform(85, 115)) - other.eye).normalized();
    other.from = -random.uniform(0.001, 0.1);
    other.to = random.uniform(0.001, 0.1);
    const std::vector<PlanView> both{first, other};
    const std::vector<std::vector<WallStrip>> seen{strips[0], seen_walls(other, pillars, Context())};
    const SeenPlan with{pillars, both, seen};
    const double t = random.uniform(-0.1, 0.1), last = last_in_sight(with, 1, first.eye, first.direction(t), 80, 89.9);
    double sampled = 80;
    for (int step = 0; step < 1000; ++step) {
      const double b = 80 + 9.9 * (step + 0.5) / 1000;
      if (is_in_sight(with, 1, first.at(t, b))) sampled = b;
    }
    CHECK_THAT(last, WithinAbs(sampled, 9.9 / 1000 + (sampled == 80 ? 0.02 : 0)));
  }
}

}  // namespace
}  // namespace formwright
