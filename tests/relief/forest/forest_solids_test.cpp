// SPDX-License-Identifier: GPL-3.0-or-later
// Finished pillars: closed, within their space, and what rays see of them.
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>

#include "geometry/mesh/adjacency.h"
#include "geometry/mesh/measures.h"
#include "relief/forest/forest_fixture.h"
#include "relief/forest/forest_picture.h"

namespace formwright {
namespace {
using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::WithinAbs;
using test::round_pillar;
using test::Solved;
using test::solved;
using test::square_pillar;
using test::viewpoint;

TriangleMesh octopus() {
  Context context;
  return make_sample("octopus", 2500, context).mesh;
}

ForestScene one_side() {
  ForestScene scene;
  scene.viewpoints = {viewpoint({0, -400, 40}, {0, 0, 40}, 60)};
  scene.pillars = {square_pillar(-24, -10, 15, 80), round_pillar(-10, 14, 9, 40, 80), square_pillar(6, -16, 18, 80, 20),
                   square_pillar(24, 8, 20, 80), square_pillar(0, 80, 10, 80)};
  return scene;
}

ForestOptions quick() {
  ForestOptions options;
  options.pixel_mm = 0.8;
  options.check_rays = 120;
  return options;
}

double max_outside_mm(const Solved& s, std::size_t pillar) {
  double farthest = 0;
  const Outline& outline = s.plan.scene.pillars[pillar].outline_mm;
  const TriangleMesh& mesh = s.forest.pillars[pillar].mesh;
  for (Eigen::Index i = 0; i < mesh.V.rows(); ++i) {
    const Vec2 p = mesh.V.row(i).head<2>().transpose();
    if (!is_inside(outline, p)) farthest = std::max(farthest, distance_to_outline(outline, p));
  }
  return farthest;
}

TEST_CASE("ForestSolids.APillarWithoutAPieceIsAPrismWithItsPin") {
  const Solved s = solved(one_side(), octopus(), quick());
  // The last pillar stands hidden behind the others. 10 mm are too narrow for its number; the groove of its mark is
  // 0.8 mm wide and 0.5 mm deep, from the round pin of 4 mm to the side 5 mm away.
  const PillarSolid& pillar = s.forest.pillars[4];
  const double r = 2, corners = 48, pin = 0.5 * corners * r * r * std::sin(2 * std::numbers::pi / corners) * 8;
  const double in_pin = 0.8 * std::sqrt(r * r - 0.16) + (r * r * std::asin(0.4 / r) - 0.4 * std::sqrt(r * r - 0.16));
  CHECK_THAT(pillar.volume_mm3, WithinAbs(100 * 80 + pin - 0.5 * (0.8 * 5 - in_pin), 0.02));
  CHECK(pillar.watertight);
  const BoundingBox box = bounding_box(pillar.mesh);
  CHECK_THAT(box.lower.z(), WithinAbs(-8, 1e-4));
  CHECK_THAT(box.upper.z(), WithinAbs(80, 1e-4));
}

TEST_CASE("ForestSolids.AreClosedInOnePartAndInTheirSpace") {
  for (const double carve : {0.0, 1.5}) {
    ForestOptions options = quick();
    options.carve_depth_mm = carve;
    const Solved s = solved(one_side(), octopus(), options);
    for (std::size_t p = 0; p < s.forest.pillars.size(); ++p) {
      INFO("pillar " << p + 1 << ", carved " << carve);
      const PillarSolid& pillar = s.forest.pillars[p];
      const Adjacency adjacency(pillar.mesh);
      CHECK(adjacency.is_closed());
      CHECK(vertex_components(adjacency).count == 1);
      CHECK(pillar.volume_mm3 > 0);
      CHECK(max_outside_mm(s, p) <= options.thickness_mm + 0.01);
      // Between its ends nothing lies deeper than is carved, apart from the grooves in the underside.
      const Outline& outline = s.plan.scene.pillars[p].outline_mm;
      double deepest = 0;
      for (Eigen::Index i = 0; i < pillar.mesh.V.rows(); ++i) {
        const Vec3 v = pillar.mesh.V.row(i).transpose();
        if (v.z() < 3 || v.z() > 79.99 || !is_inside(outline, v.head<2>())) continue;
        deepest = std::max(deepest, distance_to_outline(outline, v.head<2>()));
      }
      CHECK(deepest <= carve + (carve > 0 ? 0.35 : 0.01));
    }
    CHECK(s.forest.checks[0].intruding == 0);
    CHECK(s.forest.checks[0].rays > 2000);
  }
}

TEST_CASE("ForestSolids.MoreIsSeenWithSmallerPixels") {
  // What is missed lies along silhouette and borders, in strips of the width of a pixel.
  double missed_before = 1;
  for (const double pixel : {1.6, 0.8, 0.4}) {
    ForestOptions options = quick();
    options.pixel_mm = pixel;
    options.check_rays = 300;
    const ViewCheck check = solved(one_side(), octopus(), options).forest.checks[0];
    const double met = check.rays - check.nothing, missed = 1 - check.seen / met;
    INFO("pixel " << pixel << ": missed " << missed);
    CHECK(missed < 0.6 * missed_before);
    missed_before = missed;
  }
  CHECK(missed_before < 0.03);
}

/// Two viewpoints, 60 degrees apart, see the front of one pillar.
ForestScene two_sides() {
  ForestScene scene;
  scene.viewpoints = {viewpoint({-200, -346, 40}, {0, 0, 40}, 24), viewpoint({200, -346, 40}, {0, 0, 40}, 24)};
  scene.pillars = {square_pillar(0, 0, 20, 80)};
  return scene;
}

TEST_CASE("ForestSolids.PiecesOfOtherModelsAreRefusedWithThePillar") {
  ForestOptions options = quick();
  options.shared_walls = SharedWalls::squarest;
  try {
    solved(two_sides(), octopus(), options);
    FAIL("not refused");
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::invalid_input);
    CHECK(error.where() == "intrusion");
    CHECK_THAT(error.what(), ContainsSubstring("pillar 1") && ContainsSubstring("viewpoint"));
  }
  options.intrusion = Intrusion::allowed;
  const Solved allowed = solved(two_sides(), octopus(), options);
  CHECK(allowed.forest.checks[0].intruding + allowed.forest.checks[1].intruding > 100);
  CHECK(std::max(allowed.forest.checks[0].worst_pillar(), allowed.forest.checks[1].worst_pillar()) == 0);
}

TEST_CASE("ForestSolids.SharedSurfacesLeftBareKeepOthersOut") {
  ForestScene scene = two_sides();
  scene.pillars.push_back(square_pillar(-24, 0, 12, 80));
  scene.pillars.push_back(square_pillar(24, 0, 12, 80));
  const Solved s = solved(scene, octopus(), quick());
  for (const ViewCheck& check : s.forest.checks) {
    CHECK(check.intruding == 0);
    CHECK(check.worst_pillar() == -1);
    CHECK(check.bare > 0);
  }
}

TEST_CASE("ForestSolids.AreTheSameEveryTime") {
  const Solved a = solved(one_side(), octopus(), quick()), b = solved(one_side(), octopus(), quick());
  for (std::size_t p = 0; p < a.forest.pillars.size(); ++p) {
    CHECK(a.forest.pillars[p].mesh.V == b.forest.pillars[p].mesh.V);
    CHECK(a.forest.pillars[p].mesh.F == b.forest.pillars[p].mesh.F);
  }
}

TEST_CASE("ForestSolids.WhatCannotBeMadeIsRefusedBySentence") {
  ForestOptions options = quick();
  options.pin_diameter_mm = 12;
  CHECK_THROWS_WITH(solved(one_side(), octopus(), options), ContainsSubstring("Pillar 5 is too narrow"));
  options = quick();
  options.pixel_mm = 0.05;
  ForestScene scene = one_side();
  for (Pillar& pillar : scene.pillars) pillar.height_mm = 100000;
  CHECK_THROWS_WITH(solved(scene, octopus(), options), ContainsSubstring("pixel_mm"));
  scene = one_side();
  scene.viewpoints[0].eye_mm = {-3, -3, 300};
  CHECK_THROWS_WITH(solved(scene, octopus(), quick()), ContainsSubstring("Viewpoint 1 looks too steeply"));
}

TEST_CASE("ForestSolids.APictureShowsThePillars") {
  Context context;
  const Solved s = solved(one_side(), octopus(), quick());
  const ForestCamera camera = camera_of(s.plan.scene.viewpoints[0], s.plan.height_shares[0]);
  const Image image = picture_of_forest(s.forest.standing, *s.forest.caster, camera, 120, context);
  CHECK(image.width == 120);
  CHECK(image.height == 96);
  // In the middle a pillar, which is not as light as floor and sky.
  CHECK(image.at(60, 48)[0] < 230);
  const ForestCamera elsewhere = camera_from_elsewhere(s.plan.scene);
  CHECK((elsewhere.eye_mm - s.plan.scene.viewpoints[0].eye_mm).norm() > 100);
}

}  // namespace
}  // namespace formwright
