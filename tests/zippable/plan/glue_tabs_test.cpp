// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/plan/pieces/glue_tabs.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <cmath>
#include <numbers>

#include "base/error.h"
#include "zippable/plan/planned.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

PlanOptions paper() {
  PlanOptions options;
  options.coil = ZipperCoil::none;
  options.edges = PaperEdges::tabs;
  options.kerf_mm = 0;
  return options;
}

TEST_CASE("GlueTabs.OfAStripAreTrapezesOnItsLeftEdge") {
  Context context;
  const ZippablePlan plan = plan_zippable(test::strip(200, 20, 41), paper(), context);
  REQUIRE(plan.tabs);
  REQUIRE(plan.tabs->tabs.size() == 14u);  // 200 / 15, rounded up
  const double length = 200.0 / 14;
  for (int i = 0; i < 14; ++i) {
    const GlueTab& tab = plan.tabs->tabs[std::size_t(i)];
    CHECK(tab.left);
    CHECK((tab.foot_from - Vec2(i * length, 0)).norm() < 1e-6);
    CHECK((tab.corner_from - Vec2(i * length + length / 4, -5)).norm() < 1e-6);
    CHECK((tab.corner_to - Vec2((i + 1) * length - length / 4, -5)).norm() < 1e-6);
  }
  CHECK(plan.tabs->shortened + plan.tabs->left_out == 0);
  CHECK_THAT(signed_area_mm2(plan.pieces.pieces[0].outline_mm),
             WithinAbs(200 * 20 + 14 * 5 * (length - length / 4), 1e-4));
}

TEST_CASE("GlueTabs.EveryStretchOfTheZipperHasOneTabAtMost") {
  Context context;
  for (const char* sample : {"star", "t_shape", "octopus"}) {
    const FlatDesign design = test::designed(sample, 20);
    const ZippablePlan plan = plan_zippable(design, paper(), context);
    double last = 0, covered = 0;
    for (const GlueTab& tab : plan.tabs->tabs) {
      {
        INFO(sample);
        CHECK(tab.from_mm >= last - 1e-9);
      }
      CHECK(tab.to_mm - tab.from_mm <= 15 + 1e-9);
      // On one piece on its own side, and against one piece on the other.
      for (const TapeRun& run : plan.runs)
        CHECK((run.to_mm <= tab.from_mm + 1e-6 || run.from_mm >= tab.to_mm - 1e-6 ||
               (run.from_mm <= tab.from_mm + 1e-6 && run.to_mm >= tab.to_mm - 1e-6 &&
                (run.left != tab.left || run.piece == tab.piece))));
      last = tab.to_mm, covered += tab.to_mm - tab.from_mm;
    }
    CHECK(last <= design.zipper_mm + 1e-9);
    {
      INFO(sample);
      CHECK(covered > 0.8 * design.zipper_mm);
    }
    // What the tabs add to the outlines, beside what allowances add, is their own area.
    double outlines = 0, tabs = 0;
    for (const PlanPiece& piece : plan.pieces.pieces) outlines += signed_area_mm2(piece.outline_mm);
    for (const GlueTab& tab : plan.tabs->tabs)
      for (const auto& t : triangles_of(tab)) tabs += std::abs(signed_area_mm2({t[0], t[1], t[2]}));
    CHECK(outlines > plan.area_before_mm2 + 0.9 * tabs);
  }
}

TEST_CASE("GlueTabs.GiveWayToTheNextWinding") {
  // A spiral strip of 12 mm whose windings are 4 mm apart: no tab of 5 mm has room between them.
  const double pitch = 16, width = 12;
  FlatDesign design = test::strip(1600, width, 533);
  std::vector<Vec2> flat;
  for (const FlatVertex& v : design.boundary) {
    const double radius = 90, angle = v.flat_mm.x() / radius,
                 r = radius + pitch * angle / (2 * std::numbers::pi) - v.flat_mm.y();
    flat.emplace_back(r * std::cos(angle), r * std::sin(angle));
  }
  Splitting splitting;
  splitting.piece_count = 1;
  splitting.piece_of_face.assign(std::size_t(design.F.rows()), 0);
  Seam seam{SeamKind::edge};
  seam.to_mm = design.zipper_mm;
  const GlueTabOptions options;
  const GlueTabs made = make_glue_tabs(design, flat, splitting, {seam}, options, Context());
  CHECK(made.shortened > 0);
  int full = 0;
  for (const GlueTab& tab : made.tabs) {
    const Vec2 along = (tab.foot_to - tab.foot_from).normalized(), out(along.y(), -along.x());
    full += out.dot(tab.corner_from - tab.foot_from) > 4.9;
    for (Eigen::Index f = 0; f < design.F.rows(); ++f) {
      int nearest = 1000;
      for (int k = 0; k < 3; ++k) nearest = std::min(nearest, std::abs(design.F(f, k) - tab.from_edge));
      if (nearest < 20) continue;
      for (const auto& t : triangles_of(tab))
        CHECK_FALSE(triangles_overlap(t, {flat[design.F(f, 0)], flat[design.F(f, 1)], flat[design.F(f, 2)]},
                                      -0.9 * options.clearance_mm));
    }
  }
  CHECK(full > 0);  // on the first and the last winding, which have one side free
}

TEST_CASE("GlueTabs.AZipperHasNone") {
  Context context;
  PlanOptions options = paper();
  options.coil = ZipperCoil::coil_3;
  try {
    plan_zippable(test::strip(200, 30, 21), options, context);
    FAIL("accepted");
  } catch (const Error& error) {
    CHECK(error.where() == "edges");
  }
}

}  // namespace
}  // namespace formwright
