// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/plan/pieces/closure_marks.h"

#include <catch2/catch_test_macros.hpp>

#include <cmath>
#include <map>

#include "zippable/plan/assembly_sheet.h"
#include "zippable/plan/planned.h"

namespace formwright {
namespace {
using test::planned;

bool within(const Polygon& polygon, const Vec2& p) {
  bool in = false;
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Vec2 &a = polygon[i], &b = polygon[j];
    if ((a.y() > p.y()) != (b.y() > p.y()) && p.x() < (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y()) + a.x())
      in = !in;
  }
  return in;
}

TEST_CASE("ClosureMarks.NumbersPairUpAtTheSamePlacesOfTheCut") {
  const FlatDesign design = test::designed("torus", 60, 400);
  REQUIRE(design.closures.size() == 1u);
  PlanOptions options;
  options.bed_x_mm = options.bed_y_mm = 800;
  for (const ZipperCoil coil : {ZipperCoil::none, ZipperCoil::coil_3}) {
    options.coil = coil;
    const ZippablePlan plan = planned(design, options);
    const HandleClosure& closure = design.closures[0];
    CHECK(plan.closures.total_mm() == closure.length_mm);
    const auto expected = static_cast<std::size_t>(std::ceil(closure.length_mm / plan.marker_spacing_mm));
    // Where room was made for the zipper a number at either end of either side may be gone, on both sides.
    if (coil == ZipperCoil::none) {
      CHECK(plan.closures.markers.size() == expected);
    }
    CHECK(plan.closures.markers.size() + 2 >= expected);
    // Places between numbers are equally far apart on both sides, where edges were not moved.
    if (coil == ZipperCoil::none)
      for (std::size_t side = 0; side < 2; ++side)
        for (const ClosureMarker& marker : plan.closures.markers) {
          const int v = marker.sides[side].edge;
          const FlatVertex &a = design.boundary[v], &b = design.boundary[design.next(v)];
          const double share = (marker.sides[side].flat_mm - a.flat_mm).norm() / (b.flat_mm - a.flat_mm).norm();
          const Vec3 here = a.position_mm + share * (b.position_mm - a.position_mm);
          const ClosureMarker& same = marker;
          const int w = same.sides[1 - side].edge;
          const FlatVertex &c = design.boundary[w], &d = design.boundary[design.next(w)];
          const double other_share = (same.sides[1 - side].flat_mm - c.flat_mm).norm() / (d.flat_mm - c.flat_mm).norm();
          CHECK((here - (c.position_mm + other_share * (d.position_mm - c.position_mm))).norm() < 1e-6);
        }
    // On the sheets every number stands once a side, and all marks lie in their piece.
    std::map<std::string, int> names;
    for (const PlanPiece& piece : plan.pieces.pieces)
      for (const CutPath& path : piece.marks) {
        if (!path.name.starts_with("closure-") && !path.name.starts_with("hook-")) continue;
        ++names[path.name];
        CHECK(path.layer == CutLayer::mark);
        for (std::size_t k = 1; k < path.points_mm.size(); ++k) {
          INFO(path.name);
          CHECK(within(piece.cut_mm, 0.5 * (path.points_mm[k - 1] + path.points_mm[k])));
        }
      }
    for (const ClosureMarker& marker : plan.closures.markers)
      for (const char* side : {"-hook", "-loop"})
        CHECK(names["closure-1-" + std::to_string(marker.number) + side] == 1);
  }
}

TEST_CASE("ClosureMarks.TheLowerSideIsDeeperByTheTape") {
  const FlatDesign design = test::designed("torus", 60, 400);
  PlanOptions options;
  options.bed_x_mm = options.bed_y_mm = 800;
  options.hook_and_loop_mm = 16;
  const ZippablePlan plan = planned(design, options);
  REQUIRE_FALSE(plan.closures.flaps.empty());
  for (const EdgeFlap& flap : plan.closures.flaps)
    for (const Vec2& corner : flap.outer_mm) {
      double nearest = 1e300;
      for (int v = flap.from_vertex; v != flap.to_vertex; v = design.next(v)) {
        const Vec2 a = plan.ribbon.flat_mm[v], segment = plan.ribbon.flat_mm[design.next(v)] - a;
        nearest = std::min(
            nearest,
            (corner - a - std::clamp((corner - a).dot(segment) / segment.squaredNorm(), 0.0, 1.0) * segment).norm());
      }
      CHECK(nearest <= 2 * 16 + 1e-9);  // at a bend, where the moved edges meet
    }
  // Lines of the tape run its width inside the other side.
  REQUIRE_FALSE(plan.closures.tape_edges.empty());
  for (const TapeEdge& edge : plan.closures.tape_edges)
    for (const Vec2& p : edge.points_mm) {
      double nearest = 1e300;
      for (const ClosureStretch& stretch : plan.closures.stretches)
        if (stretch.side == ClosureSide::hook && stretch.piece == edge.piece)
          for (std::size_t k = 0; k + 1 < stretch.vertices.size(); ++k) {
            const Vec2 a = plan.ribbon.flat_mm[stretch.vertices[k]],
                       segment = plan.ribbon.flat_mm[stretch.vertices[k + 1]] - a;
            nearest = std::min(
                nearest, (p - a - std::clamp((p - a).dot(segment) / segment.squaredNorm(), 0.0, 1.0) * segment).norm());
          }
      CHECK(nearest >= 0.98 * 16);
      CHECK(nearest <= 1.25 * 16);  // at a bend, where the moved edges meet
    }
  // Pieces grow by their allowances, and stay simple enough to be cut: area of outline and of what it is made of agree.
  double outlines = 0, flaps = 0;
  for (const PlanPiece& piece : plan.pieces.pieces)
    outlines += signed_area_mm2(piece.outline_mm) - piece.ribbon_area_mm2;
  for (const EdgeFlap& flap : plan.closures.flaps)
    for (const auto& t : flap.triangles) flaps += std::abs(signed_area_mm2({t[0], t[1], t[2]}));
  double allowances = 0;
  for (const RibbonSplit& split : plan.splitting.splits)
    allowances +=
        2 * options.seam_allowance_mm * (plan.ribbon.flat_mm[split.from] - plan.ribbon.flat_mm[split.to]).norm();
  CHECK(flaps > 0.5 * 16 * design.closures[0].length_mm);
  CHECK(outlines >= flaps - 1e-6);
  CHECK(outlines <= flaps + allowances);
}

TEST_CASE("ClosureMarks.PaperIsGluedAndModelsWithoutHandlesHaveNone") {
  const FlatDesign torus = test::designed("torus", 60, 400);
  PlanOptions options;
  options.bed_x_mm = options.bed_y_mm = 800;
  options.coil = ZipperCoil::none;
  const ZippablePlan plain = planned(torus, options);
  CHECK((plain.closures.flaps.empty() && plain.closures.tape_edges.empty()));
  options.edges = PaperEdges::tabs;
  const ZippablePlan tabs = planned(torus, options);
  CHECK(tabs.closures.flaps.size() > 10u);
  CHECK(tabs.closures.tape_edges.empty());
  const ZippablePlan star = planned(test::designed("star", 20), {});
  CHECK((star.closures.markers.empty() && star.closures.flaps.empty() && star.closures.length_mm.empty()));
}

TEST_CASE("ClosureMarks.TheAssemblySheetSaysIt") {
  Context context;
  const FlatDesign torus = test::designed("torus", 60, 400);
  const auto pages = [&](const FlatDesign& design) {
    PlanOptions options;
    options.bed_x_mm = options.bed_y_mm = 800;
    return std::string(as_text(write_assembly_sheet(design, planned(design, options), options, context).pdf));
  };
  FlatDesign without = torus;
  without.closures.clear();
  CHECK(pages(torus).size() > pages(without).size());
}

}  // namespace
}  // namespace formwright
