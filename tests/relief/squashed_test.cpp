// SPDX-License-Identifier: GPL-3.0-or-later
// The model simply squashed into the thickness: what a relief is compared with.
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <cmath>

#include "geometry/test_meshes.h"
#include "relief/base/base_shape.h"
#include "relief/baselines.h"
#include "relief/relief.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;

ReliefOptions options_of(Projection projection, double thickness_mm = 6) {
  ReliefOptions options;
  options.width_mm = 100;
  options.thickness_mm = thickness_mm;
  options.projection = projection;
  options.appearance = Appearance::squashed;
  return options;
}

TEST_CASE("Squashed.DepthIsScaledEvenlyAndFillsTheThickness") {
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    const ReliefOptions options = options_of(projection);
    Context context;
    const TriangleMesh ball = test::icosphere(4);
    ReliefSolver solver(ball, options, context);
    const Relief relief = solver.solve(options, context);
    CHECK(relief.bound_violation_max_mm <= 0);
    CHECK(relief.order_violation_max_mm <= 0);
    CHECK_THAT(relief.energy, WithinRel(relief.energy_linear, 1e-12));
    CHECK_THAT(relief.normal_error.mean_deg, WithinRel(relief.normal_error_linear.mean_deg, 1e-12));
    const Positions& P = solver.frame().P;
    // Of what is bounded, the nearest and the farthest just fill the thickness, and depth is one straight line between.
    const auto inside = [&](Eigen::Index i) { return std::isfinite(relief.lambda_max_mm[i]); };
    Eigen::Index near = -1, far = -1;
    for (Eigen::Index i = 0; i < P.rows(); ++i) {
      if (!inside(i)) continue;
      if (near < 0 || P(i, 2) < P(near, 2)) near = i;
      if (far < 0 || P(i, 2) > P(far, 2)) far = i;
    }
    const double depth = relief.moved(far, 2) - relief.moved(near, 2);
    CHECK_THAT(depth * options.width_mm, WithinRel(options.thickness_mm, 1e-9));
    for (Eigen::Index i = 0; i < P.rows(); ++i)
      if (inside(i)) {
        const double share = (P(i, 2) - P(near, 2)) / (P(far, 2) - P(near, 2));
        CHECK_THAT(relief.moved(i, 2) - relief.moved(near, 2), WithinAbs(share * depth, 1e-12));
      }
  }
}

TEST_CASE("Squashed.KeepsToTheThicknessOnACurvedBaseAndRefusesSteps") {
  ReliefOptions options = options_of(Projection::orthographic);
  options.base = BaseShape::wave;
  Context context;
  const TriangleMesh ball = test::icosphere(4);
  ReliefSolver solver(ball, options, context);
  CHECK(solver.solve(options, BaseSurface(base_shape(options, solver.frame())), context).bound_violation_max_mm <= 0);
  options.base = BaseShape::stairs;
  const BaseSurface stairs(base_shape(options, solver.frame()), base_bands(options, solver.frame()));
  try {
    solver.solve(options, stairs, context);
    FAIL("accepted");
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::invalid_input);
    CHECK(error.where() == "appearance");
  }
}

TEST_CASE("Squashed.LooksLessLikeTheModelThanARelief") {
  ReliefOptions options = options_of(Projection::perspective, 20);
  Context context;
  // One ball stands far behind the other: squashing spends the thickness on the empty space between them.
  const TriangleMesh ball = test::icosphere(3);
  ReliefSolver solver(test::joined(ball, test::moved(ball, Vec3(1.5, 0, -6))), options, context);
  const Relief squashed = solver.solve(options, context);
  options.appearance = Appearance::detail;
  CHECK(solver.solve(options, context).normal_error.mean_deg_image < 0.9 * squashed.normal_error.mean_deg_image);
}

}  // namespace
}  // namespace formwright
