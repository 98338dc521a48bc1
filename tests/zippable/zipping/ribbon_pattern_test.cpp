// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/zipping/ribbon_pattern.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <cmath>
#include <map>

#include "geometry/samples/samples.h"
#include "zippable/design_files.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

RibbonDesign torus() {
  Context context;
  ZippableOptions options;
  options.width_mm = 15;
  options.measure_distances = false;
  const ParameterisedModel model = parameterise_model(make_sample("torus", 2500, context).mesh, {}, options, context);
  return ribbon_of(read_flat_design(write_design_json(model, design_zippable(model, options, context))));
}

/// Of all pairs, whose lengths sum up to the cut's.
double largest_gap(const RibbonPattern& pattern, double length_mm) {
  double gap = 0, sum = 0;
  for (const ClosurePair& pair : pattern.closures) {
    gap = std::max(gap, (pattern.predicted_mm.row(pair.left) - pattern.predicted_mm.row(pair.right)).norm());
    sum += pair.length_mm;
  }
  CHECK_THAT(sum, WithinAbs(length_mm, 1e-9 * length_mm));
  return gap / pattern.size_mm;
}

TEST_CASE("RibbonPattern.PairsOfACutHandleMeetWhereTheyAreDesigned") {
  Context context;
  const RibbonDesign design = torus();
  REQUIRE(design.closures.size() == 1u);
  std::size_t count = 0;
  for (const double edge_mm : {0.0, 2.5, 1.2}) {
    const RibbonPattern pattern =
        make_ribbon_pattern(design.places, design.triangles, edge_mm, context, design.closures);
    CHECK(pattern.closures.size() > count);
    count = pattern.closures.size();
    CHECK(largest_gap(pattern, design.closures[0].length_mm) < 1e-6);
    for (Eigen::Index f = 0; f < pattern.flat.F.rows(); ++f) {
      const auto p = [&](int k) -> Vec2 { return pattern.flat.V.row(pattern.flat.F(f, k)).head<2>(); };
      CHECK((p(1) - p(0)).x() * (p(2) - p(0)).y() - (p(1) - p(0)).y() * (p(2) - p(0)).x() > 0);
      for (int k = 0; k < 3 && edge_mm > 0; ++k) CHECK((p(k) - p((k + 1) % 3)).norm() <= edge_mm * (1 + 1e-9));
    }
  }
  // Without them the pattern is as it was.
  CHECK(make_ribbon_pattern(design.places, design.triangles, 0, context).closures.empty());
}

TEST_CASE("RibbonPattern.ASideIsDividedWhereTheOtherHasAVertex") {
  // Two triangles whose outer edges meet, one of which names a place in its middle.
  RibbonDesign design;
  const auto add = [&](double x, double y) {
    RibbonEdgePlace place;
    place.flat_mm = Vec2(x, y);
    place.predicted_mm = Vec3(x, y, 0);
    design.places.push_back(place);
  };
  for (const auto& [x, y] : {std::pair{0.0, 0.0}, {2.0, 0.0}, {6.0, 0.0}, {6.0, 5.0}, {0.0, 5.0}}) add(x, y);
  design.triangles.resize(3, 3);
  design.triangles << 0, 1, 4, 1, 2, 3, 1, 3, 4;
  HandleClosure closure{6, false, {}};
  closure.sides[0].push_back({0, {0, 2, 6}});
  closure.sides[1].push_back({3, {6, 0}});
  Context context;
  const RibbonPattern pattern = make_ribbon_pattern(design.places, design.triangles, 0, context, {closure});
  REQUIRE(pattern.closures.size() == 3u);
  const std::array along{0.0, 2.0, 6.0}, length{1.0, 3.0, 2.0};
  for (std::size_t i = 0; i < 3; ++i) {
    const ClosurePair& pair = pattern.closures[i];
    CHECK(pair.along_mm == along[i]);
    CHECK_THAT(pair.length_mm, WithinAbs(length[i], 1e-12));
    CHECK_THAT(pattern.flat.V(pair.left, 0), WithinAbs(along[i], 1e-12));
    CHECK_THAT(pattern.flat.V(pair.right, 0), WithinAbs(along[i], 1e-12));
    CHECK_THAT(pattern.flat.V(pair.right, 1), WithinAbs(5, 1e-12));
  }
  CHECK(pattern.flat.F.rows() == 4);
}

}  // namespace
}  // namespace formwright
