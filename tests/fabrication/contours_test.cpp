// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/sheet/contours.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <cmath>
#include <numbers>

#include "base/random.h"
#include "fabrication/laser/hatching.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

const Polygon square{{0, 0}, {10, 0}, {10, 10}, {0, 10}};

TEST_CASE("Contours.LinesThatMeetAreOneOutline") {
  std::vector<CutPath> paths;
  for (std::size_t i = 0; i < 4; ++i) {
    CutPath side{CutLayer::cut, {square[i], square[(i + 1) % 4]}, false, ""};
    if (i % 2 == 1) std::swap(side.points_mm[0], side.points_mm[1]);
    paths.push_back(side);
  }
  paths.push_back({CutLayer::mark, {{10, 10}, {20, 10}}, false, ""});              // another layer
  paths.push_back({CutLayer::cut, {{10.5, 10}, {20, 10}}, false, ""});             // too far
  paths.push_back({CutLayer::cut, {{20, 10.03}, {30, 10}, {30, 20}}, false, ""});  // near enough
  const TidiedPaths tidied = tidy_paths(paths, 0.05, Context());
  REQUIRE(tidied.paths.size() == 3u);
  CHECK(tidied.paths[0].closed);
  CHECK_THAT(std::abs(signed_area_mm2(tidied.paths[0].points_mm)), WithinAbs(100, 1e-12));
  CHECK(tidied.paths[1].layer == CutLayer::mark);
  CHECK(tidied.paths[2].points_mm.size() == 4u);
  CHECK(tidied.ends_joined == 5);
}

TEST_CASE("Contours.DoublesAreDroppedWhicheverWayRound") {
  Polygon turned = square;
  std::rotate(turned.begin(), turned.begin() + 2, turned.end());
  std::reverse(turned.begin(), turned.end());
  const std::vector<CutPath> paths{{CutLayer::cut, square, true, ""},
                                   {CutLayer::cut, turned, true, ""},
                                   {CutLayer::mark, square, true, ""},
                                   {CutLayer::cut, {{1, 1}, {5, 5}}, false, ""},
                                   {CutLayer::cut, {{5, 5}, {1, 1}}, false, ""}};
  const TidiedPaths tidied = tidy_paths(paths, 0, Context());
  CHECK(tidied.paths.size() == 3u);
  CHECK(tidied.doubles_dropped == 2);
}

TEST_CASE("Contours.TheSmallestContourAroundIsFound") {
  const auto ring = [](double x, double y, double half) {
    return CutPath{CutLayer::cut,
                   {{x - half, y - half}, {x + half, y - half}, {x + half, y + half}, {x - half, y + half}},
                   true,
                   ""};
  };
  const std::vector<CutPath> paths{ring(0, 0, 1),  ring(0, 0, 50),  ring(0, 0, 10),
                                   ring(30, 0, 5), ring(100, 0, 5), {CutLayer::mark, {{29, 0}, {31, 0}}, false, ""}};
  CHECK(containing_contours(paths, {0, 1, 2, 3, 4}, Context()) == std::vector<int>{2, -1, 1, 1, -1, 3});
}

TEST_CASE("Contours.OffsetsAreExactAndConverge") {
  const double pi = std::numbers::pi;
  for (const double out : {0.05, 0.5, 2.0}) {
    double before = 0;
    for (const double tolerance : {0.04, 0.01, 0.0025}) {
      const auto grown = offset_polygon(square, out, tolerance);
      REQUIRE(grown.size() == 1u);
      const double exact = 100 + 40 * out + pi * out * out, error = exact - signed_area_mm2(grown[0]);
      CHECK(error > -1e-3);
      CHECK(error <= 2 * pi * out * tolerance + 1e-3);
      if (before > 0.01) {
        CHECK(error < before / 2);
      }
      before = error;
    }
    const auto shrunk = offset_polygon(square, -out);
    REQUIRE(shrunk.size() == 1u);
    CHECK_THAT(signed_area_mm2(shrunk[0]), WithinAbs((10 - 2 * out) * (10 - 2 * out), 1e-3));
    CHECK_THAT((shrunk[0][0] - Vec2(out, out)).norm(), WithinAbs(0, 1e-4));  // the start stays
  }
  CHECK(offset_polygon(square, -5.01).empty());
  // A dumb-bell falls apart at its bar.
  const Polygon bell{{0, 0},   {10, 0},  {10, 4.9}, {20, 4.9}, {20, 0},  {30, 0},
                     {30, 10}, {20, 10}, {20, 5.1}, {10, 5.1}, {10, 10}, {0, 10}};
  CHECK(offset_polygon(bell, -0.2).size() == 2u);
  // A bay whose mouth closes stays open inside, the other way round.
  const Polygon bay{{0, 0}, {10, 0}, {10, 4.95}, {8, 4.95},  {8, 3},   {4, 3},
                    {4, 7}, {8, 7},  {8, 5.05},  {10, 5.05}, {10, 10}, {0, 10}};
  const auto closed = offset_polygon(bay, 0.1);
  REQUIRE(closed.size() == 2u);
  const auto [inner, outer] = std::minmax({signed_area_mm2(closed[0]), signed_area_mm2(closed[1])});
  CHECK_THAT(inner, WithinAbs(-3.8 * 3.8, 0.01));
  CHECK(outer > 100);
}

TEST_CASE("Contours.OffsetStaysTheDistanceAway") {
  Random random(11);
  for (int round = 0; round < 20; ++round) {
    Polygon star;
    const int corners = 5 + static_cast<int>(random.below(20));
    for (int i = 0; i < corners; ++i) {
      const double angle = 2 * std::numbers::pi * i / corners, radius = random.uniform(8, 30);
      star.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
    }
    const double out = random.uniform(0.05, 2);
    const auto to_edges = [&](const Vec2& p) {
      double nearest = 1e9;
      for (std::size_t i = 0; i < star.size(); ++i) {
        const Vec2 a = star[i], run = star[(i + 1) % star.size()] - a;
        nearest = std::min(nearest, (p - a - run * std::clamp((p - a).dot(run) / run.squaredNorm(), 0.0, 1.0)).norm());
      }
      return nearest;
    };
    for (const double distance : {out, -out})
      for (const Polygon& moved : offset_polygon(star, distance))
        for (const Vec2& p : moved) {
          CHECK_THAT(to_edges(p), WithinAbs(out, 0.003));
          CHECK(contains(star, p) == (distance < 0));
        }
  }
}

TEST_CASE("Hatching.CoversTheAreaAndLeavesHolesOut") {
  const Polygon hole{{2, 2}, {8, 2}, {8, 8}, {2, 8}};
  for (const double spacing : {0.5, 0.1}) {
    const auto lines = hatch({square, hole}, spacing, Context());
    double covered = 0;
    for (const auto& line : lines) {
      covered += spacing * (line[1] - line[0]).norm();
      CHECK_FALSE(contains(hole, (line[0] + line[1]) / 2));
    }
    CHECK_THAT(covered, WithinAbs(64, 1e-9));
  }
  Polygon circle;
  for (int i = 0; i < 720; ++i)
    circle.emplace_back(10 * std::cos(i * std::numbers::pi / 360), 10 * std::sin(i * std::numbers::pi / 360));
  double covered = 0;
  for (const auto& line : hatch({circle}, 0.05, Context())) covered += 0.05 * (line[1] - line[0]).norm();
  CHECK_THAT(covered, WithinAbs(100 * std::numbers::pi, 0.1));
}

}  // namespace
}  // namespace formwright
