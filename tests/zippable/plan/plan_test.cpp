// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "base/error.h"
#include "base/json.h"
#include "zippable/plan/planned.h"

namespace formwright {
namespace {

TEST(Markers, StandAtTheirMultiplesOnBothSides) {
  const FlatDesign design = test::strip(200, 20, 33);
  const OffsetRibbon ribbon = offset_ribbon(design, ZipperOffset::sewing, 3);
  const Markers markers = place_markers(design, ribbon, 30);
  ASSERT_EQ(markers.markers.size(), 7u);
  for (const Marker& marker : markers.markers) {
    EXPECT_EQ(marker.arclength_mm, 30.0 * marker.number);
    EXPECT_LT((marker.left.flat_mm - Vec2(marker.arclength_mm, 3)).norm(), 1e-9);
    EXPECT_LT((marker.right.flat_mm - Vec2(marker.arclength_mm, 17)).norm(), 1e-9);
    EXPECT_LT((marker.left.inward - Vec2(0, 1)).norm(), 1e-9);
    EXPECT_LT((marker.right.inward - Vec2(0, -1)).norm(), 1e-9);
  }
  ASSERT_EQ(markers.intervals.size(), 7u);
  EXPECT_NEAR(markers.intervals.back().zipper_mm, 20, 1e-9);
}

TEST(Markers, IntervalsSumUpToTheSides) {
  const FlatDesign design = test::designed("octopus", 20);
  const OffsetRibbon ribbon = offset_ribbon(design, ZipperOffset::gluing, 2.9);
  const Markers markers = place_markers(design, ribbon, 30);
  MarkerInterval sum;
  for (const MarkerInterval& i : markers.intervals)
    sum.zipper_mm += i.zipper_mm, sum.left_mm += i.left_mm, sum.right_mm += i.right_mm;
  EXPECT_NEAR(sum.zipper_mm, design.zipper_mm, 1e-8);
  EXPECT_NEAR(sum.left_mm, ribbon.left_mm, 1e-8);
  EXPECT_NEAR(sum.right_mm, ribbon.right_mm, 1e-8);
}

TEST(Markers, OfPaperMeetInSpace) {
  // Without offset both marks of a number are one place of the zipper: equally long on both sides between markers.
  const FlatDesign design = test::designed("star", 20);
  const Markers markers = place_markers(design, offset_ribbon(design, ZipperOffset::sewing, 0), 30);
  for (const MarkerInterval& interval : markers.intervals) {
    EXPECT_NEAR(interval.left_mm, interval.zipper_mm, 1e-6 * interval.zipper_mm + 1e-9);
    EXPECT_NEAR(interval.right_mm, interval.zipper_mm, 1e-6 * interval.zipper_mm + 1e-9);
  }
}

TEST(Plan, EverythingIsThereOnceAndInsideItsSheet) {
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
        EXPECT_GE(signed_area_mm2(piece.outline_mm), piece.ribbon_area_mm2 - 1e-6);
        EXPECT_GT(signed_area_mm2(piece.cut_mm), signed_area_mm2(piece.outline_mm));
      }
      EXPECT_NEAR(area, plan.area_before_mm2, 1e-9 * area) << sample;
      std::multiset<std::string> names;
      for (const CutSheet& sheet : plan.sheets)
        for (const CutPath& path : sheet.paths) {
          if (!path.name.empty()) names.insert(path.name);
          for (const Vec2& p : path.points_mm) {
            EXPECT_GE(p.minCoeff(), 0) << path.name;
            EXPECT_LE(p.maxCoeff(), bed_mm) << path.name;
          }
        }
      for (const Marker& marker : plan.markers.markers)
        for (const char* side : {"-left", "-right"})
          EXPECT_EQ(names.count("marker-" + std::to_string(marker.number) + side), 1u);
      for (std::size_t s = 0; s < plan.splitting.splits.size(); ++s) {
        const auto from = names.lower_bound("split-" + split_letters(static_cast<int>(s)) + "-"),
                   to = names.lower_bound("split-" + split_letters(static_cast<int>(s)) + ".");
        EXPECT_EQ(std::distance(from, to), 2) << sample << ' ' << s;
      }
    }
  }
}

TEST(Plan, KerfMovesTheCutByHalf) {
  // A rectangle of 14 by 200 mm is cut along one that is wider by the kerf on the whole.
  Context context;
  PlanOptions options;
  options.kerf_mm = 0.4;
  const ZippablePlan plan = plan_zippable(test::strip(200, 20, 41), options, context);
  ASSERT_EQ(plan.pieces.pieces.size(), 1u);
  const double width = 20 - 2 * plan.zipper.offset_mm();
  EXPECT_NEAR(signed_area_mm2(plan.pieces.pieces[0].outline_mm), 200 * width, 1e-6);
  EXPECT_NEAR(signed_area_mm2(plan.pieces.pieces[0].cut_mm), 200.4 * (width + 0.4), 1e-6);
}

TEST(Plan, AllowancesAreAddedOnBothSidesOfASplit) {
  Context context;
  PlanOptions options;
  options.bed_x_mm = 150, options.bed_y_mm = 150, options.kerf_mm = 0;
  options.seam_allowance_mm = 3;
  const ZippablePlan plan = plan_zippable(test::strip(200, 20, 41), options, context);
  ASSERT_EQ(plan.splitting.splits.size(), 1u);
  EXPECT_EQ(plan.pieces.shortened_allowances, 0);
  double outlines = 0;
  for (const PlanPiece& piece : plan.pieces.pieces) outlines += signed_area_mm2(piece.outline_mm);
  const auto& split = plan.splitting.splits[0];
  const double edge = (plan.ribbon.flat_mm[split.from] - plan.ribbon.flat_mm[split.to]).norm();
  EXPECT_NEAR(outlines - plan.area_before_mm2, 2 * 3 * (edge - 3), 1e-9);  // two trapezia with sides at 45 degrees
}

TEST(Plan, TheSamePlanTwice) {
  const FlatDesign design = test::designed("star", 20);
  Context context;
  const ZippablePlan a = plan_zippable(design, {}, context), b = plan_zippable(design, {}, context);
  EXPECT_EQ(write_svg(side_by_side(a.sheets, 20)), write_svg(side_by_side(b.sheets, 20)));
}

TEST(Plan, LettersGoOnAfterZ) {
  EXPECT_EQ(split_letters(0), "A");
  EXPECT_EQ(split_letters(25), "Z");
  EXPECT_EQ(split_letters(26), "AA");
  EXPECT_EQ(split_letters(701), "ZZ");
  EXPECT_EQ(split_letters(702), "AAA");
}

TEST(FlatDesign, WrongFilesAreRefusedByName) {
  const auto message = [](const std::string& text) -> std::string {
    try {
      read_flat_design(as_bytes(text));
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::invalid_input);
      EXPECT_EQ(error.where(), "design");
      return error.what();
    }
    return "accepted";
  };
  for (
      const char* text :
      {"", "[]", "{}", R"({"format":"formwright zippable design","version":1})",
       R"({"format":"formwright zippable design","version":1,"pieces":[],"ribbon":{"boundary":[1,2,3],"triangles":[]}})"})
    EXPECT_NE(message(text).find("design.json"), std::string::npos) << text;
}

}  // namespace
}  // namespace formwright
