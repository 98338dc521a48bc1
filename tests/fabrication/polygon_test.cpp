// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/planar/polygon.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <cmath>
#include <numbers>
#include <random>

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

Polygon regular(int sides, double radius_mm) {
  Polygon polygon;
  for (int i = 0; i < sides; ++i) {
    const double angle = 2 * std::numbers::pi * i / sides;
    polygon.emplace_back(radius_mm * std::cos(angle), radius_mm * std::sin(angle));
  }
  return polygon;
}

Polygon moved(const Polygon& polygon, const std::vector<double>& left_mm) {
  const std::vector<Vec2> steps = offset_steps(polygon, left_mm);
  Polygon result = polygon;
  for (std::size_t i = 0; i < result.size(); ++i) result[i] += steps[i];
  return result;
}

TEST_CASE("Polygon.ARectangleGrowsByEachEdgesOwnDistance") {
  const Polygon rectangle{{0, 0}, {10, 0}, {10, 5}, {0, 5}};
  const Polygon result = moved(rectangle, {1, 2, 0, -3});  // inwards below and right, not above, outwards on the left
  const Polygon expected{{-3, 1}, {8, 1}, {8, 5}, {-3, 5}};
  for (std::size_t i = 0; i < 4; ++i) {
    INFO(i);
    CHECK((result[i] - expected[i]).norm() < 1e-14);
  }
}

TEST_CASE("Polygon.ARegularPolygonKeepsItsShapeAndTheCornerLimitHolds") {
  for (const int sides : {5, 12, 1000}) {
    const double apothem = 20 * std::cos(std::numbers::pi / sides);
    const Polygon result = moved(regular(sides, 20), std::vector<double>(std::size_t(sides), -0.1));
    for (const Vec2& p : result) CHECK_THAT(p.norm(), WithinAbs(20 * (apothem + 0.1) / apothem, 1e-10));
  }
  const Polygon needle{{0, 0}, {100, 0}, {0, 1}};
  for (const Vec2& step : offset_steps(needle, {-1, -1, -1})) CHECK(step.norm() <= 2 + 1e-12);
}

TEST_CASE("Polygon.AStraightStretchAndAnEdgeWithoutLengthMoveLikeTheirNeighbours") {
  const Polygon polygon{{0, 0}, {5, 0}, {5, 0}, {10, 0}, {10, 5}, {0, 5}};
  const std::vector<Vec2> steps = offset_steps(polygon, std::vector<double>(6, 1.0));
  for (const std::size_t i : {1, 2}) CHECK((steps[i] - Vec2(0, 1)).norm() < 1e-14);
}

TEST_CASE("Polygon.OffsetLengthConvergesToThatOfTheParallelCurve") {
  // An ellipse: a closed curve moved inwards by d loses 2 pi d of its length, whatever its shape.
  const auto error = [](int sides) {
    Polygon ellipse;
    for (int i = 0; i < sides; ++i) {
      const double angle = 2 * std::numbers::pi * i / sides;
      ellipse.emplace_back(30 * std::cos(angle), 20 * std::sin(angle));
    }
    const auto length = [](const Polygon& p) {
      double sum = 0;
      for (std::size_t i = 0; i < p.size(); ++i) sum += (p[(i + 1) % p.size()] - p[i]).norm();
      return sum;
    };
    return std::abs(length(ellipse) - length(moved(ellipse, std::vector<double>(std::size_t(sides), 2.0))) -
                    4 * std::numbers::pi);
  };
  const double coarse = error(100), fine = error(200);
  CHECK(fine < 0.01);
  CHECK_THAT(std::log2(coarse / fine), WithinAbs(2, 0.1));
}

TEST_CASE("Polygon.TheHullHoldsEveryPointAndTurnsLeft") {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-10, 10);
  std::vector<Vec2> points;
  for (int i = 0; i < 200; ++i) points.emplace_back(place(random), place(random));
  const Polygon hull = convex_hull(points);
  CHECK(signed_area_mm2(hull) > 300);
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Vec2 along = hull[(i + 1) % hull.size()] - hull[i];
    for (const Vec2& p : points) CHECK(along.x() * (p - hull[i]).y() - along.y() * (p - hull[i]).x() >= -1e-9);
  }
  CHECK(convex_hull({{0, 0}, {1, 1}, {2, 2}, {3, 3}}).size() == 2u);
}

TEST_CASE("Polygon.TrianglesTouchOrOverlap") {
  const std::array<Vec2, 3> a{Vec2(0, 0), Vec2(4, 0), Vec2(0, 4)}, beside{Vec2(4, 0), Vec2(4, 4), Vec2(0, 4)};
  CHECK_FALSE(triangles_overlap(a, beside, 1e-9));
  CHECK(triangles_overlap(a, beside, -0.1));
  const std::array<Vec2, 3> inside{Vec2(1, 1), Vec2(1.5, 1), Vec2(1, 1.5)};
  CHECK(triangles_overlap(a, inside, 1e-9));
  const std::array<Vec2, 3> away{Vec2(2.1, 2.1), Vec2(5, 2.1), Vec2(2.1, 5)};  // boxes meet, triangles do not
  CHECK_FALSE(triangles_overlap(a, away, 1e-9));
}

}  // namespace
}  // namespace formwright
