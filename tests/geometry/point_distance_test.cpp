// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/queries/point_distance.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include "base/error.h"
#include "geometry/mesh/measures.h"
#include "geometry/test_meshes.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;
using namespace test;

TEST_CASE("PointDistance.ExactAroundTheCube") {
  const PointDistance cube_distance(cube());
  const auto at = [&](double x, double y, double z) { return *cube_distance.nearest(Vec3(x, y, z)); };
  CHECK(at(0.3, 0.4, 3).distance == 2);
  CHECK(at(0.3, 0.4, 3).point == Vec3(0.3, 0.4, 1));
  CHECK_THAT(at(2, 2, 0.5).distance, WithinAbs(std::sqrt(2.0), 1e-15));  // an edge
  CHECK_THAT(at(2, 2, 2).distance, WithinAbs(std::sqrt(3.0), 1e-15));    // a corner
  CHECK_THAT(at(0.5, 0.5, 0.6).distance, WithinAbs(0.4, 1e-15));         // from inside
  CHECK(at(0.25, 0.75, 0).distance == 0);
  CHECK_FALSE(cube_distance.nearest(Vec3(0.3, 0.4, 3), 1.99));
  CHECK(cube_distance.nearest(Vec3(0.3, 0.4, 3), 2));
}

TEST_CASE("PointDistance.EveryRegionOfATriangle") {
  // Against dense sampling of the triangle, in the plane and off it.
  Random random(2);
  for (int trial = 0; trial < 300; ++trial) {
    const Vec3 a = random.in_cube(), b = random.in_cube(), c = random.in_cube(), q = 2 * random.in_cube();
    const NearestPoint nearest = nearest_on_triangle(q, a, b, c);
    double sampled = 1e9;
    for (int i = 0; i <= 60; ++i)
      for (int j = 0; i + j <= 60; ++j)
        sampled = std::min(sampled, (q - a - i / 60.0 * (b - a) - j / 60.0 * (c - a)).norm());
    CHECK(nearest.distance <= sampled + 1e-14);
    CHECK(nearest.distance > sampled - 0.08);
    CHECK(nearest.barycentric.minCoeff() >= 0);
    CHECK_THAT(nearest.barycentric.sum(), WithinAbs(1, 1e-14));
    const Vec3 point = nearest.barycentric[0] * a + nearest.barycentric[1] * b + nearest.barycentric[2] * c;
    CHECK((point - nearest.point).norm() < 1e-14);
    CHECK_THAT((q - nearest.point).norm(), WithinAbs(nearest.distance, 1e-14));
  }
}

TEST_CASE("PointDistance.SegmentsAndPointsInsteadOfTriangles") {
  const Vec3 a(0, 0, 0), b(2, 0, 0);
  CHECK(nearest_on_triangle(Vec3(1, 1, 0), a, b, b).distance == 1);
  CHECK(nearest_on_triangle(Vec3(1, 1, 0), a, Vec3(1, 0, 0), b).distance == 1);
  CHECK(nearest_on_triangle(Vec3(0, 3, 4), a, a, a).distance == 5);
}

TEST_CASE("PointDistance.SameAsLookingAtEveryTriangle") {
  Random random(9);
  for (const TriangleMesh& mesh : {torus(24, 12), grid(9, 7, 0.3), moved(icosphere(2), Vec3(1e4, 0, -1e4)), cube()}) {
    const PointDistance tree(mesh);
    const BoundingBox box = bounding_box(mesh);
    for (int trial = 0; trial < 300; ++trial) {
      const Vec3 q = trial % 10 == 0
                         ? Vec3(mesh.V.row(random.below(mesh.vertex_count())))
                         : Vec3(box.centre() + box.diagonal() * (trial % 3 == 0 ? 10 : 0.6) * random.in_cube());
      NearestPoint expected;
      for (int f = 0; f < mesh.face_count(); ++f) {
        const NearestPoint one =
            nearest_on_triangle(q, mesh.V.row(mesh.F(f, 0)), mesh.V.row(mesh.F(f, 1)), mesh.V.row(mesh.F(f, 2)));
        if (expected.face >= 0 && one.distance >= expected.distance) continue;
        expected = one;
        expected.face = f;
      }
      const auto found = tree.nearest(q);
      REQUIRE(found);
      CHECK(found->distance == expected.distance);
      CHECK(found->face == expected.face);
    }
  }
}

TEST_CASE("SurfaceDistance.BetweenSpheres") {
  Context context;
  const TriangleMesh inner = icosphere(4), outer = moved(icosphere(4), Vec3(0, 0, 0), 1.5);
  const SurfaceDistance distance = surface_distance(outer, PointDistance(inner), 0.05, context);
  // Between concentric spheres of 1 and 1.5, both inscribed with a sagitta below 1e-3 of the radius... per edge^2 / 8.
  CHECK_THAT(distance.mean, WithinAbs(0.5, 3e-3));
  CHECK_THAT(distance.root_mean_square, WithinAbs(0.5, 3e-3));
  CHECK(distance.maximum >= 0.5 - 1e-12);
  CHECK(distance.maximum < 0.503);
  CHECK((surface_distance(inner, PointDistance(inner), 0.05, context).maximum < 1e-12) == true);
}

TEST_CASE("SurfaceDistance.HausdorffIsSymmetricAndMeetsTheBound") {
  Context context;
  // A unit square, and the same with a spike of height 0.7 pulled out of its middle vertex.
  const TriangleMesh flat = grid(4, 4);
  TriangleMesh spike = flat;
  spike.V(12, 2) = 0.7;
  CHECK_THAT(hausdorff_distance(flat, spike, 0.01, context), WithinAbs(0.7, 1e-15));
  CHECK(hausdorff_distance(flat, spike, 0.01, context) == hausdorff_distance(spike, flat, 0.01, context));
  // From the flat side the farthest point lies inside a face, where only sampling sees it; finer is larger.
  const PointDistance to(spike);
  const double coarse = surface_distance(flat, to, 0.2, context).maximum,
               fine = surface_distance(flat, to, 0.01, context).maximum;
  CHECK(fine > 0.1);
  CHECK(std::abs(fine - coarse) < 0.2);
}

TEST_CASE("SurfaceDistance.BadInputAndCancel") {
  Context context;
  CHECK_THROWS_AS(PointDistance{TriangleMesh{}}, Error);
  const PointDistance to(cube());
  CHECK_THROWS_AS(surface_distance(cube(), to, 0, context), Error);
  Host host;
  host.cancel_requested = [] { return true; };
  Context cancelled(host);
  try {
    surface_distance(cube(), to, 0.01, cancelled);
    FAIL();
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::cancelled);
  }
}

}  // namespace
}  // namespace formwright
