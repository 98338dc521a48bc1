// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/planar/delaunay.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <algorithm>
#include <random>
#include <set>

#include "geometry/planar/plane.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;

double area_of(const PlaneTriangles& net) {
  double sum = 0;
  for (const Eigen::Vector3i& t : net.triangles) {
    const auto at = [&](int k) { return net.points[static_cast<std::size_t>(t[k])]; };
    const double twice = cross(Vec2(at(1) - at(0)), Vec2(at(2) - at(0)));
    CHECK(twice > 0);
    sum += 0.5 * twice;
  }
  return sum;
}

bool has_edge(const PlaneTriangles& net, int a, int b) {
  return std::ranges::any_of(
      net.triangles, [&](const Eigen::Vector3i& t) { return (t.array() == a).any() && (t.array() == b).any(); });
}

TEST_CASE("Delaunay.CoversTheHullWithTheGivenEdges") {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(0.1, 0.9);
  std::vector<Vec2> points{{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  for (int k = 0; k < 500; ++k) points.emplace_back(place(random), place(random));
  const PlaneTriangles net = constrained_delaunay(points, {{0, 2}});
  CHECK_THAT(area_of(net), WithinRel(1, 1e-12));
  CHECK(net.points.size() == points.size());
  CHECK(has_edge(net, 0, 2));
  CHECK(net.triangles.size() == 2 * points.size() - 2 - 4);  // Euler's formula, with four points on the hull
}

TEST_CASE("Delaunay.EdgesThatCrossMeetInANewPoint") {
  const PlaneTriangles net = constrained_delaunay({{0, 0}, {2, 0}, {2, 2}, {0, 2}}, {{0, 2}, {1, 3}});
  REQUIRE(net.points.size() == 5);
  CHECK((net.points[4] - Vec2(1, 1)).norm() < 1e-15);
  CHECK(net.triangles.size() == 4);
}

TEST_CASE("Delaunay.PointsAtOnePlaceAreOne") {
  const PlaneTriangles net = constrained_delaunay({{0, 0}, {1, 0}, {0, 1}, {1, 0}}, {{3, 2}});
  REQUIRE(net.triangles.size() == 1);
  CHECK(net.triangles[0].maxCoeff() == 2);
}

TEST_CASE("Delaunay.PointsOnALineHaveNoTriangles") {
  CHECK(constrained_delaunay({{0, 0}, {1, 1}, {2, 2}, {3, 3}}, {{0, 2}, {1, 3}}).triangles.empty());
  CHECK(constrained_delaunay({}, {}).triangles.empty());
}

TEST_CASE("Delaunay.TrianglesOfARegionLeaveItsHolesOut") {
  const Region region =
      without(surrounded_by({{{0, 0}, {4, 0}, {4, 4}, {0, 4}}}), surrounded_by({{{1, 1}, {3, 1}, {3, 3}, {1, 3}}}));
  std::vector<Vec2> inner;
  for (int x = 0; x < 16; ++x)
    for (int y = 0; y < 16; ++y) inner.emplace_back(0.125 + 0.25 * x, 0.125 + 0.25 * y);
  const PlaneTriangles net = triangles_of(region, 0.25, inner);
  CHECK_THAT(area_of(net), WithinRel(12, 1e-12));
  // The rings come first, in pieces.
  const auto ring = static_cast<std::size_t>((4 * 4 + 4 * 2) / 0.25);
  CHECK(net.points.size() == ring + inner.size());
  for (std::size_t k = 0; k < ring; ++k) {
    const Vec2 p = net.points[k];
    CHECK(std::min({std::abs(p.x()), std::abs(p.y()), std::abs(p.x() - 4), std::abs(p.y() - 4), std::abs(p.x() - 1),
                    std::abs(p.y() - 1), std::abs(p.x() - 3), std::abs(p.y() - 3)}) < 1e-12);
  }
}

}  // namespace
}  // namespace formwright
