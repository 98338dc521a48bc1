// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <algorithm>

#include "base/error.h"
#include "geometry/mesh/adjacency.h"
#include "zippable/fabric_colours.h"
#include "zippable/ribbon/ribbon_bend.h"
#include "zippable/zippable_design.h"
#include "zippable/zippable_shapes.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

ZippableDesign designed(const char* sample, ZippableOptions options) {
  Context context;
  options.size_mm = 150;
  options.measure_distances = false;
  const ParameterisedModel model = parameterise_model(make_sample(sample, 3000, context).mesh, {}, options, context);
  return design_zippable(model, options, context);
}

double area_of(const Ribbon& ribbon, int f) {
  const auto p = [&](int k) -> const Vec3& { return ribbon.boundary[ribbon.F(f, k)].position_mm; };
  return (p(1) - p(0)).cross(p(2) - p(0)).norm() / 2;
}

/// What two_fabrics makes least, counted anew.
double cost_of(const Ribbon& ribbon, const std::vector<int>& colour, double width_mm) {
  const Adjacency adjacency(ribbon.formed());
  double cost = 0;
  for (int f = 0; f < adjacency.face_count(); ++f) {
    int left = 0, right = 0;
    for (int k = 0; k < 3; ++k)
      if (const RibbonVertex& v = ribbon.boundary[ribbon.F(f, k)]; v.sample >= 0) ++(v.left ? left : right);
    if ((left == 3 && colour[f] == 1) || (right == 3 && colour[f] == 0)) cost += area_of(ribbon, f);
  }
  for (int h = 0; h < 3 * adjacency.face_count(); ++h)
    if (const int o = adjacency.opposite(h); o > h && colour[h / 3] != colour[o / 3])
      cost += 2 * width_mm *
              (ribbon.boundary[adjacency.from(h)].position_mm - ribbon.boundary[adjacency.to(h)].position_mm).norm();
  return cost;
}

TEST_CASE("Fabrics.BandsOfFermatSpiralsDiffer") {
  for (const char* sample : {"star", "octopus", "t_shape"}) {
    ZippableOptions options;
    options.width_mm = 10;
    options.fabrics = RibbonFabrics::two;
    const ZippableDesign design = designed(sample, options);
    REQUIRE(design.fabrics.has_value());
    {
      INFO(sample);
      CHECK(design.fabrics->has_bands);
    }
    double band[2]{}, own[2]{}, all = 0;
    for (int f = 0; f < design.ribbon.F.rows(); ++f) {
      int left = 0, right = 0;
      for (int k = 0; k < 3; ++k)
        if (const RibbonVertex& v = design.ribbon.boundary[design.ribbon.F(f, k)]; v.sample >= 0)
          ++(v.left ? left : right);
      const double area = area_of(design.ribbon, f);
      all += area;
      if (left < 3 && right < 3) continue;
      const int side = left == 3 ? 0 : 1;
      band[side] += area;
      if (design.fabrics->of_face[f] == side) own[side] += area;
    }
    for (int side = 0; side < 2; ++side) {
      INFO(sample);
      CHECK(own[side] > 0.98 * band[side]);
    }
    CHECK_THAT(design.fabrics->area_mm2[0] + design.fabrics->area_mm2[1], WithinAbs(all, 1e-9 * all));
    {
      INFO(sample);
      CHECK(design.fabrics->interleaved_share > 0.2);
    }
    CHECK(design.fabrics->seams >= 1);
  }
}

TEST_CASE("Fabrics.NothingIsCheaper") {
  ZippableOptions options;
  options.width_mm = 15;
  options.fabrics = RibbonFabrics::two;
  const ZippableDesign design = designed("star", options);
  const std::vector<int>& colour = design.fabrics->of_face;
  const double minimum = cost_of(design.ribbon, colour, options.width_mm);
  // Everything beyond any one ruling turned over: among all neighbouring colourings none may be better.
  const Adjacency adjacency(design.ribbon.formed());
  for (int h = 0; h < 3 * adjacency.face_count(); ++h) {
    if (adjacency.opposite(h) < 0) continue;
    std::vector<int> other = colour;
    std::vector<char> seen(colour.size(), 0);
    seen[h / 3] = 1;
    for (std::vector<int> open{adjacency.opposite(h) / 3}; !open.empty();) {
      const int f = open.back();
      open.pop_back();
      if (seen[f]) continue;
      seen[f] = 1;
      other[f] = 1 - other[f];
      for (int g = 3 * f; g < 3 * f + 3; ++g)
        if (const int o = adjacency.opposite(g); o >= 0 && !seen[o / 3]) open.push_back(o / 3);
    }
    CHECK(cost_of(design.ribbon, other, options.width_mm) >= minimum * (1 - 1e-12));
  }
}

TEST_CASE("Fabrics.OneCylinderChangesOnceHalfWay") {
  CurveOptions curve;
  curve.width_mm = 10, curve.sample_mm = 2;
  const test::Zipped zipped = test::zip(test::alone(test::cylinder_side(20, 80, 40, 40)), curve);
  const FabricColours colours = two_fabrics(zipped.ribbon, curve.width_mm);
  CHECK_FALSE(colours.has_bands);
  CHECK(colours.seams == 1);
  CHECK_THAT(colours.area_mm2[0] / colours.area_mm2[1], WithinAbs(1, 0.02));
}

TEST_CASE("RibbonBend.OfAConeIsItsDistanceFromTheTip") {
  // Unrolled, a cone's spiral turns about the tip: its centre line is nearest to it at the upper opening.
  const double radius = 60, top = 24, height = 80, slant = std::hypot(radius, height);
  CurveOptions curve;
  curve.width_mm = 8, curve.sample_mm = 1;
  const double along = slant * (1 - top / radius);  // of the side that is there
  const test::Zipped zipped = test::zip(
      test::alone(test::turned(
          96, 60, [&](double t) { return Vec2(radius + t * (top - radius), t * height * (1 - top / radius)); })),
      curve);
  const auto bend = tightest_bend(zipped.ribbon, curve.width_mm);
  REQUIRE(bend.has_value());
  const double nearest = slant - along;
  CHECK(bend->radius_mm > 0.8 * nearest);
  CHECK(bend->radius_mm < nearest + 2 * curve.width_mm);
}

TEST_CASE("RibbonBend.OfACylinderIsLittle") {
  CurveOptions curve;
  curve.width_mm = 10, curve.sample_mm = 2;
  const test::Zipped zipped = test::zip(test::alone(test::cylinder_side(20, 80, 40, 40)), curve);
  const auto bend = tightest_bend(zipped.ribbon, curve.width_mm);
  REQUIRE(bend.has_value());
  // Its ribbon is straight; beside the openings, which cut it off aslant, the middles step aside a little.
  CHECK(bend->radius_mm > 20 * curve.width_mm);
}

TEST_CASE("Curve.BeginsAndEndsWhereItShould") {
  ZippableOptions options;
  options.width_mm = 15;
  for (const auto& [start, end] : {std::pair{2, 4}, std::pair{4, 2}, std::pair{0, 5}}) {
    options.start_part = start, options.end_part = end;
    const ZippableDesign design = designed("star", options);
    const std::vector<int>& parts = design.traversal.traversal.parts;
    if (start > 0) {
      CHECK(parts.front() == start - 1);
    }
    CHECK(parts.back() == end - 1);
  }
  options.start_part = options.end_part = 1;
  CHECK_THROWS_AS(designed("star", options), Error);
  options.start_part = 9;
  CHECK_THROWS_AS(designed("star", options), Error);
}

TEST_CASE("Curve.KeepsALeastRadiusOrSaysSo") {
  ZippableOptions options;
  options.width_mm = 15;
  const ZippableDesign free = designed("star", options);
  REQUIRE(free.bend.has_value());
  options.min_radius_mm = 1.02 * free.bend->radius_mm;
  const ZippableDesign bound = designed("star", options);
  const auto says = [](const ZippableDesign& design) {
    return std::any_of(design.notes.begin(), design.notes.end(),
                       [](const std::string& note) { return note.find("bends to a radius") != std::string::npos; });
  };
  CHECK((bound.bend->radius_mm >= *options.min_radius_mm) != says(bound));
  options.min_radius_mm = 2000;
  options.puncture_mm = 7;
  CHECK(says(designed("star", options)));
  options.min_radius_mm = 0.5;
  CHECK_FALSE(says(designed("star", options)));
}

}  // namespace
}  // namespace formwright
