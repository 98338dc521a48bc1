// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/plan/pieces/splitting.h"

#include <catch2/catch_test_macros.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "base/error.h"
#include "fabrication/sheet/nesting.h"
#include "zippable/plan/planned.h"

namespace formwright {
namespace {

const auto any_size = [](const Polygon&) { return true; };

std::vector<Vec2> flat_of(const FlatDesign& design) {
  std::vector<Vec2> flat;
  for (const FlatVertex& v : design.boundary) flat.push_back(v.flat_mm);
  return flat;
}

/// A ring of the given width that turns `turns` times over itself: one strip bent around.
std::vector<Vec2> bent(const FlatDesign& strip, double radius, double width, double turns) {
  std::vector<Vec2> flat;
  const double length = strip.zipper_mm;
  for (const FlatVertex& v : strip.boundary) {
    // Counter-clockwise with the inner side to the left: the lower edge is outside.
    const double angle = 2 * std::numbers::pi * turns * v.flat_mm.x() / length,
                 r = radius - v.flat_mm.y() / width * width;
    flat.emplace_back(r * std::cos(angle), r * std::sin(angle));
  }
  return flat;
}

TEST_CASE("Splitting.AStripIsCutAsOftenAsItsLengthSays") {
  const FlatDesign strip = test::strip(1000, 20, 201);
  Context context;
  const auto fits = [](const Polygon& hull) { return !fitting_turns(hull, 300, 100, false).empty(); };
  const Splitting splitting = split_ribbon(strip.F, flat_of(strip), fits, 0.5, 0, context);
  CHECK(splitting.piece_count == 4);  // 1000 / 300, rounded up
  CHECK(splitting.splits.size() == 3u);
  CHECK(split_ribbon(strip.F, flat_of(strip), any_size, 0.5, 0, context).piece_count == 1);
}

TEST_CASE("Splitting.ARingOverItselfIsCutOnceATurn") {
  Context context;
  for (const double turns : {0.9, 1.5, 2.5, 3.5}) {
    const FlatDesign strip = test::strip(400 * turns, 12, static_cast<int>(100 * turns) + 1);
    const Splitting splitting = split_ribbon(strip.F, bent(strip, 70, 12, turns), any_size, 0.5, 0, context);
    INFO(turns);
    CHECK(splitting.piece_count == static_cast<int>(std::ceil(turns)));
  }
}

TEST_CASE("Splitting.NarrowerThanASingleTriangleIsRefused") {
  const FlatDesign strip = test::strip(100, 20, 21);
  Context context;
  CHECK_THROWS_AS(split_ribbon(
                      strip.F, flat_of(strip), [](const Polygon&) { return false; }, 0.5, 0, context),
                  Error);
}

TEST_CASE("Splitting.PiecesOfSamplesNeitherOverlapNorLoseTriangles") {
  Context context;
  for (const char* sample : {"star", "octopus"}) {
    const FlatDesign design = test::designed(sample, 20);
    const std::vector<Vec2> flat = flat_of(design);
    const Splitting splitting = split_ribbon(design.F, flat, any_size, 0.5, 0, context);
    CHECK(static_cast<int>(splitting.splits.size()) == splitting.piece_count - 1);
    CHECK(std::set<int>(splitting.piece_of_face.begin(), splitting.piece_of_face.end()).size() ==
          std::size_t(splitting.piece_count));
    const auto corners = [&](Eigen::Index f) {
      return std::array<Vec2, 3>{flat[design.F(f, 0)], flat[design.F(f, 1)], flat[design.F(f, 2)]};
    };
    int overlaps = 0;
    for (Eigen::Index f = 0; f < design.F.rows(); ++f)
      for (Eigen::Index g = 0; g < f; ++g)
        if (splitting.piece_of_face[f] == splitting.piece_of_face[g])
          overlaps += triangles_overlap(corners(f), corners(g), 1e-6);
    INFO(sample);
    CHECK(overlaps == 0);
  }
}

TEST_CASE("Splitting.CrumbsGrowAtTheirNeighboursCost") {
  // A little more than two turns: two whole rings, and what would be a scrap.
  Context context;
  const double min_area_mm2 = 300;
  const FlatDesign strip = test::strip(810, 12, 203);
  const std::vector<Vec2> flat = bent(strip, 70, 12, 2.02);
  const auto smallest = [&](const Splitting& splitting) {
    std::vector<double> area(std::size_t(splitting.piece_count), 0.0);
    for (Eigen::Index f = 0; f < strip.F.rows(); ++f)
      area[splitting.piece_of_face[f]] +=
          signed_area_mm2({flat[strip.F(f, 0)], flat[strip.F(f, 1)], flat[strip.F(f, 2)]});
    return *std::min_element(area.begin(), area.end());
  };
  const Splitting with_crumb = split_ribbon(strip.F, flat, any_size, 0.5, 0, context),
                  swept = split_ribbon(strip.F, flat, any_size, 0.5, min_area_mm2, context);
  CHECK(smallest(with_crumb) < min_area_mm2);
  CHECK(smallest(swept) >= min_area_mm2);
  CHECK(swept.piece_count == with_crumb.piece_count);
  CHECK(swept.moved_splits == 1);
  REQUIRE(swept.splits.size() == 2u);
  for (const RibbonSplit& split : swept.splits) CHECK(split.left != split.right);
}

TEST_CASE("Splitting.ARestOfAStripGrowsToo") {
  // Three pieces of up to 300 mm and a rest of 40 mm, 800 square mm.
  Context context;
  const FlatDesign strip = test::strip(940, 20, 189);
  const auto fits = [](const Polygon& hull) { return !fitting_turns(hull, 300, 100, false).empty(); };
  const Splitting splitting = split_ribbon(strip.F, flat_of(strip), fits, 0.5, 2000, context);
  CHECK(splitting.piece_count == 4);
  CHECK(splitting.moved_splits + splitting.merged_crumbs == 1);
  std::vector<double> area(4, 0.0);
  for (int f = 0; f < strip.F.rows(); ++f) area[splitting.piece_of_face[f]] += 20 * 5 / 2.0;
  CHECK(*std::min_element(area.begin(), area.end()) >= 2000);
}

}  // namespace
}  // namespace formwright
