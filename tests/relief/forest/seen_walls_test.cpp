// SPDX-License-Identifier: GPL-3.0-or-later
// What a viewpoint sees of pillars, against closed forms.
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include "base/random.h"
#include "relief/forest/forest_fixture.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;
using test::round_pillar;
using test::square_pillar;
using test::straight_view;

std::vector<WallStrip> seen(const PlanView& view, const std::vector<Pillar>& pillars) {
  return seen_walls(view, pillars, Context());
}

TEST_CASE("SeenWalls.ASquareStraightAheadShowsItsFront") {
  const std::vector<Pillar> pillars{square_pillar(0, 100, 10)};
  const auto strips = seen(straight_view(-1, 1), pillars);
  REQUIRE(strips.size() == 1);
  CHECK_THAT(strips[0].from, WithinAbs(-5.0 / 95, 1e-7));
  CHECK_THAT(strips[0].to, WithinAbs(5.0 / 95, 1e-7));
  CHECK_THAT(straight_view(-1, 1).meets_line(0.01, corner(pillars[0].outline_mm, strips[0].edge),
                                             corner(pillars[0].outline_mm, strips[0].edge + 1)),
             WithinAbs(95, 1e-5));
}

TEST_CASE("SeenWalls.ASquareAsideShowsTwoSides") {
  // From the left: first the side at x = 25, then the front, seen between its corners.
  const auto strips = seen(straight_view(-1, 1), {square_pillar(30, 100, 10)});
  REQUIRE(strips.size() == 2);
  CHECK_THAT(strips[0].from, WithinAbs(25.0 / 105, 1e-7));
  CHECK_THAT(strips[0].to, WithinAbs(25.0 / 95, 1e-7));
  CHECK(strips[1].from == strips[0].to);
  CHECK_THAT(strips[1].to, WithinAbs(35.0 / 95, 1e-7));
}

TEST_CASE("SeenWalls.ANearPillarHidesAFarOne") {
  // The far front reaches from -20 / 190 to 20 / 190; the near one hides what lies between its corners.
  const auto strips = seen(straight_view(-1, 1), {square_pillar(0, 210, 40), square_pillar(4, 100, 10)});
  REQUIRE(strips.size() == 3);
  CHECK(strips[0].pillar == 0);
  CHECK(strips[1].pillar == 1);
  CHECK(strips[2].pillar == 0);
  const double far = 20.0 / 190, left = -1.0 / 95, right = 9.0 / 95;
  CHECK_THAT(strips[0].from, WithinAbs(-far, 1e-7));
  CHECK_THAT(strips[0].to, WithinAbs(left, 1e-7));
  CHECK_THAT(strips[1].to, WithinAbs(right, 1e-7));
  CHECK_THAT(strips[2].to, WithinAbs(far, 1e-7));
}

TEST_CASE("SeenWalls.NothingIsSeenBehindTheEyeOrBesideThePicture") {
  CHECK(seen(straight_view(-1, 1), {square_pillar(0, -100, 10)}).empty());
  CHECK(seen(straight_view(-0.1, 0.1), {square_pillar(50, 100, 10)}).empty());
  // Of one that the eye stands beside, the part ahead.
  const auto strips = seen(straight_view(-100, 100), {square_pillar(20, 0, 10)});
  REQUIRE_FALSE(strips.empty());
  CHECK_THAT(strips.front().from, WithinAbs(15.0 / 5, 1e-6));
}

TEST_CASE("SeenWalls.RoundPillarsConvergeWithSecondOrder") {
  // The ray that touches a circle of radius 10 at a distance of 20 has the tangent 1 / sqrt(3), and touches it at 60
  // degrees, half-way between two corners.
  const double exact = 1 / std::numbers::sqrt3;
  double before = 0;
  for (const int corners : {24, 48, 96, 192}) {
    const auto strips = seen(straight_view(-2, 2), {round_pillar(0, 20, 10, corners)});
    const double error = std::abs(strips.back().to - exact);
    CHECK_THAT(strips.front().from, WithinAbs(-strips.back().to, 1e-12));
    if (before > 0) CHECK_THAT(std::log2(before / error), WithinAbs(2, 0.1));
    before = error;
  }
}

TEST_CASE("SeenWalls.EveryRayMeetsWhatIsFirstOnIt") {
  Random random(7);
  std::vector<Pillar> pillars;
  for (int k = 0; k < 30; ++k) {
    const double x = random.uniform(-100, 100), y = random.uniform(60, 260);
    Pillar next = k % 2 ? square_pillar(x, y, 12, 100, random.uniform(0, 90)) : round_pillar(x, y, 6, 20);
    bool apart = true;
    for (const Pillar& other : pillars) apart = apart && distance_between(next.outline_mm, other.outline_mm) > 1;
    if (apart) pillars.push_back(next);
  }
  REQUIRE(pillars.size() > 15);
  const PlanView view = straight_view(-0.8, 0.8);
  const auto strips = seen(view, pillars);
  for (std::size_t k = 0; k + 1 < strips.size(); ++k) CHECK(strips[k].to <= strips[k + 1].from);
  int met = 0;
  for (int ray = 0; ray < 4000; ++ray) {
    const double t = random.uniform(view.from, view.to);
    double nearest = INFINITY;
    int pillar = -1;
    for (std::size_t p = 0; p < pillars.size(); ++p)
      for (int k = 0; k < static_cast<int>(pillars[p].outline_mm.size()); ++k) {
        const Vec2 &a = corner(pillars[p].outline_mm, k), &b = corner(pillars[p].outline_mm, k + 1);
        const double ahead = view.meets_line(t, a, b),
                     place = (view.at(t, ahead) - a).dot(b - a) / (b - a).squaredNorm();
        if (ahead > 0 && ahead < nearest && place >= 0 && place <= 1) {
          nearest = ahead;
          pillar = static_cast<int>(p);
        }
      }
    int found = -1;
    for (const WallStrip& s : strips)
      if (s.from <= t && t <= s.to) found = s.pillar;
    CHECK(found == pillar);
    met += pillar >= 0;
  }
  CHECK(met > 1000);
}

}  // namespace
}  // namespace formwright
