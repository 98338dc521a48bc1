// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/base/base_shape.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/generators/catch_generators.hpp>
#include <catch2/matchers/catch_matchers.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>

#include <cmath>
#include <numbers>

#include "geometry/test_meshes.h"
#include "relief/base/base_surface.h"

namespace formwright {
namespace {
using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::WithinAbs;

ReliefOptions on(BaseShape shape, Projection projection = Projection::perspective) {
  ReliefOptions options;
  options.width_mm = 100;
  options.margin_mm = 10;
  options.base = shape;
  options.base_depth_mm = 20;
  options.base_pitch_mm = 60;
  options.projection = projection;
  return options;
}

/// Depth of the shapes in units of the width, by their definition, at a place t across them.
double depth_of(const ReliefOptions& options, double t) {
  const double d = options.base_depth_mm / options.width_mm, pitch = *options.base_pitch_mm / options.width_mm;
  if (options.base == BaseShape::wave) return d * std::pow(std::sin(std::numbers::pi * t / pitch), 2);
  if (options.base == BaseShape::groove) return d * std::max(0.0, 1 - std::abs(t) / (pitch / 2));
  const double half = 0.6, radius = (half * half + d * d) / (2 * d);
  return radius - std::sqrt(radius * radius - t * t);
}

TEST_CASE("BaseShape.IsWhatItsNameSays") {
  for (const BaseShape shape : {BaseShape::cylinder, BaseShape::wave, BaseShape::groove}) {
    INFO(static_cast<int>(shape));
    const ReliefOptions options = on(shape);
    const BaseSurface base(base_shape(options, make_view_frame(test::icosphere(2), options)));
    for (const double t : {-0.59, -0.3001, -0.17, 0.0, 0.04, 0.2999, 0.6})
      for (const double along : {-0.5, 0.0, 0.31})
        CHECK_THAT(base.depth_at(t, along).value(), WithinAbs(depth_of(options, t), 1e-5 * 0.2));
  }
}

TEST_CASE("BaseShape.TurnsOnThePlate") {
  ReliefOptions options = on(BaseShape::groove);
  options.base_turn_deg = 30;
  const BaseSurface base(base_shape(options, make_view_frame(test::icosphere(2), options)));
  const double c = std::cos(std::numbers::pi / 6), s = std::sin(std::numbers::pi / 6);
  for (const double t : {-0.2, 0.0, 0.1, 0.4})
    for (const double along : {-0.3, 0.2})
      CHECK_THAT(base.depth_at(c * t - s * along, s * t + c * along).value(), WithinAbs(depth_of(options, t), 1e-12));
}

TEST_CASE("BaseShape.IsShiftedAcrossItsDirectionBeforeItIsTurned") {
  const ViewFrame frame = make_view_frame(test::icosphere(2), on(BaseShape::flat));
  const double angle = GENERATE(0.0, 30.0, -90.0), shift = GENERATE(-0.25, 0.1);
  const double c = std::cos(angle * std::numbers::pi / 180), s = std::sin(angle * std::numbers::pi / 180);
  for (const BaseShape shape : {BaseShape::cylinder, BaseShape::wave, BaseShape::groove}) {
    INFO(static_cast<int>(shape));
    ReliefOptions options = on(shape), still = options;
    still.base_turn_deg = options.base_turn_deg = angle;
    options.base_shift_mm = shift * options.width_mm;
    const BaseSurface base(base_shape(options, frame)), before(base_shape(still, frame));
    // The whole plate is covered, its corners, too.
    for (const double x : {-0.6, -0.1, 0.23, 0.6})
      for (const double y : {-0.6, 0.0, 0.6}) {
        REQUIRE(base.depth_at(x, y).has_value());
        const double t = c * x + s * y, along = c * y - s * x;
        if (std::abs(t - shift) > 0.55 || std::abs(along) > 0.55) continue;
        const double there = before.depth_at(c * (t - shift) - s * along, s * (t - shift) + c * along).value();
        // Other places of the wave are sampled.
        CHECK_THAT(base.depth_at(x, y).value(), WithinAbs(there, shape == BaseShape::wave ? 1e-5 * 0.2 : 1e-12));
      }
  }
}

TEST_CASE("BaseBands.AreShiftedWithTheirBorders") {
  ReliefOptions options = on(BaseShape::stairs);
  options.base_steps = 3;
  const ViewFrame frame = make_view_frame(test::icosphere(2), options);
  const BaseBands still = base_bands(options, frame).value();
  options.base_shift_mm = 7;
  const BaseBands shifted = base_bands(options, frame).value();
  REQUIRE(shifted.border().size() == 2);
  for (const std::size_t k : {0U, 1U}) CHECK_THAT(shifted.border()[k], WithinAbs(still.border()[k] + 0.07, 1e-15));
  const BaseSurface base(base_shape(options, frame));
  CHECK_THAT(base.depth_at(0, shifted.border()[0] - 1e-6).value(), WithinAbs(0, 1e-12));
  CHECK_THAT(base.depth_at(0, shifted.border()[0] + 1e-6).value(), WithinAbs(0.1, 1e-12));
}

TEST_CASE("BaseShape.TakesTheWidthOfThePlateWithoutAPitch") {
  ReliefOptions options = on(BaseShape::groove);
  options.base_pitch_mm.reset();
  const BaseSurface base(base_shape(options, make_view_frame(test::icosphere(2), options)));
  CHECK_THAT(base.depth_at(0, 0).value(), WithinAbs(0.2, 1e-12));
  CHECK_THAT(base.depth_at(0.3, 0).value(), WithinAbs(0.1, 1e-12));
  CHECK_THAT(base.depth_at(0.6, 0).value(), WithinAbs(0, 1e-12));
}

TEST_CASE("BaseShape.IsMetByEveryRay") {
  // The flank of a groove, on the ray from the viewpoint (0, 0, -D) through p, in closed form.
  const ReliefOptions options = on(BaseShape::groove);
  const TriangleMesh ball = test::icosphere(3);
  const ViewFrame frame = make_view_frame(ball, options);
  const BaseSurface base(base_shape(options, frame));
  const double distance = 1 / frame.kappa, depth = 0.2, half = 0.3;
  for (const double shift : {0.0, -0.05, 0.02})
    for (Eigen::Index i = 0; i < frame.P.rows(); ++i) {
      const double slope = std::abs(frame.P(i, 0)) / (frame.P(i, 2) + distance);  // |x| = slope (z + D)
      const double on_flank = (depth + shift - depth / half * slope * distance) / (1 + depth / half * slope);
      CHECK_THAT(base.depth_on_ray(frame, i, shift).value(), WithinAbs(std::max(shift, on_flank), 1e-12));
    }
}

TEST_CASE("BaseBands.RaysMeetTheStepOrTheWallBeforeIt") {
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    ReliefOptions options = on(BaseShape::stairs, projection);
    options.base_steps = 3;
    const ViewFrame frame = make_view_frame(test::icosphere(3), options);
    const auto bands = base_bands(options, frame);
    REQUIRE(bands.has_value());
    CHECK(bands->depth(0) == 0);
    CHECK_THAT(bands->depth(2), WithinAbs(0.2, 1e-15));
    const BaseSurface rays(base_shape(options, frame));  // the mesh alone, without what the bands say of it
    int on_walls = 0;
    for (Eigen::Index i = 0; i < frame.P.rows(); ++i) {
      const Vec3 p = frame.P.row(i).transpose();
      const double t = bands->on_plate(frame, p);
      if (std::abs(t - bands->border_on_plate(frame, 0)) < 1e-9 ||
          std::abs(t - bands->border_on_plate(frame, 1)) < 1e-9)
        continue;  // through an edge: either side
      const int band = bands->of_ray(frame, p);
      const double depth = rays.depth_on_ray(frame, i, 0).value();
      const bool is_on_step = std::abs(depth - bands->depth(band)) < 1e-12;
      const bool is_on_wall = band > 0 && depth > bands->depth(band - 1) && depth < bands->depth(band) && t < 0;
      CHECK((is_on_step || is_on_wall));
      on_walls += !is_on_step;
    }
    CHECK((on_walls > 0) == (projection == Projection::perspective));
  }
}

TEST_CASE("BaseShape.ReachesAsDeepAsItSays") {
  for (const BaseShape shape : {BaseShape::cylinder, BaseShape::wave, BaseShape::groove}) {
    const ReliefOptions options = on(shape);
    const BaseSurface base(base_shape(options, make_view_frame(test::icosphere(2), options)));
    const auto [least, largest] = base.depth_range(0.6, 0.6).value();
    CHECK_THAT(least, WithinAbs(0, 2e-6));
    CHECK_THAT(largest, WithinAbs(0.2, 2e-6));
  }
  // A part of the groove, cut through its flanks.
  const ReliefOptions options = on(BaseShape::groove);
  const BaseSurface base(base_shape(options, make_view_frame(test::icosphere(2), options)));
  const auto [least, largest] = base.depth_range(0.15, 0.2).value();
  CHECK_THAT(least, WithinAbs(0.1, 1e-12));
  CHECK_THAT(largest, WithinAbs(0.2, 1e-12));
}

TEST_CASE("BaseShape.AFileIsTurnedAboutItsOriginThenMoved") {
  ReliefOptions options;
  options.width_mm = 50;
  options.base_mesh_turn_deg = 90;
  options.base_mesh_x_mm = 10;
  options.base_mesh_y_mm = -5;
  options.base_mesh_z_mm = 2;
  TriangleMesh mesh = test::tetrahedron();
  mesh.V.row(0) << 20, 0, 1;  // right of the middle, so turned to above it
  const TriangleMesh base = base_from_file(mesh, options);
  CHECK_THAT(base.V(0, 0), WithinAbs(10.0 / 50, 1e-15));
  CHECK_THAT(base.V(0, 1), WithinAbs((20.0 - 5) / 50, 1e-15));
  CHECK_THAT(base.V(0, 2), WithinAbs(-(1.0 + 2) / 50, 1e-15));  // view coordinates count away from the viewer
}

TEST_CASE("BaseShape.RefusesWhatCannotBe") {
  const ViewFrame frame = make_view_frame(test::icosphere(2), on(BaseShape::cylinder));
  ReliefOptions options = on(BaseShape::cylinder);
  options.base_depth_mm = 60;
  CHECK_THROWS_AS(base_shape(options, frame), Error);
  options = on(BaseShape::wave);
  options.base_pitch_mm = 0.5;
  CHECK_THROWS_AS(base_shape(options, frame), Error);
  // Half a plate of 120 mm, and one of three steps.
  options = on(BaseShape::groove);
  options.base_shift_mm = -60.01;
  CHECK_THROWS_WITH(base_shape(options, frame), ContainsSubstring("shift it by less than 60 mm"));
  options = on(BaseShape::stairs);
  options.base_steps = 3;
  options.base_shift_mm = 41;
  CHECK_THROWS_WITH(base_shape(options, frame), ContainsSubstring("one step"));
  options.base_shift_mm = 1000;
  options.base = BaseShape::strips;
  CHECK_NOTHROW(base_shape(options, frame));
  CHECK_THROWS_AS(base_from_file(TriangleMesh{Positions(0, 3), Triangles(0, 3)}, options), Error);
}

}  // namespace
}  // namespace formwright
