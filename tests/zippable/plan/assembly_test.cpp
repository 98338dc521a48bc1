// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/plan/assembly_sheet.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <set>

#include "zippable/plan/piece_picture.h"
#include "zippable/plan/planned.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

TEST_CASE("Seams.OfAStripCutTwice") {
  Context context;
  PlanOptions options;
  options.bed_x_mm = options.bed_y_mm = 150;
  options.spacing_mm = 1;
  const ZippablePlan plan = plan_zippable(test::strip(300, 20, 61), options, context);
  REQUIRE(plan.splitting.splits.size() == 2u);
  // Two joins, the second at the first one's new piece, then three stretches of either tape.
  REQUIRE(plan.seams.size() == 8u);
  CHECK(plan.seams[0].kind == SeamKind::join);
  CHECK(plan.seams[0].piece == plan.runs[0].piece);
  CHECK(plan.seams[1].piece == plan.seams[0].other_piece);
  CHECK_THAT(plan.seams[0].cloth_mm,
             WithinAbs(20 - 2 * plan.zipper.offset_mm(), 3));  // a ruling, which may be the strip's diagonal
  for (std::size_t i = 2; i < 8; ++i) {
    CHECK(plan.seams[i].kind == SeamKind::tape);
    CHECK(plan.seams[i].left == (i < 5));
  }
}

TEST_CASE("Seams.JoinEveryPieceOnceToWhatIsThere") {
  Context context;
  for (const char* sample : {"star", "octopus"}) {
    PlanOptions options;
    options.bed_x_mm = options.bed_y_mm = 250;
    const ZippablePlan plan = plan_zippable(test::designed(sample, 20), options, context);
    std::set<int> there{plan.runs[0].piece};
    std::set<std::string> letters;
    for (const Seam& seam : plan.seams) {
      if (seam.kind != SeamKind::join) continue;
      CHECK(there.contains(seam.piece));
      CHECK(there.insert(seam.other_piece).second);
      CHECK(letters.insert(seam.letters).second);
    }
    CHECK(there.size() == plan.pieces.pieces.size());
  }
}

TEST_CASE("Seams.OfPaperMeetOnceAlongTheWholeZipper") {
  Context context;
  PlanOptions options;
  options.coil = ZipperCoil::none;
  const FlatDesign design = test::designed("star", 20);
  const ZippablePlan plan = plan_zippable(design, options, context);
  double at = 0;
  int next_marker = 0;
  for (const Seam& seam : plan.seams) {
    if (seam.kind == SeamKind::join) continue;
    REQUIRE(seam.kind == SeamKind::edge);
    CHECK(seam.from_mm == at);
    CHECK(seam.first_marker == next_marker);
    at = seam.to_mm, next_marker = seam.last_marker + 1;
    // Both sides are on their pieces all along.
    const double middle = (seam.from_mm + seam.to_mm) / 2;
    for (const TapeRun& run : plan.runs) {
      const int piece = run.left ? seam.piece : seam.other_piece;
      INFO(middle);
      CHECK((middle <= run.from_mm || middle >= run.to_mm || run.piece == piece));
    }
  }
  CHECK(at == design.zipper_mm);
  CHECK(next_marker == static_cast<int>(plan.markers.markers.size()));
}

TEST_CASE("PiecePicture.ShowsTheOutlineAtItsScaleInsideItsBox") {
  Context context;
  const FlatDesign design = test::designed("star", 20);
  const ZippablePlan plan = plan_zippable(design, {}, context);
  const Vec2 size(85, 62);
  double left_mm = 0;
  for (int p = 0; p < plan.splitting.piece_count; ++p) {
    const PiecePicture picture = picture_of_piece(design, plan, p, size, "", {{7, true, 10.0}});
    CHECK(picture.scale <= 1);
    const Polygon& outline = plan.pieces.pieces[p].outline_mm;
    double around = 0, drawn = 0;
    for (std::size_t i = 0; i < outline.size(); ++i) {
      around += (outline[(i + 1) % outline.size()] - outline[i]).norm();
      const Stroke& stroke = picture.drawing.strokes[i];
      drawn += (stroke.to - stroke.from).norm();
      CHECK(stroke.from.minCoeff() >= 0);
      CHECK(stroke.from.x() <= size.x());
      CHECK(stroke.from.y() <= size.y());
    }
    CHECK_THAT(drawn, WithinAbs(picture.scale * around, 1e-9 * around));
    for (const Stroke& stroke : picture.drawing.strokes)
      if (stroke.width_mm == left_edge_stroke_mm) left_mm += (stroke.to - stroke.from).norm() / picture.scale;
  }
  CHECK_THAT(left_mm, WithinAbs(plan.ribbon.left_mm, 1e-6 * left_mm));  // every piece of the left side in one picture
}

TEST_CASE("AssemblySheet.ZipperToCutHasItsEnds") {
  Context context;
  const FlatDesign design = test::strip(200, 20, 21);
  PlanOptions options;
  CHECK(zipper_to_cut_mm(design, plan_zippable(design, options, context)) == 260);
  options.coil = ZipperCoil::none;
  CHECK(zipper_to_cut_mm(design, plan_zippable(design, options, context)) == 0);
}

}  // namespace
}  // namespace formwright
