// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "geometry/mesh/measures.h"
#include "geometry/repair/repaired.h"
#include "geometry/test_meshes.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;
using namespace test;

TEST_CASE("Repair.FillsHoles") {
  TriangleMesh mesh = icosphere(3);
  const double volume = signed_volume(mesh);
  // Takes out the faces around vertices 0 (5 faces) and 100 (6 faces).
  std::vector<std::array<int, 3>> faces;
  for (int f = 0; f < mesh.face_count(); ++f) {
    bool out = false;
    for (int k = 0; k < 3; ++k) out = out || mesh.F(f, k) == 0 || mesh.F(f, k) == 100;
    if (!out) faces.push_back({mesh.F(f, 0), mesh.F(f, 1), mesh.F(f, 2)});
  }
  TriangleMesh holed = make_mesh({}, faces);
  holed.V = mesh.V;
  CHECK(repaired(holed).hole_count == 2);
  RepairOptions options;
  options.fill_holes_up_to_edges = 5;
  CHECK(repaired(holed, options).hole_count == 1);
  options.fill_holes_up_to_edges = 20;
  const RepairedMesh result = repaired(holed, options);
  expect_sound(holed, result);
  CHECK(result.closed());
  CHECK_THAT(signed_volume(result.mesh), WithinAbs(volume, 0.02 * volume));
  CHECK(said(result).find("Filled 2 holes with 7 triangles.") != std::string::npos);
  CHECK(std::count(result.face_of.begin(), result.face_of.end(), -1) == 7);
  // A tube's ends close to a solid cylinder; the rim of a flat sheet does not close onto the sheet.
  options.fill_holes_up_to_edges = 30;
  CHECK(repaired(tube(24, 2), options).closed());
  CHECK_FALSE(repaired(grid(3, 3), options).closed());
}

}  // namespace
}  // namespace formwright
