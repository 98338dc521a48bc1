// SPDX-License-Identifier: GPL-3.0-or-later
#include "thermoform/mould/draft_map.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "geometry/booleans/booleans.h"
#include "geometry/mesh/measures.h"
#include "geometry/test_meshes.h"
#include "thermoform/mould/solid_shapes.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinULP;

constexpr int cells = 256;

bool says(const DraftMap& map, const std::string& words) {
  return std::ranges::any_of(map.sentences,
                             [&](const std::string& sentence) { return sentence.find(words) != std::string::npos; });
}

/// A frustum of many sides whose walls lean by `draft_deg` exactly: their middles, not their corners, lie on the cone.
TriangleMesh frustum(double draft_deg, double radius_mm, double height_mm) {
  const double less = height_mm * std::tan(draft_deg * std::numbers::pi / 180),
               corner = 1 / std::cos(std::numbers::pi / 32);
  return turned_mesh(Vec3::Zero(), 2, {{0, radius_mm * corner}, {height_mm, (radius_mm - less) * corner}}, 32);
}

/// Of the flat top.
double floor_area(const DraftMap& map) {
  const Eigen::VectorXd areas = face_areas(map.mesh);
  double area = 0;
  for (Eigen::Index f = 0; f < areas.size(); ++f)
    if (map.face_draft_deg[f] > 89) area += areas[f];
  return area;
}

TEST_CASE("DraftMap.ConesOfKnownAngle") {
  Context context;
  for (const double draft : {45.0, 10.0, 3.5, 2.0, 0.0, -5.0, -20.0}) {
    CAPTURE(draft);
    const DraftMap map = draft_map(frustum(draft, 30, 20), 1, cells, context);
    CHECK_THAT(map.draft_min_deg, WithinAbs(draft, 1e-10));
    const double wall = map.area_mm2 - floor_area(map);
    CHECK_THAT(map.below_3_deg_area_mm2, WithinAbs(draft < 3 ? wall : 0, 1e-9 * wall));
    CHECK_THAT(map.undercut_area_mm2, WithinAbs(draft < 0 ? wall : 0, 1e-9 * wall));
    CHECK(says(map, "The right side leans in by " + std::to_string(static_cast<int>(-draft)) + " degrees") ==
          (draft < 0));
    CHECK(says(map, "will lift off easily.") == (draft > 3));
    CHECK(says(map, "hard to lift off") == (draft >= 0 && draft < 3));
    CHECK(map.depth_to_width_max == 0);
  }
}

// The lower half of a sphere hangs over. Faces count as a whole, so the error of the area falls with the edge length.
TEST_CASE("DraftMap.UndercutOfASphereConverges") {
  Context context;
  double last = 0;
  for (const int level : {2, 3, 4, 5}) {
    const DraftMap map = draft_map(test::moved(test::icosphere(level), {0, 0, 11}, 10), 1, 64, context);
    const double exact = 2 * std::numbers::pi * 100, error = std::abs(map.undercut_area_mm2 - exact);
    CHECK_THAT(map.area_mm2, WithinAbs(2 * exact, std::pow(0.25, level) * exact));
    if (last > 0) {
      CHECK(error < last / 1.8);
    }
    last = error;
  }
  CHECK(last < 0.01 * 2 * std::numbers::pi * 100);
}

TEST_CASE("DraftMap.AFloorUnderABridgeIsHidden") {
  Context context;
  // A table: top 40 x 20 x 2 on two walls, over a floor that is part of the model.
  ExactSolid table = ExactSolid::from_mesh(box_mesh({-20, -10, 0}, {20, 10, 20}), "mesh", context);
  table = subtract(table, ExactSolid::from_mesh(box_mesh({-15, -11, 5}, {15, 11, 18}), "mesh", context), context);
  const DraftMap map = draft_map(table.mesh(), 1, cells, context);
  // The floor, the ceiling, and the inner walls below it.
  CHECK_THAT(map.undercut_area_mm2, WithinAbs(2 * 30 * 20 + 2 * 13 * 20, 1e-9));
  CHECK_THAT(map.draft_min_deg, WithinULP(-90.0, 4));
  CHECK(says(map, "6.0 cm² face down"));
}

TEST_CASE("DraftMap.DepthToWidthOfSlotsAndWells") {
  Context context;
  const ExactSolid block = ExactSolid::from_mesh(box_mesh({-30, -30, 0}, {30, 30, 30}), "mesh", context);
  for (const auto& [width, depth] : {std::pair{10.0, 5.0}, std::pair{10.0, 20.0}, std::pair{5.0, 20.0}}) {
    CAPTURE(width);
    const ExactSolid slot =
        ExactSolid::from_mesh(box_mesh({-width / 2, -31, 30 - depth}, {width / 2, 31, 31}), "mesh", context);
    const double pitch = 60.0 / cells;
    const double found = draft_map(subtract(block, slot, context).mesh(), 1, cells, context).depth_to_width_max;
    CHECK_THAT(found, WithinAbs(depth / width, depth / width * 1.5 * pitch / width));
  }
  // Narrower than the sheet is thick: nothing goes in.
  const ExactSolid slit = ExactSolid::from_mesh(box_mesh({-0.5, -31, 10}, {0.5, 31, 31}), "mesh", context);
  CHECK(draft_map(subtract(block, slit, context).mesh(), 0.1, cells, context).depth_to_width_max > 10);
  CHECK(draft_map(subtract(block, slit, context).mesh(), 3, cells, context).depth_to_width_max == 0);
}

TEST_CASE("DraftMap.HeightsByRays") {
  Context context;
  const HeightGrid grid = height_grid(box_mesh({-10, -5, 0}, {10, 5, 7}), 40, context);
  CHECK(grid.columns == 40);
  CHECK(grid.rows == 20);
  for (const double height : grid.height_mm) CHECK_THAT(height, WithinAbs(7, 1e-12));
  CHECK_THAT(grid.min_around(0, 0), WithinAbs(7, 1e-12));
  CHECK(grid.min_around(11, 0) == 0);
}

TEST_CASE("DraftMap.Cancels") {
  Host host;
  host.cancel_requested = [] { return true; };
  Context context(host);
  CHECK_THROWS_AS(draft_map(frustum(5, 30, 20), 1, cells, context), Error);
}

}  // namespace
}  // namespace formwright
