// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/curve/crease_alignment.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <cmath>

#include "geometry/mesh/measures.h"
#include "zippable/zippable_design.h"
#include "zippable/zippable_shapes.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

using std::numbers::pi;

/// Two cones that meet in a ring of radius 30 at `ring_mm` of 60, bent by `bend_rad` there.
TriangleMesh two_cones(double bend_rad, double ring_mm, int around = 72) {
  const double slope = std::tan(0.5 * bend_rad);
  return test::turned(around, 30, [&](double t) { return Vec2(30 - slope * std::abs(60 * t - ring_mm), 60 * t); });
}

struct Aligned {
  Segmentation segmentation;
  Parameterisation parameterisation;
  std::vector<SpiralLine> lines;
  CreaseAlignment alignment;
  ZipperCurve even, along;
  Ribbon ribbon;
};

Aligned align(const TriangleMesh& mesh, const CurveOptions& curve, const CreaseAlignmentOptions& options = {}) {
  Context context;
  Aligned a;
  a.segmentation = test::alone(mesh);
  a.parameterisation = parameterise(a.segmentation, {1e-10}, context);
  const RankedTraversal order = ranked_traversals(a.segmentation, a.parameterisation, curve.width_mm, Context()).at(0);
  const FeatureLines features = find_features(a.segmentation.mesh, Adjacency(a.segmentation.mesh), {4, 0.35}, context);
  ZipperCurve placed;
  a.lines = place_lines(a.segmentation, a.parameterisation, order.traversal, order.crossings, curve, placed);
  CreaseSystem system(a.segmentation, context);
  a.alignment = align_to_creases(a.segmentation, a.parameterisation, system, features, a.lines, options, context);
  // Other windings on the same model: what is kept between them leaves no trace.
  const CreaseAlignment again =
      align_to_creases(a.segmentation, a.parameterisation, system, features, a.lines, options, context);
  CHECK(again.parameterisation.corners_mm == a.alignment.parameterisation.corners_mm);
  const LineTracer before(a.segmentation, a.parameterisation), after(a.segmentation, a.alignment.parameterisation);
  a.even =
      draw_zipper_curve(a.segmentation, a.parameterisation, before, order.traversal, order.crossings, curve, context);
  a.along = draw_zipper_curve(a.segmentation, a.alignment.parameterisation, after, order.traversal, order.crossings,
                              curve, context);
  a.ribbon = make_ribbon(a.segmentation, a.alignment.parameterisation, after, a.along, curve, context);
  return a;
}

/// The share of the ring at height z that the curve passes within `near_mm` of.
double ring_covered(const ZipperCurve& curve, double z, double near_mm) {
  constexpr int places = 360;
  std::vector<char> covered(places, 0);
  for (const SpiralLine& line : curve.lines)
    for (double x = line.x_low_mm; x < line.x_high_mm; x += 0.2) {
      const Vec3 p = line.trace.at(x);
      if (std::abs(p.z() - z) < near_mm)
        covered[static_cast<std::size_t>((std::atan2(p.y(), p.x()) + pi) / (2 * pi) * (places - 1))] = 1;
    }
  return static_cast<double>(std::count(covered.begin(), covered.end(), 1)) / places;
}

TEST_CASE("CreaseAlignment.NothingMovesWhereThereIsNoCrease") {
  const Aligned a = align(test::cylinder_side(30, 60, 72, 24), {12, {}, {}, 3});
  CHECK(a.alignment.crease_mm == 0);
  CHECK(a.alignment.parameterisation.corners_mm == a.parameterisation.corners_mm);
}

TEST_CASE("CreaseAlignment.AWindingLiesOnARingButForTheChangeOver") {
  for (const double ring : {24.0, 30.0, 34.0}) {
    const Aligned a = align(two_cones(0.8, ring), {12, {}, {}, 3});
    CHECK_THAT(a.alignment.crease_mm, WithinAbs(2 * pi * 30, 0.2 * 2 * pi * 30));
    // A helix is within a millimetre of a ring for a sixth of a turn; a spiral cannot be all around.
    const double before = ring_covered(a.even, ring, 1), after = ring_covered(a.along, ring, 1);
    CHECK(before < 0.3);
    CHECK(after > 0.55);
    CHECK(a.alignment.off_after_mm < 0.5 * a.alignment.off_before_mm);
    CHECK(a.alignment.min_spacing >= 0.6 - 1e-9);
    CHECK(a.alignment.max_spacing <= 1 / 0.6 + 1e-9);
    CHECK(a.ribbon.isometry_error < 1e-9);
    CHECK(a.ribbon.opening_arcs == 2);
  }
}

TEST_CASE("CreaseAlignment.KeepsBordersAndTurnsNothingOver") {
  const Aligned a = align(two_cones(-0.8, 27), {12, {}, {}, 3});
  const Parameterisation &p = a.parameterisation, &q = a.alignment.parameterisation;
  CHECK(p.corners_mm.col(0) == q.corners_mm.col(0));
  const Segmentation& s = a.segmentation;
  const Adjacency adjacency(s.mesh);
  for (int f = 0; f < s.mesh.face_count(); ++f) {
    const auto area = [&](const CornerCoordinates& c) {
      const int i = 3 * f;
      return (c(i + 1, 0) - c(i, 0)) * (c(i + 2, 1) - c(i, 1)) - (c(i + 2, 0) - c(i, 0)) * (c(i + 1, 1) - c(i, 1));
    };
    CHECK(area(q.corners_mm) > 0.55 * area(p.corners_mm));
    for (int k = 0; k < 3; ++k)
      if (adjacency.is_boundary_vertex(s.mesh.F(f, k))) {
        CHECK(p.corners_mm(3 * f + k, 1) == q.corners_mm(3 * f + k, 1));
      }
  }
  CHECK(constraint_residual_mm(s, q) < 1e-10);
}

TEST_CASE("CreaseAlignment.CreasesAcrossTheWindingsAreLeftAlone") {
  // A prism's edges run from opening to opening.
  TriangleMesh prism = test::cylinder_side(30, 60, 72, 24);
  for (int v = 0; v < prism.vertex_count(); ++v) {
    const double u = std::atan2(prism.V(v, 1), prism.V(v, 0)), side = 2 * pi / 6;
    const double within = u - side * std::floor(u / side) - 0.5 * side;
    prism.V.row(v).head(2) *= std::cos(0.5 * side) / std::cos(within);
  }
  const Aligned a = align(prism, {12, {}, {}, 3});
  CHECK(a.alignment.crease_mm == 0);
}

TEST_CASE("CreaseAlignment.IsPartOfADesignOnRequest") {
  Context context;
  ZippableOptions options;
  options.width_mm = 15;
  const TriangleMesh mesh = make_sample("heart", 2500, context).mesh;
  const ZippableDesign even = design_zippable(parameterise_model(mesh, {}, options, context), options, context);
  CHECK_FALSE(even.alignment);
  options.winding_course = WindingCourse::creases;
  options.crease_degrees = 15;
  CHECK(parameterisation_key(options) != parameterisation_key({}));
  const ZippableDesign along = design_zippable(parameterise_model(mesh, {}, options, context), options, context);
  REQUIRE(along.alignment);
  CHECK(along.alignment->off_after_mm <= along.alignment->off_before_mm);
  CHECK(along.ribbon.isometry_error < 1e-9);
}

}  // namespace
}  // namespace formwright
