// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/height_map.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <cmath>

#include "geometry/mesh/adjacency.h"
#include "geometry/mesh/measures.h"
#include "geometry/test_meshes.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

HeightMap bumps(int columns, int rows, double pitch) {
  HeightMap map;
  map.columns = columns;
  map.rows = rows;
  map.pitch_x_mm = map.pitch_y_mm = pitch;
  map.height_mm.assign(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), 0);
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x) {
      const double r = std::hypot(x - 0.5 * columns, y - 0.4 * rows) / rows;
      map.at(y, x) = r < 0.35 ? static_cast<float>(4 * (1 - r) + 0.3 * std::sin(0.7 * x) * std::cos(0.3 * y)) : 0;
    }
  return map;
}

/// Height of the solid's top at a node, by the triangle that covers it.
class TopSurface {
 public:
  TopSurface(const TriangleMesh& solid, const HeightMap& map, double plate) : height_(map.height_mm.size(), -1) {
    for (Eigen::Index f = 0; f < solid.F.rows(); ++f) {
      Eigen::Matrix3d T;
      for (int k = 0; k < 3; ++k) T.row(k) = solid.V.row(solid.F(f, k));
      if (T.col(2).minCoeff() < plate - 1e-9) continue;
      const double ax = T(0, 0) / map.pitch_x_mm, ay = T(0, 1) / map.pitch_y_mm, bx = T(1, 0) / map.pitch_x_mm,
                   by = T(1, 1) / map.pitch_y_mm, cx = T(2, 0) / map.pitch_x_mm, cy = T(2, 1) / map.pitch_y_mm;
      const double doubled = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
      {
        INFO("a top triangle is turned over");
        CHECK(doubled > 0);
      }
      for (int y = static_cast<int>(std::floor(std::min({ay, by, cy}))); y <= std::ceil(std::max({ay, by, cy})); ++y)
        for (int x = static_cast<int>(std::floor(std::min({ax, bx, cx}))); x <= std::ceil(std::max({ax, bx, cx}));
             ++x) {
          const double wb = ((x - ax) * (cy - ay) - (y - ay) * (cx - ax)) / doubled,
                       wc = ((bx - ax) * (y - ay) - (by - ay) * (x - ax)) / doubled;
          if (wb < -1e-9 || wc < -1e-9 || wb + wc > 1 + 1e-9) continue;
          height_[static_cast<std::size_t>(y) * static_cast<std::size_t>(map.columns) + static_cast<std::size_t>(x)] =
              T(0, 2) + wb * (T(1, 2) - T(0, 2)) + wc * (T(2, 2) - T(0, 2)) - plate;
        }
    }
  }
  double at(std::size_t node) const { return height_[node]; }

 private:
  std::vector<double> height_;
};

TEST_CASE("Solid.IsClosedAndWithinToleranceForEverySize") {
  Context context;
  for (const auto& [columns, rows] : {std::pair{2, 2}, {3, 2}, {2, 5}, {17, 9}, {64, 65}, {100, 37}})
    for (const double tolerance : {0.0, 0.02, 0.5}) {
      const HeightMap map = bumps(columns, rows, 0.25);
      const TriangleMesh solid = make_solid(map, 3, tolerance, context);
      {
        INFO(columns << "x" << rows);
        CHECK(Adjacency(solid).is_closed());
      }
      CHECK(euler_characteristic(Adjacency(solid)) == 2);
      const TopSurface top(solid, map, 3);
      for (std::size_t node = 0; node < map.height_mm.size(); ++node) {
        INFO(node);
        CHECK_THAT(top.at(node), WithinAbs(map.height_mm[node], tolerance + 1e-5));
      }
      CHECK_THAT(solid.V.col(0).maxCoeff(), WithinAbs(map.width_mm(), 1e-12));
      CHECK_THAT(solid.V.col(1).maxCoeff(), WithinAbs(map.depth_mm(), 1e-12));
      CHECK(solid.V.minCoeff() == 0);
    }
}

TEST_CASE("Solid.OfALongFriezeTakesNoMoreThanItsOwnNodes") {
  // The square around it would have four thousand million.
  Context context;
  const HeightMap map = bumps(60'001, 5, 0.25);
  const TriangleMesh solid = make_solid(map, 3, 0.02, context);
  CHECK(Adjacency(solid).is_closed());
  const TopSurface top(solid, map, 3);
  double worst = 0;
  for (std::size_t node = 0; node < map.height_mm.size(); ++node)
    worst = std::max(worst, std::abs(top.at(node) - static_cast<double>(map.height_mm[node])));
  CHECK(worst < 0.02 + 1e-5);
}

TEST_CASE("Solid.OfABarePlateIsABoxOfFewTriangles") {
  Context context;
  HeightMap map = bumps(129, 65, 0.5);
  std::fill(map.height_mm.begin(), map.height_mm.end(), 0.0f);
  const TriangleMesh solid = make_solid(map, 2, 0.001, context);
  CHECK_THAT(signed_volume(solid), WithinAbs(64 * 32 * 2, 1e-9));
  CHECK(solid.face_count() < 600);  // against 16384 for the full grid
}

TEST_CASE("HeightMap.IsTheUpperEnvelopeOverThePlate") {
  // Two squares over the plate at different heights, and one behind it.
  Positions P(12, 3);
  Triangles F(6, 3);
  const double z[3] = {-0.02, -0.05, 0.03}, x0[3] = {-0.4, -0.1, -0.5}, x1[3] = {0.1, 0.3, 0.5};
  for (int k = 0; k < 3; ++k) {
    P.row(4 * k) << x0[k], -0.2, z[k];
    P.row(4 * k + 1) << x1[k], -0.2, z[k];
    P.row(4 * k + 2) << x1[k], 0.2, z[k];
    P.row(4 * k + 3) << x0[k], 0.2, z[k];
    F.row(2 * k) << 4 * k, 4 * k + 1, 4 * k + 2;
    F.row(2 * k + 1) << 4 * k, 4 * k + 2, 4 * k + 3;
  }
  Context context;
  const HeightMap map = make_height_map(P, F, 100, {100, 40}, 0.5, 6, context);
  CHECK(map.columns == 201);
  CHECK(map.rows == 81);
  CHECK_THAT(map.width_mm(), WithinAbs(100, 1e-12));
  CHECK_THAT(map.at(40, 40), WithinAbs(2, 1e-6));   // x = -30 mm: the lower square
  CHECK_THAT(map.at(40, 100), WithinAbs(5, 1e-6));  // x = 0: the higher one covers it
  CHECK_THAT(map.at(40, 150), WithinAbs(5, 1e-6));
  CHECK(map.at(40, 190) == 0);  // bare plate; what is behind it does not show
}

TEST_CASE("HeightMap.ReachesTheAskedThicknessBetweenNodes") {
  Positions P(3, 3);
  P << -0.5, -0.1, 0, 0.5, -0.1, 0, 0.0123, 0.077, -0.05;  // the top lies between nodes
  Triangles F(1, 3);
  F << 0, 1, 2;
  Context context;
  const HeightMap map = make_height_map(P, F, 100, {100, 20}, 1.0, 5, context);
  CHECK(*std::max_element(map.height_mm.begin(), map.height_mm.end()) == 5.0f);
}

TEST_CASE("HeightMap.RefusesAGridThatWouldNotFit") {
  Context context;
  CHECK_THROWS_AS(make_height_map(Positions::Zero(3, 3), Triangles::Zero(0, 3), 100, {10000, 10000}, 0.01, 5, context),
                  Error);
}

}  // namespace
}  // namespace formwright
