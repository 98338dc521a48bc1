// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/base/seen_regions.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <random>
#include <string>

#include "relief/parts/parts_fixture.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;

/// A flat rectangle at depths z = `depth` + `slope` x.
TriangleMesh sheet(const Vec2& low, const Vec2& high, double depth, double slope = 0) {
  TriangleMesh mesh;
  mesh.V.resize(4, 3);
  for (int i = 0; i < 4; ++i) {
    const double x = i & 1 ? high.x() : low.x(), y = i & 2 ? high.y() : low.y();
    mesh.V.row(i) << x, y, depth + slope * x;
  }
  mesh.F.resize(2, 3);
  mesh.F << 0, 1, 2, 1, 3, 2;
  return mesh;
}

TEST_CASE("SeenRegions.WhatIsBehindIsCutOut") {
  Context context;
  const std::vector<Region> seen = seen_regions(
      {sheet({0, 0}, {4, 4}, 2), sheet({1, 1}, {3, 2}, 1), sheet({3.5, 0}, {6, 1}, 3)}, {0, 1, 2}, context);
  CHECK_THAT(seen[0].area(), WithinAbs(16 - 2, 1e-8));
  CHECK(seen[0].rings.size() == 2);
  CHECK_THAT(seen[1].area(), WithinAbs(2, 1e-8));
  CHECK_THAT(seen[2].area(), WithinAbs(2.5 - 0.5, 1e-8));
}

TEST_CASE("SeenRegions.SurfacesMayLieBeforeAndBehindEachOther") {
  // A sheet that leans over a bar: to the left it is behind, to the right before.
  const TriangleMesh leaning = sheet({-2, -1}, {-0.5, 1}, 0, -1), bar = sheet({-2, -0.5}, {2, 0.5}, 0);
  TriangleMesh both = test::joined(leaning, sheet({0.5, -1}, {2, 1}, 0, -1));
  Context context;
  const std::vector<Region> seen = seen_regions({both, bar}, {0, 1}, context);
  // Left of 0 the leaning one is at z = -x > 0, behind the bar.
  CHECK_THAT(seen[1].area(), WithinAbs(2.5, 1e-6));
  CHECK_THAT(seen[0].area(), WithinAbs(3 - 1.5 + 3, 1e-6));
}

TEST_CASE("SeenRegions.SurfacesThatCrossAreRefused") {
  Context context;
  try {
    seen_regions({sheet({-1, -1}, {1, 1}, 0, 1), sheet({-1, -1}, {1, 1}, 0, -1)}, {0, 1}, context);
    FAIL("no error");
  } catch (const Error& error) {
    CHECK(error.where() == "base_mesh");
    CHECK(std::string(error.what()).find("Parts 1 and 2") != std::string::npos);
  }
}

TEST_CASE("SeenRegions.AgreeWithRaysOnManyBalls") {
  // Near and straight on; solids whose outlines are curved and that hide each other in part.
  for (const double kappa : {0.0, 0.3}) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> place(-1, 1), size(0.1, 0.25);
    TriangleMesh base;
    std::vector<Vec3> middles;
    std::vector<double> radii;
    while (middles.size() < 25) {
      const Vec3 middle(place(random), place(random), place(random));
      const double radius = size(random);
      bool apart = true;
      for (std::size_t k = 0; k < middles.size(); ++k)
        apart = apart && (middles[k] - middle).norm() > radii[k] + radius;
      if (!apart) continue;
      middles.push_back(middle);
      radii.push_back(radius);
      // View coordinates are left-handed.
      const TriangleMesh ball = test::reversed(test::moved(test::icosphere(2), middle, radius));
      base = middles.size() == 1 ? ball : test::joined(base, ball);
    }
    Context context;
    const BaseParts parts(base, kappa, context);
    REQUIRE(parts.count() == 25);
    double area = 0;
    for (int part = 0; part < 25; ++part) area += parts.seen(part).area();
    int met = 0, near_borders = 0;
    for (int k = 0; k < 5000; ++k) {
      const Vec2 p = 1.3 * Vec2(place(random), place(random));
      const auto hit = parts.foremost(p);
      int holding = 0, holder = -1;
      for (int part = 0; part < 25; ++part)
        if (parts.seen(part).contains(p)) {
          ++holding;
          holder = part;
        }
      met += hit && hit->carries;
      // Within 1e-6 of a border either answer is right; so near none of these points is.
      const bool carries = hit && hit->carries;
      near_borders += holding != (carries ? 1 : 0) || (carries && holder != hit->part);
    }
    CHECK(near_borders == 0);
    CHECK_THAT(4 * 1.3 * 1.3 * met / 5000.0, WithinRel(area, 0.05));
  }
}

TEST_CASE("BaseParts.CountsWhatHangsTogetherAndKeepsHollows") {
  const TriangleMesh two = test::joined(test::box_mm({0, 0, 0}, {1, 1, 1}), test::box_mm({2, 0, 0}, {3, 1, 1}));
  CHECK(count_base_parts(two) == 2);
  CHECK(count_base_parts(test::joined(two, test::reversed(test::box_mm({2.2, 0.2, 0.2}, {2.8, 0.8, 0.8})))) == 2);
  CHECK(count_base_parts(test::joined(two, test::box_mm({2.2, 0.2, 0.2}, {2.8, 0.8, 0.8}))) == 3);
}

TEST_CASE("BaseParts.SaysWhereARayEntersAndLeaves") {
  Context context;
  const TriangleMesh base = test::joined(test::reversed(test::box_mm({-1, -1, 1}, {0, 1, 2})),
                                         test::reversed(test::box_mm({0.1, -1, 0}, {1, 1, 3})));
  const BaseParts parts(base, 0.25, context);
  const auto passage = parts.passage(0, Vec2(-0.4, 0.2));
  REQUIRE(passage.has_value());
  CHECK_THAT(passage->enters, WithinAbs(1, 1e-12));
  CHECK_THAT(passage->leaves, WithinAbs(2, 1e-12));
  CHECK(BaseParts::limits(*passage, 0.3, 0.2) == Vec2(passage->enters - 0.3, passage->enters + 0.2));
  CHECK_THAT(BaseParts::limits(*passage, 0.3, 5)[1], WithinAbs(1.5, 1e-12));  // half-way through
  CHECK(!parts.passage(0, Vec2(0.5, 0)).has_value());
  CHECK(parts.foremost(Vec2(0.5, 0))->part == 1);
  // On the outline itself.
  CHECK(parts.passage(1, Vec2(1, 0)).has_value());
}

TEST_CASE("BaseParts.RefusesWhatReachesToTheViewpointAndTooMany") {
  Context context;
  CHECK_THROWS_AS(BaseParts(test::joined(test::box_mm({-1, -1, -5}, {0, 1, 2}), test::box_mm({1, -1, 0}, {2, 1, 2})),
                            0.25, context),
                  Error);
  TriangleMesh many;
  for (int k = 0; k < 201; ++k) {
    const TriangleMesh box = test::box_mm({2.0 * k, 0, 0}, {2.0 * k + 1, 1, 1});
    many = k == 0 ? box : test::joined(many, box);
  }
  CHECK_THROWS_AS(BaseParts(many, 0, context), Error);
}

}  // namespace
}  // namespace formwright
