// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/sheet/nesting.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "base/error.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

double distance_mm(const Vec2& p, const Vec2& a, const Vec2& b) {
  const Vec2 along = b - a;
  return (p - a - std::clamp((p - a).dot(along) / along.squaredNorm(), 0.0, 1.0) * along).norm();
}

bool contains(const Polygon& polygon, const Vec2& p) {
  bool inside = false;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec2 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    if ((a.y() <= p.y()) != (b.y() <= p.y()) && p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x()))
      inside = !inside;
  }
  return inside;
}

/// Least distance between corners of one and edges of the other; 0 when a corner lies inside.
double gap_mm(const Polygon& a, const Polygon& b) {
  double minimum = 1e300;
  for (const auto& [corners, edges] : {std::pair(&a, &b), std::pair(&b, &a)})
    for (const Vec2& p : *corners) {
      if (contains(*edges, p)) return 0;
      for (std::size_t i = 0; i < edges->size(); ++i)
        minimum = std::min(minimum, distance_mm(p, (*edges)[i], (*edges)[(i + 1) % edges->size()]));
    }
  return minimum;
}

void expect_valid(const std::vector<Polygon>& shapes, const Nesting& nesting, const NestingOptions& options) {
  std::vector<Polygon> placed;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    placed.emplace_back();
    for (const Vec2& p : shapes[i]) {
      placed.back().push_back(nesting.places[i](p));
      const Vec2& q = placed.back().back();
      CHECK(q.minCoeff() >= options.margin_mm - 1e-9);
      CHECK(q.x() <= options.bed_x_mm - options.margin_mm + 1e-9);
      CHECK(q.y() <= options.bed_y_mm - options.margin_mm + 1e-9);
    }
    CHECK_THAT(signed_area_mm2(placed.back()),
               WithinAbs(signed_area_mm2(shapes[i]), 1e-9 * std::abs(signed_area_mm2(shapes[i]))));  // not mirrored
    for (std::size_t j = 0; j < i; ++j)
      if (nesting.places[i].sheet == nesting.places[j].sheet) {
        INFO(i << ' ' << j);
        CHECK(gap_mm(placed[i], placed[j]) >= options.spacing_mm - 1e-9);
      }
  }
}

/// A ring of `turn` radians, `width_mm` wide.
Polygon arc(double radius_mm, double width_mm, double turn) {
  Polygon polygon;
  const int steps = 40;
  for (int i = 0; i <= steps; ++i)
    polygon.emplace_back(radius_mm * Vec2(std::cos(turn * i / steps), std::sin(turn * i / steps)));
  for (int i = steps; i >= 0; --i)
    polygon.emplace_back((radius_mm - width_mm) * Vec2(std::cos(turn * i / steps), std::sin(turn * i / steps)));
  return polygon;
}

TEST_CASE("Nesting.KeepsSpacingMarginAndSize") {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> radius(15, 60), turn(0.5, 5.5);
  std::vector<Polygon> shapes;
  for (int i = 0; i < 25; ++i) shapes.push_back(arc(radius(random), 10, turn(random)));
  Context context;
  for (const bool keep_direction : {false, true}) {
    const NestingOptions options{300, 200, 5, 3, keep_direction};
    const Nesting nesting = nest(shapes, options, context);
    expect_valid(shapes, nesting, options);
    CHECK(nesting.sheet_count > 1);
    CHECK(nesting.sheet_count < 6);
  }
}

TEST_CASE("Nesting.HollowsAreUsed") {
  // A ring of 100 mm with a smaller one and a square inside: boxes would not share the sheet.
  const std::vector<Polygon> shapes{arc(50, 8, 5.8), arc(35, 8, 5.8), {{0, 0}, {25, 0}, {25, 25}, {0, 25}}};
  Context context;
  const NestingOptions options{118, 112, 2, 2, false};
  const Nesting nesting = nest(shapes, options, context);
  CHECK(nesting.sheet_count == 1);
  expect_valid(shapes, nesting, options);
}

TEST_CASE("Nesting.GrainLiesAlongX") {
  Polygon strip{{0, 0}, {60, 80}, {52, 86}, {-8, 6}};  // 100 by 10 mm
  Context context;
  const Nesting nesting = nest({strip}, {200, 200, 5, 2, true}, context);
  const Vec2 along = nesting.places[0](strip[1]) - nesting.places[0](strip[0]);
  CHECK_THAT(std::abs(along.x()), WithinAbs(100, 1e-9));
  CHECK_THAT(along.y(), WithinAbs(0, 1e-9));
  // Upright it would fit, but not along the grain.
  CHECK_THROWS_AS(nest({strip}, {80, 200, 5, 2, true}, context), Error);
  CHECK_NOTHROW(nest({strip}, {80, 200, 5, 2, false}, context));
}

TEST_CASE("Nesting.WhatDoesNotFitIsRefused") {
  Context context;
  try {
    nest({{{0, 0}, {100, 0}, {100, 100}, {0, 100}}}, {100, 100, 5, 2, false}, context);
    FAIL();
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::invalid_input);
    CHECK(error.where() == "bed_x_mm");
  }
}

}  // namespace
}  // namespace formwright
