// SPDX-License-Identifier: GPL-3.0-or-later
// Walls around surfaces: closed forms, distances, convergence in alpha, bad input.
#include "geometry/offset/thick_surface.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>

#include <cmath>
#include <limits>
#include <numbers>

#include "base/error.h"
#include "geometry/mesh/adjacency.h"
#include "geometry/mesh/measures.h"
#include "geometry/queries/point_distance.h"
#include "geometry/test_meshes.h"

namespace formwright {
namespace {
using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::WithinRel;
using namespace test;
constexpr double pi = std::numbers::pi;

ThickSurface thick(const TriangleMesh& mesh, double wall_mm, double opening_mm) {
  Context context;
  return thick_surface(mesh, {.wall_mm = wall_mm, .opening_mm = opening_mm}, context);
}

/// The upper half of a ball's surface, open below.
TriangleMesh dome(double radius_mm, int levels) {
  TriangleMesh mesh = icosphere(levels);
  mesh.V *= radius_mm;
  Eigen::Index kept = 0;
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f)
    if (mesh.V(mesh.F(f, 0), 2) + mesh.V(mesh.F(f, 1), 2) + mesh.V(mesh.F(f, 2), 2) > 0)
      mesh.F.row(kept++) = mesh.F.row(f);
  mesh.F.conservativeResize(kept, 3);
  return mesh;
}

TEST_CASE("ThickSurface.OfATriangleHasTheVolumeOfSteiner") {
  // Area times twice the reach, half a tube of the perimeter, and at the corners a ball between them.
  const TriangleMesh mesh = make_mesh({{0, 0, 0}, {40, 0, 0}, {0, 30, 0}}, {{{0, 1, 2}}});
  const ThickSurface made = thick(mesh, 4, 1);
  const double r = made.reach_mm, volume = 600 * 2 * r + 120 * pi * r * r / 2 + 4 * pi / 3 * r * r * r;
  CHECK(Adjacency(made.mesh).is_closed());
  CHECK_THAT(signed_volume(made.mesh), WithinRel(volume, 0.02));
}

TEST_CASE("ThickSurface.OfADomeConvergesInAlpha") {
  const double radius = 30, wall = 4;
  const TriangleMesh mesh = dome(radius, 5);
  double before = 0;
  for (const double opening : {4.0, 2.0, 1.0}) {
    const ThickSurface made = thick(mesh, wall, opening);
    // Half a spherical shell, and below its edge half a ring.
    const auto volume = [&](double r) {
      return 2 * pi / 3 * (std::pow(radius + r, 3) - std::pow(radius - r, 3)) + pi * pi * r * r * radius;
    };
    CHECK(Adjacency(made.mesh).is_closed());
    // The volume that the wall alone would have is what a finer wrap comes to.
    const double error = std::abs(signed_volume(made.mesh) / volume(wall / 0.99) - 1);
    INFO("opening " << opening << ", reach " << made.reach_mm << ", error " << error);
    if (before > 0) {
      CHECK(std::log2(before / error) > 1);
    }
    before = error;
  }
  CHECK(before < 0.04);
}

TEST_CASE("ThickSurface.HoldsTheWallEverywhere") {
  // Corners of all kinds, a crossing pair and an edge with three faces.
  Random random(7);
  TriangleMesh soup =
      make_mesh({{0, 0, 0}, {30, 0, 0}, {0, 30, 5}, {20, 20, -10}, {10, 5, 20}, {5, 25, -8}, {25, 5, 12}},
                {{{0, 1, 2}}, {{1, 2, 3}}, {{2, 1, 4}}, {{5, 6, 0}}});
  for (const double opening : {0.5, 1.5}) {
    const double wall = 2;
    const ThickSurface made = thick(soup, wall, opening);
    CHECK(Adjacency(made.mesh).is_closed());
    const PointDistance distance(soup);
    double nearest = 1e9, farthest = 0;
    for (Eigen::Index f = 0; f < made.mesh.F.rows(); ++f)
      for (int k = 0; k < 8; ++k) {
        double a = random.uniform(), b = random.uniform();
        if (a + b > 1) a = 1 - a, b = 1 - b;
        const auto corner = [&](int c) { return made.mesh.V.row(made.mesh.F(f, c)); };
        const Vec3 p = ((1 - a - b) * corner(0) + a * corner(1) + b * corner(2)).transpose();
        const double d = distance.nearest(p)->distance;
        nearest = std::min(nearest, d);
        farthest = std::max(farthest, d);
      }
    INFO("opening " << opening << ": from " << nearest << " to " << farthest << ", reach " << made.reach_mm);
    CHECK(nearest >= wall);
    CHECK(farthest <= 1.01 * made.reach_mm + opening);
  }
}

template <class Body>
std::string refusal(Body body) {
  try {
    body();
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::invalid_input);
    return error.what();
  }
  FAIL_CHECK("should have been refused");
  return "";
}

TEST_CASE("ThickSurface.RefusesWhatHasNoWall") {
  const TriangleMesh mesh = cube();
  CHECK_THAT(refusal([&] { thick(mesh, 0, 1); }), ContainsSubstring("above 0 mm"));
  CHECK_THAT(refusal([&] { thick(mesh, NAN, 1); }), ContainsSubstring("above 0 mm"));
  CHECK_THAT(refusal([&] { thick(TriangleMesh{mesh.V, Triangles(0, 3)}, 1, 1); }), ContainsSubstring("no triangle"));
  TriangleMesh flat = mesh, broken = mesh;
  flat.V.rightCols(2).setZero();
  CHECK_THAT(refusal([&] { thick(flat, 1, 1); }), ContainsSubstring("no triangle"));
  broken.V(3, 1) = std::numeric_limits<double>::infinity();
  CHECK_THAT(refusal([&] { thick(broken, 1, 1); }), ContainsSubstring("not finite"));
  Context context;
  CHECK_THAT(refusal([&] { thick_surface(mesh, {.wall_mm = 0.05, .opening_mm = 0.02, .max_vertices = 500}, context); }),
             ContainsSubstring("too fine"));
}

TEST_CASE("ThickSurface.StopsWhenCancelled") {
  int asked = 0;
  Context context(Host{.cancel_requested = [&] { return ++asked > 3; }});
  CHECK_THROWS_AS(thick_surface(icosphere(3), {.wall_mm = 0.1, .opening_mm = 0.05}, context), Error);
}

}  // namespace
}  // namespace formwright
