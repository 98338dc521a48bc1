// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/point_distance.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "geometry/measures.h"
#include "geometry/test_meshes.h"

namespace formwright {
namespace {
using namespace test;

TEST(PointDistance, ExactAroundTheCube) {
  const PointDistance cube_distance(cube());
  const auto at = [&](double x, double y, double z) { return *cube_distance.nearest(Vec3(x, y, z)); };
  EXPECT_EQ(at(0.3, 0.4, 3).distance, 2);
  EXPECT_EQ(at(0.3, 0.4, 3).point, Vec3(0.3, 0.4, 1));
  EXPECT_NEAR(at(2, 2, 0.5).distance, std::sqrt(2.0), 1e-15);  // an edge
  EXPECT_NEAR(at(2, 2, 2).distance, std::sqrt(3.0), 1e-15);    // a corner
  EXPECT_NEAR(at(0.5, 0.5, 0.6).distance, 0.4, 1e-15);         // from inside
  EXPECT_EQ(at(0.25, 0.75, 0).distance, 0);
  EXPECT_FALSE(cube_distance.nearest(Vec3(0.3, 0.4, 3), 1.99));
  EXPECT_TRUE(cube_distance.nearest(Vec3(0.3, 0.4, 3), 2));
}

TEST(PointDistance, EveryRegionOfATriangle) {
  // Against dense sampling of the triangle, in the plane and off it.
  Random random(2);
  for (int trial = 0; trial < 300; ++trial) {
    const Vec3 a = random.in_cube(), b = random.in_cube(), c = random.in_cube(), q = 2 * random.in_cube();
    const NearestPoint nearest = nearest_on_triangle(q, a, b, c);
    double sampled = 1e9;
    for (int i = 0; i <= 60; ++i)
      for (int j = 0; i + j <= 60; ++j)
        sampled = std::min(sampled, (q - a - i / 60.0 * (b - a) - j / 60.0 * (c - a)).norm());
    EXPECT_LE(nearest.distance, sampled + 1e-14);
    EXPECT_GT(nearest.distance, sampled - 0.08);
    EXPECT_GE(nearest.barycentric.minCoeff(), 0);
    EXPECT_NEAR(nearest.barycentric.sum(), 1, 1e-14);
    const Vec3 point = nearest.barycentric[0] * a + nearest.barycentric[1] * b + nearest.barycentric[2] * c;
    EXPECT_LT((point - nearest.point).norm(), 1e-14);
    EXPECT_NEAR((q - nearest.point).norm(), nearest.distance, 1e-14);
  }
}

TEST(PointDistance, SegmentsAndPointsInsteadOfTriangles) {
  const Vec3 a(0, 0, 0), b(2, 0, 0);
  EXPECT_EQ(nearest_on_triangle(Vec3(1, 1, 0), a, b, b).distance, 1);
  EXPECT_EQ(nearest_on_triangle(Vec3(1, 1, 0), a, Vec3(1, 0, 0), b).distance, 1);
  EXPECT_EQ(nearest_on_triangle(Vec3(0, 3, 4), a, a, a).distance, 5);
}

TEST(PointDistance, SameAsLookingAtEveryTriangle) {
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
      ASSERT_TRUE(found);
      EXPECT_EQ(found->distance, expected.distance);
      EXPECT_EQ(found->face, expected.face);
    }
  }
}

TEST(SurfaceDistance, BetweenSpheres) {
  Context context;
  const TriangleMesh inner = icosphere(4), outer = moved(icosphere(4), Vec3(0, 0, 0), 1.5);
  const SurfaceDistance distance = surface_distance(outer, PointDistance(inner), 0.05, context);
  // Between concentric spheres of 1 and 1.5, both inscribed with a sagitta below 1e-3 of the radius... per edge^2 / 8.
  EXPECT_NEAR(distance.mean, 0.5, 3e-3);
  EXPECT_NEAR(distance.root_mean_square, 0.5, 3e-3);
  EXPECT_GE(distance.maximum, 0.5 - 1e-12);
  EXPECT_LT(distance.maximum, 0.503);
  EXPECT_EQ(surface_distance(inner, PointDistance(inner), 0.05, context).maximum < 1e-12, true);
}

TEST(SurfaceDistance, HausdorffIsSymmetricAndMeetsTheBound) {
  Context context;
  // A unit square, and the same with a spike of height 0.7 pulled out of its middle vertex.
  const TriangleMesh flat = grid(4, 4);
  TriangleMesh spike = flat;
  spike.V(12, 2) = 0.7;
  EXPECT_NEAR(hausdorff_distance(flat, spike, 0.01, context), 0.7, 1e-15);
  EXPECT_EQ(hausdorff_distance(flat, spike, 0.01, context), hausdorff_distance(spike, flat, 0.01, context));
  // From the flat side the farthest point lies inside a face, where only sampling sees it; finer is larger.
  const PointDistance to(spike);
  const double coarse = surface_distance(flat, to, 0.2, context).maximum,
               fine = surface_distance(flat, to, 0.01, context).maximum;
  EXPECT_GT(fine, 0.1);
  EXPECT_LT(std::abs(fine - coarse), 0.2);
}

TEST(SurfaceDistance, BadInputAndCancel) {
  Context context;
  EXPECT_THROW(PointDistance{TriangleMesh{}}, Error);
  const PointDistance to(cube());
  EXPECT_THROW(surface_distance(cube(), to, 0, context), Error);
  Host host;
  host.cancel_requested = [] { return true; };
  Context cancelled(host);
  try {
    surface_distance(cube(), to, 0.01, cancelled);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::cancelled);
  }
}

}  // namespace
}  // namespace formwright
