// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/parts/limbs.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "zippable/zippable_shapes.h"

using namespace formwright;
using namespace formwright::test;

namespace {

std::vector<Limb> limbs_of_mesh(const TriangleMesh& mesh) {
  Context context;
  return find_limbs(mesh, 20, context);
}

TriangleMesh sample_mesh(const char* name, int vertices) {
  Context context;
  return make_sample(name, vertices, context).mesh;
}

/// Closed by a point at either end, of a profile from one pole to the other; height along z.
template <class Profile>
TriangleMesh solid_of_revolution(int around, int rows, const Profile& profile) {
  TriangleMesh mesh = turned(around, rows, profile);
  const int low = mesh.vertex_count(), high = low + 1, top = rows * around;
  mesh.V.conservativeResize(low + 2, 3);
  mesh.V.row(low) << 0, 0, mesh.V.topRows(around).col(2).mean();
  mesh.V.row(high) << 0, 0, mesh.V.middleRows(top, around).col(2).mean();
  const Eigen::Index faces = mesh.F.rows();
  mesh.F.conservativeResize(faces + 2 * around, 3);
  for (int i = 0; i < around; ++i) {
    mesh.F.row(faces + 2 * i) << low, (i + 1) % around, i;
    mesh.F.row(faces + 2 * i + 1) << high, top + i, top + (i + 1) % around;
  }
  return mesh;
}

}  // namespace

TEST_CASE("Limbs.BallEggAndTubeHaveNone") {
  CHECK(limbs_of_mesh(icosphere(4)).empty());
  TriangleMesh egg = icosphere(4);
  egg.V.col(2) *= 2;
  CHECK(limbs_of_mesh(egg).empty());
  const TriangleMesh capsule = solid_of_revolution(40, 80, [](double t) {
    const double s = 10 * (0.02 + 0.96 * t);  // along the profile: two caps of radius 1 and a tube between them
    const double cap = std::numbers::pi / 2, tube = 10 - 2 * cap;
    if (s < cap) return Vec2(std::sin(s), -std::cos(s));
    if (s < cap + tube) return Vec2(1, s - cap);
    return Vec2(std::cos(s - cap - tube), tube + std::sin(s - cap - tube));
  });
  CHECK(limbs_of_mesh(capsule).empty());
}

TEST_CASE("Limbs.OfTwoBallsJoinedByATubeTheSmallerOneEndsAtTheTube") {
  // A ball of radius 1 about z = 0, a tube of radius 0.4, a ball of radius 2 behind it.
  const double r = 0.4, small = std::sqrt(1 - r * r), large = std::sqrt(4 - r * r), tube = 1.5;
  const double polar_small = std::numbers::pi - std::asin(r), polar_large = std::numbers::pi - std::asin(r / 2);
  const double length = polar_small + tube + 2 * polar_large;
  const TriangleMesh mesh = solid_of_revolution(48, 160, [&](double t) {
    const double s = length * (0.01 + 0.98 * t);
    if (s < polar_small) return Vec2(std::sin(s), -std::cos(s));
    if (s < polar_small + tube) return Vec2(r, small + s - polar_small);
    const double angle = std::asin(r / 2) + (s - polar_small - tube) / 2;
    return Vec2(2 * std::sin(angle), small + tube + large - 2 * std::cos(angle));
  });
  const std::vector<Limb> limbs = limbs_of_mesh(mesh);
  REQUIRE(limbs.size() == 1);
  const Limb& limb = limbs.front();
  CHECK_THAT(limb.neck_mm, Catch::Matchers::WithinRel(2 * std::numbers::pi * r, 0.05));
  // On the tube.
  CHECK(limb.length_mm > polar_small - 0.1);
  CHECK(limb.length_mm < polar_small + tube + 0.1);
  CHECK_THAT(limb.towards.z(), Catch::Matchers::WithinAbs(-1, 1e-3));
  CHECK(limb.centre.head<2>().norm() < 1e-2);
  CHECK(limb.area_mm2 > 2 * std::numbers::pi * (1 + small) * 0.97);
}

TEST_CASE("Limbs.AStarHasFiveAndAnOctopusSeveral") {
  CHECK(limbs_of_mesh(sample_mesh("star", 2000)).size() == 5);
  // Eight arms and the head; what hardly narrows may be missed.
  CHECK(limbs_of_mesh(sample_mesh("octopus", 2000)).size() >= 8);
  CHECK(limbs_of_mesh(sample_mesh("hemisphere", 2000)).empty());
  Context context;
  CHECK(find_limbs(sample_mesh("octopus", 2000), 4, context).size() == 4);
}

TEST_CASE("Limbs.AreTheSameForAShapeThatIsTurnedMovedAndScaled") {
  const TriangleMesh mesh = sample_mesh("octopus", 1500);
  TriangleMesh other = mesh;
  other.V = ((3 * mesh.V) * Eigen::AngleAxisd(1.3, Vec3(1, -2, 0.5).normalized()).toRotationMatrix()).rowwise() +
            Eigen::RowVector3d(100, 20, -7);
  const std::vector<Limb> before = limbs_of_mesh(mesh), after = limbs_of_mesh(other);
  REQUIRE(before.size() == after.size());
  for (const Limb& limb : before) {
    const auto same = std::find_if(after.begin(), after.end(), [&](const Limb& l) { return l.tip == limb.tip; });
    REQUIRE(same != after.end());
    CHECK_THAT(same->length_mm, Catch::Matchers::WithinRel(3 * limb.length_mm, 1e-6));
    CHECK_THAT(same->area_mm2, Catch::Matchers::WithinRel(9 * limb.area_mm2, 1e-6));
  }
}

TEST_CASE("Limbs.TuckedInTwiceAreWhereTheyWereAwayFromTheNeck") {
  const TriangleMesh mesh = sample_mesh("star", 2000);
  for (const Limb& limb : limbs_of_mesh(mesh)) {
    const Positions once = tucked_in(mesh.V, limb), twice = tucked_in(once, limb);
    const auto height = [&](const Positions& x, Eigen::Index v) {
      return limb.towards.dot(x.row(v).transpose() - limb.centre);
    };
    CHECK(height(mesh.V, limb.tip) > 0);
    CHECK_THAT(height(once, limb.tip), Catch::Matchers::WithinAbs(-height(mesh.V, limb.tip), 1e-9));
    for (Eigen::Index v = 0; v < mesh.V.rows(); ++v) {
      if (limb.distance_mm[v] >= limb.length_mm) CHECK(once.row(v) == mesh.V.row(v));
      if (limb.distance_mm[v] < 0.83 * limb.length_mm) CHECK((twice.row(v) - mesh.V.row(v)).norm() < 1e-9);
    }
    // No triangle is folded flat to nothing.
    double least = 1e300;
    for (Eigen::Index f = 0; f < mesh.F.rows(); ++f)
      least = std::min(least, Vec3(once.row(mesh.F(f, 1)) - once.row(mesh.F(f, 0)))
                                  .cross(Vec3(once.row(mesh.F(f, 2)) - once.row(mesh.F(f, 0))))
                                  .norm());
    CHECK(least > 0);
  }
}
