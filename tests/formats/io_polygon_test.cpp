// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>
#include <set>

#include "formats/shared/polygon_triangulation.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

Vec3 area_vector(const Vec3& a, const Vec3& b, const Vec3& c) { return (b - a).cross(c - a) / 2; }

Vec3 polygon_area_vector(const std::vector<Vec3>& p) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 1; i + 1 < p.size(); ++i) sum += area_vector(p[0], p[i], p[i + 1]);
  return sum;
}

/// A triangulation is right if no triangle is turned over and the areas add up: then nothing overlaps or sticks out.
void expect_triangulates(const std::vector<Vec3>& corners, const std::string& what) {
  PolygonTriangulator triangulator;
  const auto triangles = triangulator.triangulate(corners);
  {
    INFO(what);
    REQUIRE(triangles.size() == corners.size() - 2);
  }
  const Vec3 whole = polygon_area_vector(corners), normal = whole.normalized();
  double sum = 0;
  std::set<int> used;
  for (const auto& t : triangles) {
    const double area = area_vector(corners[static_cast<std::size_t>(t[0])], corners[static_cast<std::size_t>(t[1])],
                                    corners[static_cast<std::size_t>(t[2])])
                            .dot(normal);
    {
      INFO(what);
      CHECK(area >= -1e-12 * whole.norm());
    }
    sum += std::abs(area);
    used.insert(t.begin(), t.end());
  }
  INFO(what);
  CHECK_THAT(sum, WithinAbs(whole.norm(), 1e-9 * whole.norm()));
  CHECK(used.size() == corners.size());
}

std::vector<Vec3> on_plane(const std::vector<Vec2>& flat, int seed) {
  std::mt19937 random(static_cast<unsigned>(seed));
  std::normal_distribution<double> normal;
  const Eigen::Quaterniond turn =
      Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random)).normalized();
  std::vector<Vec3> points;
  for (const Vec2& p : flat) points.push_back(turn * Vec3(p.x(), p.y(), 0) + Vec3(100, -20, 3));
  return points;
}

TEST_CASE("PolygonTriangulation.ArrowheadWhoseFanWouldTurnOver") {
  // Concave at corner 2 (or, started elsewhere, at any other): a fan from corner 0 overlaps itself for two of four
  // starts.
  const std::vector<Vec2> arrow{{0, 0}, {4, -3}, {1, 0}, {4, 3}};
  for (std::size_t start = 0; start < 4; ++start) {
    std::vector<Vec2> turned;
    for (std::size_t i = 0; i < 4; ++i) turned.push_back(arrow[(start + i) % 4]);
    expect_triangulates(on_plane(turned, 1), "start " + std::to_string(start));
  }
}

TEST_CASE("PolygonTriangulation.QuadrangleTakesTheShorterDiagonal") {
  PolygonTriangulator triangulator;
  const std::vector<Vec3> kite{{0, 0, 0}, {5, -1, 0}, {10, 0, 0}, {5, 1, 0}};
  const auto triangles = triangulator.triangulate(kite);
  for (const auto& t : triangles) CHECK((std::ranges::count(t, 1) == 1 && std::ranges::count(t, 3) == 1));
}

TEST_CASE("PolygonTriangulation.StarsCombsAndSpirals") {
  for (const int spikes : {5, 17, 400}) {
    std::vector<Vec2> star;
    for (int i = 0; i < 2 * spikes; ++i) {
      const double angle = std::numbers::pi * i / spikes, radius = i % 2 ? 1.0 : 5.0;
      star.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
    }
    expect_triangulates(on_plane(star, spikes), "star " + std::to_string(spikes));
  }
  std::vector<Vec2> comb{{0, -1}, {200, -1}};
  for (int i = 100; i-- > 0;)
    comb.insert(comb.end(), {{2.0 * i + 1.5, 10.0}, {2.0 * i + 1.0, 0.0}, {2.0 * i + 0.5, 10.0}});
  expect_triangulates(on_plane(comb, 3), "comb");
  std::vector<Vec2> spiral;
  for (int i = 0; i <= 600; ++i)
    spiral.emplace_back((1 + 0.01 * i) * std::cos(0.05 * i), (1 + 0.01 * i) * std::sin(0.05 * i));
  for (int i = 600; i >= 0; --i)
    spiral.emplace_back((0.5 + 0.01 * i) * std::cos(0.05 * i), (0.5 + 0.01 * i) * std::sin(0.05 * i));
  expect_triangulates(on_plane(spiral, 4), "spiral");
}

TEST_CASE("PolygonTriangulation.CornersOnStraightEdgesGiveNoDegenerateTriangles") {
  const std::vector<Vec3> square{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0},
                                 {2, 2, 0}, {1, 2, 0}, {0, 2, 0}, {0, 1, 0}};
  PolygonTriangulator triangulator;
  for (const auto& t : triangulator.triangulate(square))
    CHECK(area_vector(square[static_cast<std::size_t>(t[0])], square[static_cast<std::size_t>(t[1])],
                      square[static_cast<std::size_t>(t[2])])
              .z() > 0.1);
  expect_triangulates(square, "square with midpoints");
}

TEST_CASE("PolygonTriangulation.KeyholeAroundAHole") {
  // A square with a square hole, joined by two coincident edges, as CAD programs write it.
  const std::vector<Vec2> keyhole{{0, 0}, {9, 0}, {9, 9}, {0, 9}, {0, 0}, {3, 3}, {3, 6}, {6, 6}, {6, 3}, {3, 3}};
  expect_triangulates(on_plane(keyhole, 5), "keyhole");
}

TEST_CASE("PolygonTriangulation.RandomSimplePolygons") {
  // Radii at increasing angles make a star-shaped, hence simple, polygon with many reflex corners.
  for (int seed = 0; seed < 300; ++seed) {
    std::mt19937 random(static_cast<unsigned>(seed));
    std::uniform_real_distribution<double> radius(0.05, 1);
    const int n = 5 + seed % 60;
    std::vector<Vec2> flat;
    for (int i = 0; i < n; ++i) {
      const double r = radius(random), angle = 2 * std::numbers::pi * i / n;
      flat.emplace_back(r * std::cos(angle), r * std::sin(angle));
    }
    expect_triangulates(on_plane(flat, seed), "seed " + std::to_string(seed));
  }
}

TEST_CASE("PolygonTriangulation.SlightlyBentPolygonsKeepTheirSide") {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> off(-0.02, 0.02);
  std::vector<Vec3> bent;
  for (int i = 0; i < 12; ++i)
    bent.emplace_back(std::cos(i * std::numbers::pi / 6), std::sin(i * std::numbers::pi / 6), off(random));
  PolygonTriangulator triangulator;
  for (const auto& t : triangulator.triangulate(bent))
    CHECK(area_vector(bent[static_cast<std::size_t>(t[0])], bent[static_cast<std::size_t>(t[1])],
                      bent[static_cast<std::size_t>(t[2])])
              .z() > 0);
}

TEST_CASE("PolygonTriangulation.HopelessPolygonsStillEnd") {
  PolygonTriangulator triangulator;
  std::mt19937 random(11);
  std::uniform_real_distribution<double> any(-1, 1);
  std::vector<Vec3> crossing, line(1000), point(500, Vec3(1, 2, 3));
  for (int i = 0; i < 3000; ++i) crossing.emplace_back(any(random), any(random), any(random));
  for (std::size_t i = 0; i < line.size(); ++i) line[i] = Vec3(static_cast<double>(i % 37), 0, 0);
  for (const auto& corners : {crossing, line, point}) {
    const auto triangles = triangulator.triangulate(corners);
    CHECK(triangles.size() == corners.size() - 2);
    for (const auto& t : triangles)
      for (const int corner : t) CHECK((corner >= 0 && corner < static_cast<int>(corners.size())));
  }
}

}  // namespace
}  // namespace formwright
