// SPDX-License-Identifier: GPL-3.0-or-later
// A strip drawn over a round bar: along the arc that touches, what slides loses its tension as Euler and Eytelwein say.
#include "thermoform/contact/sheet_friction.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <cmath>

#include "thermoform/contact/point_contacts.h"
#include "thermoform/strip_over_bar.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;

TEST_CASE("SheetFriction.tension_over_a_bar_falls_as_euler_and_eytelwein_say") {
  for (const double friction : {0.05, 0.1, 0.25, 0.5})
    for (const int columns : {20, 40, 80}) {
      const StripOverBar drawn = draw_over_bar(friction, columns, 0.5);
      INFO(friction << ", " << columns << " columns, over " << drawn.wrap << " rad: " << drawn.tension_ratio);
      CHECK(drawn.wrap > 0.7);
      CHECK_THAT(drawn.tension_ratio, WithinRel(std::exp(-friction * drawn.wrap), 0.06));
    }
}

TEST_CASE("SheetFriction.steps_do_not_matter") {
  for (const double step_mm : {1.0, 0.25, 0.125}) {
    INFO(step_mm);
    CHECK_THAT(draw_over_bar(0.25, 40, step_mm).tension_ratio,
               WithinAbs(draw_over_bar(0.25, 40, 0.5).tension_ratio, 0.015));
  }
}

TEST_CASE("SheetFriction.nothing_is_driven_back_by_its_drag") {
  CHECK(drag_of(3, 0).force == 3);
  CHECK(drag_of(3, 5).force == 3);
  CHECK(drag_of(3, -5).force == -3);
  const double between = -0.012, h = 1e-6;
  CHECK_THAT((drag_of(3, between + h).force - drag_of(3, between - h).force) / (2 * h),
             WithinRel(drag_of(3, between).stiffness, 1e-6));
}

/// One triangle in the plane z = 0, not clamped.
SheetMesh one_triangle() {
  SheetMesh sheet;
  sheet.flat_mm.resize(3, 2);
  sheet.flat_mm << 0, 0, 6, 0, 0, 6;
  sheet.F.resize(1, 3);
  sheet.F << 0, 1, 2;
  sheet.clamped.assign(3, 0);
  return sheet;
}

TEST_CASE("SheetFriction.corners_carry_a_triangle_where_all_touch_and_lean_alike") {
  const SheetMesh sheet = one_triangle();
  SheetFriction friction(sheet, 0.5, 1);
  const HeldVertices touching(3, stuck);
  CHECK(friction.carried_by_corners(sheet.F, 0, touching));
  friction.normal(1) = Vec3(0.6, 0, 0.8);
  CHECK(friction.carried_by_corners(sheet.F, 0, {stuck, sliding, stuck}));
  CHECK_FALSE(friction.carried_by_corners(sheet.F, 0, {stuck, moves_freely, stuck}));
  friction.normal(1) = Vec3(0.96, 0, 0.28);  // over an edge
  CHECK_FALSE(friction.carried_by_corners(sheet.F, 0, touching));
  SheetMesh at_the_rim = sheet;
  at_the_rim.clamped[2] = 1;
  CHECK_FALSE(SheetFriction(at_the_rim, 0.5, 1).carried_by_corners(sheet.F, 0, touching));
}

TEST_CASE("PointContacts.what_slides_under_a_carried_face_is_let_go") {
  const SheetMesh sheet = one_triangle();
  PointContacts points({Vec3(2, 2, 0)}, 6, 10);
  Positions from(3, 3), to(3, 3);
  from << 0, 0, 2, 6, 0, 2, 0, 6, 2;
  to << 0, 0, 0.4, 6, 0, 0.4, 0, 6, 0.4;
  const std::vector<double> radius_mm(1, 0.5);
  REQUIRE(points.find(sheet.F, from, to, radius_mm, HeldVertices(3, moves_freely), 0.01, [](int) { return 0.0; }) == 1);
  // Pressed on by 0.1 mm and drawn 0.02 mm aside: along the face a fifth of what presses.
  to.col(0).array() += 0.02;
  const auto carried = [](int) { return true; };
  points.let_go(sheet.F, to, 0.3, carried);
  points.let_go(sheet.F, to, 0.1, [](int) { return false; });
  CHECK(points.contacts().size() == 1);
  points.let_go(sheet.F, to, 0.1, carried);
  CHECK(points.contacts().empty());
}

TEST_CASE("SheetFriction.points_reach_into_triangles_only_where_the_sheet_slides") {
  CHECK(point_reach(0).sharp_edges == 0);
  CHECK(point_reach(1e-9).rounded_edges == 0);
  for (double slip = 0; slip < 1; slip += 0.001) {
    CHECK(point_reach(slip + 0.001).rounded_edges - point_reach(slip).rounded_edges <= 1e-3);
    CHECK(point_reach(slip + 0.001).sharp_edges >= point_reach(slip).sharp_edges);
  }
  CHECK(point_reach(20).rounded_edges == point_reach(0.25).rounded_edges);
}

}  // namespace
}  // namespace formwright
