// SPDX-License-Identifier: GPL-3.0-or-later
// Plans that make up for what goes wrong when they are cut and sewn.
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <cmath>

#include "base/error.h"
#include "fabrication/planar/polygon.h"
#include "zippable/plan/planned.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;
using test::planned;

const FlatDesign& star() {
  static const FlatDesign design = test::designed("star", 25, 200);
  return design;
}

/// Of all outlines to cut, as `change` leaves them.
double cut_area_mm2(const ZippablePlan& plan, const Eigen::Matrix2d& change) {
  double area = 0;
  for (const CutSheet& sheet : plan.sheets)
    for (const CutPath& path : sheet.paths)
      if (path.layer == CutLayer::cut && path.closed) {
        Polygon outline = path.points_mm;
        for (Vec2& point : outline) point = change * point;
        area += std::abs(signed_area_mm2(outline));
      }
  return area;
}

TEST_CASE("PlanCorrection.ClothThatChangesOnceItIsCutEndsAsItWasDesigned") {
  PlanOptions options;
  options.kerf_mm = 0;
  const double wanted = cut_area_mm2(planned(star(), options), Eigen::Matrix2d::Identity());
  for (const auto& errors : std::vector<MakingErrors>{{.plan_scale = 0.03},
                                                      {.cloth_stretch_along = 0.05, .cloth_stretch_across = -0.04},
                                                      {.cloth_stretch_along = -0.02, .cloth_bias = 0.05},
                                                      {.cloth_bias = -0.05}}) {
    static_cast<MakingErrors&>(options) = errors;
    const ZippablePlan plan = planned(star(), options);
    CHECK_THAT(cut_area_mm2(plan, errors.cloth_change()), WithinRel(wanted, 1e-9));
    for (const CutSheet& sheet : plan.sheets) {
      CHECK(sheet.width_mm == options.bed_x_mm);
      CHECK(sheet.height_mm == options.bed_y_mm);
      for (const CutPath& path : sheet.paths)
        for (const Vec2& point : path.points_mm)
          CHECK((point.x() >= -1e-9 && point.y() >= -1e-9 && point.x() <= sheet.width_mm + 1e-9 &&
                 point.y() <= sheet.height_mm + 1e-9));
    }
    CHECK(plan.notes.back().starts_with("The plan makes up for: "));
  }
}

TEST_CASE("PlanCorrection.EdgesMoveByHalfOfTheGapAndByWhatSeamsTake") {
  PlanOptions options;
  const double usual = planned(star(), options).edges_moved_mm;
  options.more_gap_mm = 1;
  CHECK_THAT(planned(star(), options).edges_moved_mm, WithinAbs(usual + 0.5, 1e-12));
  options.seam_take_up_mm = 0.75;
  CHECK_THAT(planned(star(), options).edges_moved_mm, WithinAbs(usual - 0.25, 1e-12));
}

TEST_CASE("PlanCorrection.KerfIsAllThatIsCutAway") {
  PlanOptions options;
  options.more_kerf_mm = 0.4;
  CHECK_THAT(planned(star(), options).sheets.front().kerf_mm, WithinAbs(options.kerf_mm + 0.4, 1e-12));
  options.more_kerf_mm = -1;  // no cut adds cloth
  CHECK(planned(star(), options).sheets.front().kerf_mm == 0);
}

TEST_CASE("PlanCorrection.WhatSeamsTakeWithoutAZipperMovesEdgesOutwards") {
  PlanOptions options;
  options.coil = ZipperCoil::none;
  const double usual = planned(star(), options).area_before_mm2;
  options.seam_take_up_mm = 2;
  const ZippablePlan plan = planned(star(), options);
  // Two edges of 2 mm along the whole zipper, corners aside.
  CHECK_THAT(plan.area_before_mm2 - usual, WithinRel(2 * 2 * star().zipper_mm, 0.03));
  options.method = ZipperOffset::gluing;
  CHECK_THROWS_AS(planned(star(), options), Error);
}

TEST_CASE("PlanCorrection.ARecordIsReadAsItWasWrittenAndRefusedForAnotherDesign") {
  const ZippablePlan plan = planned(star(), {});
  const PlanRecord record = record_of(star(), plan);
  const auto triangles = static_cast<std::size_t>(star().F.rows());
  REQUIRE(record.turn_of_triangle_rad.size() == triangles);
  const PlanRecord read = read_plan_record(to_bytes(write_plan_record(record)), triangles, "plan");
  CHECK(read.marker_spacing_mm == 30);
  for (std::size_t f = 0; f < triangles; ++f)
    CHECK_THAT(read.turn_of_triangle_rad[f], WithinAbs(record.turn_of_triangle_rad[f], 1e-12));
  // A piece's first edge lies on its sheet as its turn says.
  const PlanPiece& piece = plan.pieces.pieces.front();
  const Vec2 flat = piece.cut_mm[1] - piece.cut_mm[0],
             laid = plan.nesting.places.front()(piece.cut_mm[1]) - plan.nesting.places.front()(piece.cut_mm[0]);
  std::size_t of_piece = 0;
  while (plan.splitting.piece_of_face[of_piece] != 0) ++of_piece;
  CHECK((Eigen::Rotation2Dd(read.turn_of_triangle_rad[of_piece]) * flat - laid).norm() < 1e-9);
  for (const char* wrong : {"{}", "[]", R"({"format":"formwright zippable plan","version":1,"marker_spacing_mm":0})"})
    CHECK_THROWS_AS(read_plan_record(to_bytes(wrong), triangles, "plan"), Error);
  CHECK_THROWS_AS(read_plan_record(to_bytes(write_plan_record(record)), triangles + 1, "plan"), Error);
}

}  // namespace
}  // namespace formwright
