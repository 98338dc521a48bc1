// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <cmath>
#include <set>

#include "base/error.h"
#include "base/data/json.h"
#include "zippable/plan/planned.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

TEST_CASE("Markers.StandAtTheirMultiplesOnBothSides") {
  const FlatDesign design = test::strip(200, 20, 33);
  const OffsetRibbon ribbon = offset_ribbon(design, ZipperOffset::sewing, 3);
  const Markers markers = place_markers(design, ribbon, 30);
  REQUIRE(markers.markers.size() == 7u);
  for (const Marker& marker : markers.markers) {
    CHECK(marker.arclength_mm == 30.0 * marker.number);
    CHECK((marker.left.flat_mm - Vec2(marker.arclength_mm, 3)).norm() < 1e-9);
    CHECK((marker.right.flat_mm - Vec2(marker.arclength_mm, 17)).norm() < 1e-9);
    CHECK((marker.left.inward - Vec2(0, 1)).norm() < 1e-9);
    CHECK((marker.right.inward - Vec2(0, -1)).norm() < 1e-9);
  }
  REQUIRE(markers.intervals.size() == 7u);
  CHECK_THAT(markers.intervals.back().zipper_mm, WithinAbs(20, 1e-9));
}

TEST_CASE("Markers.IntervalsSumUpToTheSides") {
  const FlatDesign design = test::designed("octopus", 20);
  const OffsetRibbon ribbon = offset_ribbon(design, ZipperOffset::gluing, 2.9);
  const Markers markers = place_markers(design, ribbon, 30);
  MarkerInterval sum;
  for (const MarkerInterval& i : markers.intervals)
    sum.zipper_mm += i.zipper_mm, sum.left_mm += i.left_mm, sum.right_mm += i.right_mm;
  CHECK_THAT(sum.zipper_mm, WithinAbs(design.zipper_mm, 1e-8));
  CHECK_THAT(sum.left_mm, WithinAbs(ribbon.left_mm, 1e-8));
  CHECK_THAT(sum.right_mm, WithinAbs(ribbon.right_mm, 1e-8));
}

TEST_CASE("Markers.OfPaperMeetInSpace") {
  // Without offset both marks of a number are one place of the zipper: equally long on both sides between markers.
  const FlatDesign design = test::designed("star", 20);
  const Markers markers = place_markers(design, offset_ribbon(design, ZipperOffset::sewing, 0), 30);
  for (const MarkerInterval& interval : markers.intervals) {
    CHECK_THAT(interval.left_mm, WithinAbs(interval.zipper_mm, 1e-6 * interval.zipper_mm + 1e-9));
    CHECK_THAT(interval.right_mm, WithinAbs(interval.zipper_mm, 1e-6 * interval.zipper_mm + 1e-9));
  }
}

TEST_CASE("Plan.EverythingIsThereOnceAndInsideItsSheet") {
  for (const char* sample : {"t_shape", "star", "octopus"}) {
    const FlatDesign design = test::designed(sample, 20);
    Context context;
    for (const double bed_mm : {200.0, 400.0}) {
      PlanOptions options;
      options.bed_x_mm = options.bed_y_mm = bed_mm;
      const ZippablePlan plan = plan_zippable(design, options, context);
      double area = 0;
      for (const PlanPiece& piece : plan.pieces.pieces) {
        area += piece.ribbon_area_mm2;
        CHECK(signed_area_mm2(piece.outline_mm) >= piece.ribbon_area_mm2 - 1e-6);
        CHECK(signed_area_mm2(piece.cut_mm) > signed_area_mm2(piece.outline_mm));
      }
      {
        INFO(sample);
        CHECK_THAT(area, WithinAbs(plan.area_before_mm2, 1e-9 * area));
      }
      std::multiset<std::string> names;
      for (const CutSheet& sheet : plan.sheets)
        for (const CutPath& path : sheet.paths) {
          if (!path.name.empty()) names.insert(path.name);
          for (const Vec2& p : path.points_mm) {
            INFO(path.name);
            CHECK(p.minCoeff() >= 0);
            CHECK(p.maxCoeff() <= bed_mm);
          }
        }
      for (const Marker& marker : plan.markers.markers)
        for (const char* side : {"-left", "-right"})
          CHECK(names.count("marker-" + std::to_string(marker.number) + side) == 1u);
      for (std::size_t s = 0; s < plan.splitting.splits.size(); ++s) {
        const auto from = names.lower_bound("split-" + split_letters(static_cast<int>(s)) + "-"),
                   to = names.lower_bound("split-" + split_letters(static_cast<int>(s)) + ".");
        INFO(sample << ' ' << s);
        CHECK(std::distance(from, to) == 2);
      }
    }
  }
}

TEST_CASE("Plan.KerfMovesTheCutByHalf") {
  // A rectangle of 14 by 200 mm is cut along one that is wider by the kerf on the whole.
  Context context;
  PlanOptions options;
  options.kerf_mm = 0.4;
  const ZippablePlan plan = plan_zippable(test::strip(200, 20, 41), options, context);
  REQUIRE(plan.pieces.pieces.size() == 1u);
  const double width = 20 - 2 * plan.zipper.offset_mm();
  CHECK_THAT(signed_area_mm2(plan.pieces.pieces[0].outline_mm), WithinAbs(200 * width, 1e-6));
  CHECK_THAT(signed_area_mm2(plan.pieces.pieces[0].cut_mm), WithinAbs(200.4 * (width + 0.4), 1e-6));
}

TEST_CASE("Plan.AllowancesAreAddedOnBothSidesOfASplit") {
  Context context;
  PlanOptions options;
  options.bed_x_mm = 150, options.bed_y_mm = 150, options.kerf_mm = 0;
  options.seam_allowance_mm = 3;
  const ZippablePlan plan = plan_zippable(test::strip(200, 20, 41), options, context);
  REQUIRE(plan.splitting.splits.size() == 1u);
  CHECK(plan.pieces.shortened_allowances == 0);
  double outlines = 0;
  for (const PlanPiece& piece : plan.pieces.pieces) outlines += signed_area_mm2(piece.outline_mm);
  const auto& split = plan.splitting.splits[0];
  const double edge = (plan.ribbon.flat_mm[split.from] - plan.ribbon.flat_mm[split.to]).norm();
  CHECK_THAT(outlines - plan.area_before_mm2,
             WithinAbs(2 * 3 * (edge - 3), 1e-9));  // two trapezia with sides at 45 degrees
}

TEST_CASE("Plan.TheSamePlanTwice") {
  const FlatDesign design = test::designed("star", 20);
  Context context;
  const ZippablePlan a = plan_zippable(design, {}, context), b = plan_zippable(design, {}, context);
  CHECK(write_svg(side_by_side(a.sheets, 20)) == write_svg(side_by_side(b.sheets, 20)));
}

TEST_CASE("Plan.LettersGoOnAfterZ") {
  CHECK(split_letters(0) == "A");
  CHECK(split_letters(25) == "Z");
  CHECK(split_letters(26) == "AA");
  CHECK(split_letters(701) == "ZZ");
  CHECK(split_letters(702) == "AAA");
}

TEST_CASE("FlatDesign.WrongFilesAreRefusedByName") {
  const auto message = [](const std::string& text) -> std::string {
    try {
      read_flat_design(as_bytes(text));
    } catch (const Error& error) {
      CHECK(error.code() == ErrorCode::invalid_input);
      CHECK(error.where() == "design");
      return error.what();
    }
    return "accepted";
  };
  for (
      const char* text :
      {"", "[]", "{}", R"({"format":"formwright zippable design","version":1})",
       R"({"format":"formwright zippable design","version":1,"pieces":[],"ribbon":{"boundary":[1,2,3],"triangles":[]}})"}) {
    INFO(text);
    CHECK(message(text).find("design.json") != std::string::npos);
  }
}

}  // namespace
}  // namespace formwright
