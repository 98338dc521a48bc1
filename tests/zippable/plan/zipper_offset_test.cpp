// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/plan/pieces/zipper_offset.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <numbers>

#include "base/error.h"
#include "zippable/plan/planned.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

struct Curve {
  std::vector<Vec3> points, left;
};

/// Over t in [0, 1]; left along the surface from its normal.
Curve sampled(int count, const std::function<Vec3(double)>& point, const std::function<Vec3(double)>& normal) {
  Curve curve;
  for (int i = 0; i < count; ++i) {
    const double t = static_cast<double>(i) / (count - 1), step = 1e-5;
    curve.points.push_back(point(t));
    curve.left.push_back(normal(t).cross(point(t + step) - point(t - step)).normalized());
  }
  return curve;
}

Curve helix(int count, double radius, double rise, double turns) {
  const auto angle = [=](double t) { return 2 * std::numbers::pi * turns * t; };
  return sampled(
      count, [=](double t) { return Vec3(radius * std::cos(angle(t)), radius * std::sin(angle(t)), rise * turns * t); },
      [=](double t) { return Vec3(std::cos(angle(t)), std::sin(angle(t)), 0); });
}

Curve spiral_on_cone(int count) {
  const auto radius = [](double t) { return 40 - 25 * t; };
  const auto angle = [](double t) { return 8 * std::numbers::pi * t; };
  return sampled(
      count, [=](double t) { return Vec3(radius(t) * std::cos(angle(t)), radius(t) * std::sin(angle(t)), 100 * t); },
      [=](double t) { return Vec3(std::cos(angle(t)), std::sin(angle(t)), 0.25); });
}

double moved_length(const Curve& curve, const BinormalField& field, double distance) {
  double length = 0;
  for (std::size_t i = 0; i + 1 < curve.points.size(); ++i)
    length += (curve.points[i + 1] - curve.points[i] + distance * (field.left[i + 1] - field.left[i])).norm();
  return length;
}

TEST_CASE("Binormals.OfAHelixAreItsOwnAndLengthsTendToTheFormula") {
  // Speed of the offset: sqrt(1 + (w torsion)^2), torsion = c / (r^2 + c^2) with c the rise by radian (Appendix C).
  const double radius = 30, rise = 60, turns = 3, w = 4, c = rise / (2 * std::numbers::pi);
  const double exact =
      2 * std::numbers::pi * turns * std::hypot(radius, c) * std::hypot(1.0, w * c / (radius * radius + c * c));
  const auto error = [&](int count) {
    const Curve curve = helix(count, radius, rise, turns);
    const BinormalField field = binormals(curve.points, curve.left, 0);
    for (const char usable : field.usable) CHECK(usable);
    const double left = moved_length(curve, field, w), right = moved_length(curve, field, -w);
    CHECK_THAT(left, WithinAbs(right, 1e-10 * left));
    return std::abs(left - exact);
  };
  const double coarse = error(201), fine = error(401), finest = error(801);
  CHECK(finest < 0.05);
  CHECK(std::log2(coarse / fine) > 0.9);
  CHECK(std::log2(fine / finest) > 0.9);
}

TEST_CASE("Binormals.BothSidesAreEquallyLongSegmentBySegmentWhateverTheWindow") {
  for (const double window : {0.0, 8.0, 20.0}) {
    const Curve curve = spiral_on_cone(300);
    const BinormalField field = binormals(curve.points, curve.left, window);
    for (std::size_t i = 0; i + 1 < curve.points.size(); ++i) {
      if (!field.usable[i] || !field.usable[i + 1]) continue;
      const Vec3 step = curve.points[i + 1] - curve.points[i], turn = 4 * (field.left[i + 1] - field.left[i]);
      {
        INFO(i);
        CHECK_THAT((step + turn).norm(), WithinAbs((step - turn).norm(), 1e-12 * step.norm() * 100));
      }
      CHECK_THAT(field.left[i].norm(), WithinAbs(1, 0.02));
      CHECK(field.left[i].dot(curve.left[i]) > 0.4);
    }
    CHECK_THAT(moved_length(curve, field, 4), WithinAbs(moved_length(curve, field, -4), 1e-9));
  }
}

TEST_CASE("Binormals.TheyTendToThoseOfTheCurveWithSampling") {
  // At the middle of the cone's spiral; the reference from derivatives by finite differences.
  const auto point = [](double t) {
    const double r = 40 - 25 * t, a = 8 * std::numbers::pi * t;
    return Vec3(r * std::cos(a), r * std::sin(a), 100 * t);
  };
  const double h = 1e-4;
  const Vec3 first = (point(0.5 + h) - point(0.5 - h)) / (2 * h),
             second = (point(0.5 + h) - 2 * point(0.5) + point(0.5 - h)) / (h * h);
  const Vec3 exact = first.cross(second).normalized();
  const auto error = [&](int count) {
    const Curve curve = spiral_on_cone(count);
    const Vec3 found = binormals(curve.points, curve.left, 0).left[std::size_t(count / 2)];
    return std::min((found - exact).norm(), (found + exact).norm());
  };
  const double coarse = error(101), fine = error(201), finest = error(401);
  CHECK(finest < 0.01);
  CHECK(std::log2(coarse / fine) > 0.8);
  CHECK(std::log2(fine / finest) > 0.8);
}

TEST_CASE("Binormals.AStraightWayFollowsTheSurface") {
  std::vector<Vec3> points, left(20, Vec3::UnitY());
  for (int i = 0; i < 20; ++i) points.emplace_back(i, 0, 0);
  const BinormalField field = binormals(points, left, 5);
  for (std::size_t i = 0; i < 20; ++i) {
    CHECK_FALSE(field.usable[i]);
    CHECK(field.left[i] == left[i]);
  }
}

TEST_CASE("ZipperOffset.AStripGetsNarrowerAndKeepsItsLength") {
  const OffsetRibbon ribbon = offset_ribbon(test::strip(200, 20, 41), ZipperOffset::sewing, 3);
  for (std::size_t v = 0; v < 41; ++v) CHECK_THAT(ribbon.flat_mm[v].y(), WithinAbs(3, 1e-12));
  for (std::size_t v = 41; v < 82; ++v) CHECK_THAT(ribbon.flat_mm[v].y(), WithinAbs(17, 1e-12));
  CHECK_THAT(ribbon.left_mm, WithinAbs(200, 1e-9));
  CHECK_THAT(ribbon.right_mm, WithinAbs(200, 1e-9));
  CHECK(ribbon.narrow_samples == 0);
  CHECK(ribbon.narrow_mm == 0);
}

TEST_CASE("ZipperOffset.ARibbonTooNarrowIsRefused") {
  try {
    offset_ribbon(test::strip(200, 2, 41), ZipperOffset::sewing, 3);
    FAIL();
  } catch (const Error& error) {
    CHECK(error.where() == "coil");
    CHECK(std::string(error.what()).find("6.0 mm") != std::string::npos);
  }
}

TEST_CASE("ZipperOffset.GluedSidesAreEquallyLongOnAWholeModel") {
  const FlatDesign design = test::designed("heart", 40, 300);
  const OffsetRibbon ribbon = offset_ribbon(design, ZipperOffset::gluing, 2.9);
  CHECK(ribbon.sides_made_equal);
  CHECK_THAT(ribbon.left_mm, WithinAbs(ribbon.right_mm, 1e-9 * ribbon.left_mm));
  CHECK_THAT(ribbon.left_mm, WithinAbs(design.zipper_mm, 0.02 * design.zipper_mm));
}

TEST_CASE("ZipperOffset.NoTriangleTurnsOverAndNothingMovesFartherThanAsked") {
  for (const char* sample : {"t_shape", "star", "octopus"}) {
    const FlatDesign design = test::designed(sample, 20);
    for (const ZipperOffset method : {ZipperOffset::sewing, ZipperOffset::gluing}) {
      const OffsetRibbon ribbon = offset_ribbon(design, method, 2.9);
      for (Eigen::Index f = 0; f < design.F.rows(); ++f) {
        const Vec2 a = ribbon.flat_mm[design.F(f, 1)] - ribbon.flat_mm[design.F(f, 0)],
                   b = ribbon.flat_mm[design.F(f, 2)] - ribbon.flat_mm[design.F(f, 0)];
        INFO(sample << ' ' << f);
        CHECK(a.x() * b.y() - a.y() * b.x() >= -1e-9);
      }
      {
        INFO(sample);
        CHECK(ribbon.offset_mean_mm >= 0.5 * 2.9);
        CHECK_THAT(ribbon.left_mm, WithinAbs(design.zipper_mm, 0.15 * design.zipper_mm));
      }
      if (method == ZipperOffset::gluing) {
        {
          INFO(sample);
          CHECK(ribbon.binormal_share > 0.3);
        }
        if (ribbon.sides_made_equal) {
          {
            INFO(sample);
            CHECK_THAT(ribbon.left_mm, WithinAbs(ribbon.right_mm, 1e-9 * ribbon.left_mm));
          }
          CHECK(ribbon.shear_max_mm <= 2.9);
        }
      }
    }
    // Without room for a zipper the sides are those of the design, equally long.
    const OffsetRibbon paper = offset_ribbon(design, ZipperOffset::sewing, 0);
    CHECK_THAT(paper.left_mm, WithinAbs(paper.right_mm, 1e-6 * paper.left_mm));
    CHECK_THAT(paper.left_mm, WithinAbs(design.zipper_mm, 1e-6 * paper.left_mm));
  }
}

}  // namespace
}  // namespace formwright
