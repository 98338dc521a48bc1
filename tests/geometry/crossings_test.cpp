// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/queries/crossings.h"

#include <catch2/catch_test_macros.hpp>

#include <vector>

#include "base/error.h"

namespace formwright {
namespace {

/// A strip of squares of `side_mm` along x at the height z_mm(x), its two rows of vertices at y from -1 to 1.
template <class Height>
TriangleMesh strip(int squares, double side_mm, Height z_mm) {
  TriangleMesh mesh;
  mesh.V.resize(2 * (squares + 1), 3);
  mesh.F.resize(2 * squares, 3);
  for (int i = 0; i <= squares; ++i)
    for (int j = 0; j < 2; ++j) mesh.V.row(2 * i + j) << i * side_mm, 2 * j - 1, z_mm(i * side_mm);
  for (int i = 0; i < squares; ++i) {
    mesh.F.row(2 * i) << 2 * i, 2 * i + 2, 2 * i + 1;
    mesh.F.row(2 * i + 1) << 2 * i + 1, 2 * i + 2, 2 * i + 3;
  }
  return mesh;
}

TEST_CASE("Crossings.FlatAndBentSurfacesHaveNone") {
  Context context;
  CHECK(count_crossings(strip(10, 1, [](double) { return 0.0; }), {}, context) == 0);
  CHECK(count_crossings(strip(10, 1, [](double x) { return x * x; }), {}, context) == 0);
}

TEST_CASE("Crossings.EveryEdgeThatPiercesATriangleCounts") {
  TriangleMesh mesh;
  mesh.V.resize(6, 3);
  mesh.V << 0, 0, 0, 4, 0, 0, 0, 4, 0,  // in the plane z = 0
      1, 1, -1, 1, 1, 1, 9, 9, 9;       // two edges of this one go through it, to the corner below
  mesh.F.resize(2, 3);
  mesh.F << 0, 1, 2, 3, 4, 5;
  Context context;
  CHECK(count_crossings(mesh, {}, context) == 2);
  // Beside it.
  mesh.V.row(3) << 5, 5, -1;
  mesh.V.row(4) << 5, 5, 1;
  CHECK(count_crossings(mesh, {}, context) == 0);
  // Above it.
  mesh.V.row(3) << 1, 1, 0.5;
  mesh.V.row(4) << 1, 1, 1;
  CHECK(count_crossings(mesh, {}, context) == 0);
}

TEST_CASE("Crossings.WhatSharesAPlaceDoesNotCount") {
  TriangleMesh mesh;
  mesh.V.resize(6, 3);
  mesh.V << 0, 0, 0, 4, 0, 0, 0, 4, 0, 1, 1, -1, 1, 1, 1, 9, 9, 9;
  mesh.F.resize(2, 3);
  mesh.F << 0, 1, 2, 3, 4, 5;
  Context context;
  const std::vector<int> apart{0, 1, 2, 3, 4, 5}, sewn{0, 1, 2, 0, 4, 5};
  CHECK(count_crossings(mesh, apart, context) == 2);
  CHECK(count_crossings(mesh, sewn, context) == 0);
}

TEST_CASE("Crossings.StopsWhenCancelled") {
  Host host;
  host.cancel_requested = [] { return true; };
  Context context(host);
  CHECK_THROWS_AS(count_crossings(strip(300, 1, [](double) { return 0.0; }), {}, context), Error);
}

}  // namespace
}  // namespace formwright
