// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/plan/tape_template.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <cmath>
#include <map>

#include "base/error.h"
#include "zippable/plan/planned.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

TEST_CASE("TapeRuns.OfAStripCutOnce") {
  Context context;
  PlanOptions options;
  options.bed_x_mm = options.bed_y_mm = 150;
  const ZippablePlan plan = plan_zippable(test::strip(200, 20, 41), options, context);
  REQUIRE(plan.splitting.splits.size() == 1u);
  REQUIRE(plan.runs.size() == 4u);
  for (std::size_t side = 0; side < 2; ++side) {
    const TapeRun &a = plan.runs[2 * side], &b = plan.runs[2 * side + 1];
    CHECK(a.left == (side == 0));
    CHECK(b.left == (side == 0));
    CHECK(a.piece != b.piece);
    CHECK(a.from_mm == 0);
    CHECK(a.to_mm == b.from_mm);
    CHECK_THAT(b.to_mm, WithinAbs(200, 1e-12));
    CHECK(a.splits == "");
    CHECK(b.splits == "A");
    CHECK_THAT(a.cloth_mm, WithinAbs(a.tape_mm(), 1e-9));  // a straight edge moves without a change of length
    CHECK(a.first_marker == 0);
    CHECK(a.last_marker == static_cast<int>(std::floor(a.to_mm / 30 + 1e-12)));
    CHECK(b.first_marker == a.last_marker + 1);
    CHECK(b.last_marker == 6);
  }
  CHECK(plan.runs[0].piece == plan.runs[2].piece);
}

TEST_CASE("TapeRuns.CoverBothSidesOnceAndAgreeWithTheCloth") {
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
        INFO(sample << ' ' << name);
        CHECK(found == 1);
      }
    }
    for (const int side : {0, 1}) {
      CHECK_THAT(tape_mm[side], WithinAbs(design.zipper_mm, 1e-9 * design.zipper_mm));
      CHECK(marks[side] == static_cast<int>(plan.markers.markers.size()));
    }
    CHECK_THAT(cloth_mm[1], WithinAbs(plan.ribbon.left_mm, 1e-9 * design.zipper_mm));
    CHECK_THAT(cloth_mm[0], WithinAbs(plan.ribbon.right_mm, 1e-9 * design.zipper_mm));
  }
}

TEST_CASE("TapeTemplate.MarksStandAtTheirArclength") {
  const FlatDesign design = test::strip(1000, 40, 101);
  Context context;
  for (const double spacing_mm : {30.0, 47.0, 400.0}) {
    PlanOptions options;
    options.marker_spacing_mm = spacing_mm;
    options.bed_x_mm = 1200;
    const ZippablePlan plan = plan_zippable(design, options, context);
    CHECK(plan.tape.row_mm <= 297 - 20);
    CHECK(plan.tape.rows == static_cast<int>(std::ceil(1000 / plan.tape.row_mm)));
    // Rows put end to end: every strip's length counts, and every mark stands at its number times the spacing.
    std::map<std::string, double> row_from;
    double from = 0;
    int marks = 0;
    for (const CutSheet& sheet : plan.tape.sheets) {
      double row_left = 0, row_right = 0, left_edge = 0;
      for (const CutPath& path : sheet.paths) {
        for (const Vec2& p : path.points_mm) {
          CHECK(p.minCoeff() >= 9);
          CHECK(p.x() <= sheet.width_mm - 9);
          CHECK(p.y() <= sheet.height_mm - 9);
        }
        if (path.name.starts_with("row-") && path.name.ends_with("-left")) {
          left_edge = path.points_mm[0].x(), row_left = from, from += path.points_mm[1].x() - left_edge;
          CHECK_THAT(std::abs(path.points_mm[2].y() - path.points_mm[1].y()),
                     WithinAbs(plan.zipper.tape_width_mm, 1e-9));
        } else if (path.name.starts_with("row-")) {
          row_right = row_left;
        } else if (path.name.starts_with("tape-")) {
          const double begin = path.name.ends_with("-left") ? row_left : row_right;
          {
            INFO(path.name);
            CHECK_THAT(begin + path.points_mm[0].x() - left_edge,
                       WithinAbs(spacing_mm * std::stoi(path.name.substr(5)), 1e-9));
          }
          ++marks;
        } else if (path.name == "scale-100") {
          CHECK_THAT((path.points_mm[1] - path.points_mm[0]).norm(), WithinAbs(100, 1e-12));
        }
      }
    }
    CHECK_THAT(from, WithinAbs(1000, 1e-9));
    CHECK(marks == 2 * static_cast<int>(plan.markers.markers.size()));
  }
}

TEST_CASE("TapeTemplate.PaperNeedsNoneAndTooWideATapeIsRefused") {
  const FlatDesign design = test::strip(200, 20, 21);
  Context context;
  PlanOptions options;
  options.coil = ZipperCoil::none;
  CHECK(plan_zippable(design, options, context).tape.sheets.empty());
  options.tape_width_mm = 90;
  try {
    plan_zippable(design, options, context);
    FAIL("accepted");
  } catch (const Error& error) {
    CHECK(error.where() == "tape_width_mm");
  }
}

TEST_CASE("ZippablePlan.ATapeThatReachesTheOtherSeamIsSaidWithItsFixAndTheUsualOneFitsTheUsualRibbon") {
  const auto notes_of_tapes = [](double width_mm, const PlanOptions& options) {
    Context context;
    const ZippablePlan plan = plan_zippable(test::strip(400, width_mm, 41), options, context);
    int notes = 0;
    for (const std::string& note : plan.notes) notes += note.find("trim the tapes") != std::string::npos;
    return std::pair{notes, plan.fixes};
  };
  PlanOptions options;
  // Tape 11.5, teeth 4.2, gap 0.8 and seam 3 mm: 19.5 mm are just enough.
  CHECK(notes_of_tapes(20, options).first == 0);
  CHECK(notes_of_tapes(19.6, options).first == 0);
  CHECK(notes_of_tapes(19.4, options).first == 1);
  const auto [notes, fixes] = notes_of_tapes(15, options);
  CHECK(notes == 1);
  REQUIRE(fixes.size() == 1);
  CHECK(fixes[0].parameters == Json{{"tape_width_mm", 7.0}});
  // What the fix says helps.
  options.tape_width_mm = fixes[0].parameters["tape_width_mm"].get<double>();
  CHECK(notes_of_tapes(15, options).first == 0);
  // A ribbon that no tape can be trimmed for gets no such fix.
  const auto [narrow_notes, narrow_fixes] = notes_of_tapes(10, PlanOptions{});
  CHECK(narrow_notes == 1);
  for (const Fix& fix : narrow_fixes) CHECK_FALSE(fix.parameters.contains("tape_width_mm"));
}

}  // namespace
}  // namespace formwright
