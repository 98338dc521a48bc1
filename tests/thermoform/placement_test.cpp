// SPDX-License-Identifier: GPL-3.0-or-later
#include "thermoform/sheet/placement.h"

#include <algorithm>
#include <catch2/catch_approx.hpp>
#include <catch2/catch_test_macros.hpp>

namespace formwright {
namespace {

using Catch::Approx;

/// A tetrahedron that fills a box; its up is z.
TriangleMesh corner_of_box(double x, double y, double z) {
  TriangleMesh mesh;
  mesh.V.resize(4, 3);
  mesh.V << 0, 0, 0, x, 0, 0, 0, y, 0, 0, 0, z;
  mesh.F.resize(4, 3);
  mesh.F << 0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3;
  return mesh;
}

double automatic_size_mm(double x, double y, double z, const Vec2& opening_mm) {
  PlacementOptions options;
  options.up = {0, 0, 1};
  return place(corner_of_box(x, y, z), options, opening_mm).scale * std::max({x, y, z});
}

TEST_CASE("Placement.AnAutomaticSizeLeavesAMarginToTheClamp") {
  const Vec2 opening_mm(200, 150);
  CHECK(automatic_size_mm(190, 140, 60, opening_mm) == Approx(190));  // the file's own, 5 mm free on every side
  CHECK(automatic_size_mm(190.1, 140, 60, opening_mm) == Approx(100));
  CHECK(automatic_size_mm(190, 140.1, 60, opening_mm) == Approx(100));
  CHECK(automatic_size_mm(0.5, 0.2, 1, opening_mm) == Approx(100));
  // 100 mm would not leave it
  CHECK(automatic_size_mm(1, 1, 1, Vec2(80, 300)) == Approx(70));
  CHECK(automatic_size_mm(40, 40, 40, Vec2(30, 30)) == Approx(20));
  CHECK(automatic_size_mm(40, 40, 40, Vec2(8, 8)) == Approx(0.8));
}

TEST_CASE("Placement.WhatWasDecidedIsSaid") {
  PlacementOptions options;
  options.up = {0, 0, 1};
  CHECK(place(corner_of_box(50, 50, 50), options, Vec2(200, 200)).notes.empty());
  const Placement placement = place(corner_of_box(1, 1, 1), options, Vec2(80, 300));
  REQUIRE(placement.notes.size() == 1);
  CHECK(placement.notes.front() ==
        "The file's own size, 1 mm, does not suit the machine: the longest side is now 70 mm.");
}

}  // namespace
}  // namespace formwright
