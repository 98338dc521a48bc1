// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/plan/tape_template.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "base/error.h"
#include "zippable/plan/planned.h"

namespace formwright {
namespace {

TEST(TapeRuns, OfAStripCutOnce) {
  Context context;
  PlanOptions options;
  options.bed_x_mm = options.bed_y_mm = 150;
  const ZippablePlan plan = plan_zippable(test::strip(200, 20, 41), options, context);
  ASSERT_EQ(plan.splitting.splits.size(), 1u);
  ASSERT_EQ(plan.runs.size(), 4u);
  for (std::size_t side = 0; side < 2; ++side) {
    const TapeRun &a = plan.runs[2 * side], &b = plan.runs[2 * side + 1];
    EXPECT_EQ(a.left, side == 0);
    EXPECT_EQ(b.left, side == 0);
    EXPECT_NE(a.piece, b.piece);
    EXPECT_EQ(a.from_mm, 0);
    EXPECT_EQ(a.to_mm, b.from_mm);
    EXPECT_NEAR(b.to_mm, 200, 1e-12);
    EXPECT_EQ(a.splits, "");
    EXPECT_EQ(b.splits, "A");
    EXPECT_NEAR(a.cloth_mm, a.tape_mm(), 1e-9);  // a straight edge moves without a change of length
    EXPECT_EQ(a.first_marker, 0);
    EXPECT_EQ(a.last_marker, static_cast<int>(std::floor(a.to_mm / 30 + 1e-12)));
    EXPECT_EQ(b.first_marker, a.last_marker + 1);
    EXPECT_EQ(b.last_marker, 6);
  }
  EXPECT_EQ(plan.runs[0].piece, plan.runs[2].piece);
}

TEST(TapeRuns, CoverBothSidesOnceAndAgreeWithTheCloth) {
  Context context;
  for (const char* sample : {"star", "octopus"}) {
    const FlatDesign design = test::designed(sample, 20);
    PlanOptions options;
    options.bed_x_mm = options.bed_y_mm = 250;
    const ZippablePlan plan = plan_zippable(design, options, context);
    double tape_mm[2] = {0, 0}, cloth_mm[2] = {0, 0};
    int marks[2] = {0, 0};
    for (const TapeRun& run : plan.runs) {
      tape_mm[run.left] += run.tape_mm(), cloth_mm[run.left] += run.cloth_mm,
          marks[run.left] += run.last_marker - run.first_marker + 1;
      // What the tape says of its markers is where the cloth has them.
      for (int m = run.first_marker; m <= run.last_marker; ++m) {
        const std::string name = "marker-" + std::to_string(m) + (run.left ? "-left" : "-right");
        int found = 0;
        for (const CutPath& path : plan.pieces.pieces[run.piece].marks) found += path.name == name;
        EXPECT_EQ(found, 1) << sample << ' ' << name;
      }
    }
    for (const int side : {0, 1}) {
      EXPECT_NEAR(tape_mm[side], design.zipper_mm, 1e-9 * design.zipper_mm);
      EXPECT_EQ(marks[side], static_cast<int>(plan.markers.markers.size()));
    }
    EXPECT_NEAR(cloth_mm[1], plan.ribbon.left_mm, 1e-9 * design.zipper_mm);
    EXPECT_NEAR(cloth_mm[0], plan.ribbon.right_mm, 1e-9 * design.zipper_mm);
  }
}

TEST(TapeTemplate, MarksStandAtTheirArclength) {
  const FlatDesign design = test::strip(1000, 40, 101);
  Context context;
  for (const double spacing_mm : {30.0, 47.0, 400.0}) {
    PlanOptions options;
    options.marker_spacing_mm = spacing_mm;
    options.bed_x_mm = 1200;
    const ZippablePlan plan = plan_zippable(design, options, context);
    EXPECT_LE(plan.tape.row_mm, 297 - 20);
    EXPECT_EQ(plan.tape.rows, static_cast<int>(std::ceil(1000 / plan.tape.row_mm)));
    // Rows put end to end: every strip's length counts, and every mark stands at its number times the spacing.
    std::map<std::string, double> row_from;
    double from = 0;
    int marks = 0;
    for (const CutSheet& sheet : plan.tape.sheets) {
      double row_left = 0, row_right = 0, left_edge = 0;
      for (const CutPath& path : sheet.paths) {
        for (const Vec2& p : path.points_mm) {
          EXPECT_GE(p.minCoeff(), 9);
          EXPECT_LE(p.x(), sheet.width_mm - 9);
          EXPECT_LE(p.y(), sheet.height_mm - 9);
        }
        if (path.name.starts_with("row-") && path.name.ends_with("-left")) {
          left_edge = path.points_mm[0].x(), row_left = from, from += path.points_mm[1].x() - left_edge;
          EXPECT_NEAR(std::abs(path.points_mm[2].y() - path.points_mm[1].y()), plan.zipper.tape_width_mm, 1e-9);
        } else if (path.name.starts_with("row-")) {
          row_right = row_left;
        } else if (path.name.starts_with("tape-")) {
          const double begin = path.name.ends_with("-left") ? row_left : row_right;
          EXPECT_NEAR(begin + path.points_mm[0].x() - left_edge, spacing_mm * std::stoi(path.name.substr(5)), 1e-9)
              << path.name;
          ++marks;
        } else if (path.name == "scale-100") {
          EXPECT_NEAR((path.points_mm[1] - path.points_mm[0]).norm(), 100, 1e-12);
        }
      }
    }
    EXPECT_NEAR(from, 1000, 1e-9);
    EXPECT_EQ(marks, 2 * static_cast<int>(plan.markers.markers.size()));
  }
}

TEST(TapeTemplate, PaperNeedsNoneAndTooWideATapeIsRefused) {
  const FlatDesign design = test::strip(200, 20, 21);
  Context context;
  PlanOptions options;
  options.coil = ZipperCoil::none;
  EXPECT_TRUE(plan_zippable(design, options, context).tape.sheets.empty());
  options.tape_width_mm = 90;
  try {
    plan_zippable(design, options, context);
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.where(), "tape_width_mm");
  }
}

}  // namespace
}  // namespace formwright
