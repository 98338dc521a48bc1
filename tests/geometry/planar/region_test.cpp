// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/planar/region.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <numbers>
#include <random>

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;

std::vector<Vec2> rectangle(double x0, double y0, double x1, double y1) {
  return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
}

std::vector<Vec2> circle(const Vec2& middle, double radius, int corners) {
  std::vector<Vec2> ring;
  for (int k = 0; k < corners; ++k) {
    const double turn = 2 * std::numbers::pi * k / corners;
    ring.emplace_back(middle + radius * Vec2(std::cos(turn), std::sin(turn)));
  }
  return ring;
}

TEST_CASE("Region.AreasOfRectanglesAreExact") {
  const Region big = surrounded_by({rectangle(0, 0, 4, 3)}), small = surrounded_by({rectangle(1, 1, 2, 2)}),
               beside = surrounded_by({rectangle(3, 2, 6, 5)});
  CHECK(big.area() == 12);
  CHECK(without(big, small).area() == 11);
  CHECK(without(big, small).rings.size() == 2);
  CHECK(united(big, beside).area() == 20);
  CHECK(common(big, beside).area() == 1);
  CHECK(without(small, big).empty());
  CHECK(grown(small, 0.5).area() == 4);
  CHECK(grown(small, -0.25).area() == 0.25);
  CHECK(grown(small, -0.5).empty());
  const auto [low, high] = without(big, small).box();
  CHECK(low == Vec2(0, 0));
  CHECK(high == Vec2(4, 3));
}

TEST_CASE("Region.LinesThatGoAroundClockwiseSurroundNothing") {
  std::vector<Vec2> turned = rectangle(0, 0, 1, 1);
  std::ranges::reverse(turned);
  CHECK(surrounded_by({turned}).empty());
  CHECK(surrounded_by({rectangle(0, 0, 2, 2), rectangle(1, 0, 3, 2)}).area() == 6);
  CHECK(surrounded_by({rectangle(0, 0, 2, 2), turned}).area() == 3);
}

TEST_CASE("Region.PointsAndLinesAgreeWithTheAnswerForCircles") {
  const Region ring =
      without(surrounded_by({circle({0.2, -0.1}, 1, 400)}), surrounded_by({circle({0.2, -0.1}, 0.5, 400)}));
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-1.5, 1.5);
  for (int k = 0; k < 2000; ++k) {
    const Vec2 p(place(random), place(random));
    const double distance = (p - Vec2(0.2, -0.1)).norm();
    if (std::abs(distance - 1) < 1e-3 || std::abs(distance - 0.5) < 1e-3) continue;
    const bool inside = distance < 1 && distance > 0.5;
    CHECK(ring.contains(p) == inside);
    const std::vector<double> crossings = ring.crossings(p.y());
    CHECK(((std::ranges::upper_bound(crossings, p.x()) - crossings.begin()) % 2 == 1) == inside);
  }
  // A polygon's area converges to the circle's with order 2.
  double before = 0;
  for (const int corners : {50, 100, 200}) {
    const double error = std::numbers::pi - surrounded_by({circle({0, 0}, 1, corners)}).area();
    if (before > 0) CHECK_THAT(before / error, WithinAbs(4, 0.05));
    before = error;
  }
}

}  // namespace
}  // namespace formwright
