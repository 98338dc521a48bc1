// SPDX-License-Identifier: GPL-3.0-or-later
// The outline of each part of a model, and reliefs whose outline lies on the base.
#include "relief/view/outline.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/mesh/adjacency.h"
#include "geometry/test_meshes.h"
#include "relief/base/base_shape.h"
#include "relief/relief.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;

struct Outlined {
  ViewFrame frame;
  std::vector<char> outline;
  int count() const { return static_cast<int>(std::ranges::count(outline, 1)); }
};

Outlined outlined(const TriangleMesh& mesh, ReliefOptions options, Projection projection) {
  options.projection = projection;
  Outlined result{make_view_frame(mesh, options), {}};
  Context context;
  const RayCaster caster(TriangleMesh{result.frame.P, mesh.F});
  const Adjacency adjacency(mesh);
  result.outline = find_outline(result.frame, mesh.F, adjacency, vertex_components(adjacency).of, caster, context);
  return result;
}

/// Where the ray of a vertex meets the plate.
Vec2 on_plate(const ViewFrame& frame, Eigen::Index i) {
  return frame.P.row(i).head<2>().transpose() / (1 + frame.kappa * frame.P(i, 2));
}

TEST_CASE("Outline.OfACubeSeenAlongItsDiagonalHasSixCorners") {
  const TriangleMesh mesh = test::cube();
  ReliefOptions options;
  options.direction = {-1, -1, -1};
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    const Outlined found = outlined(mesh, options, projection);
    const Vec3 middle = mesh.V.colwise().mean();
    for (Eigen::Index i = 0; i < mesh.V.rows(); ++i) {
      const Vec3 corner = mesh.V.row(i).transpose() - middle;
      const bool on_the_diagonal = std::abs(std::abs(corner.sum()) - corner.cwiseAbs().sum()) < 1e-9;
      INFO(i);
      CHECK((found.outline[static_cast<std::size_t>(i)] != 0) == !on_the_diagonal);
    }
  }
}

TEST_CASE("Outline.OfASphereEnclosesADisc") {
  double before = 0;
  for (const int levels : {2, 3, 4, 5}) {
    const TriangleMesh mesh = test::icosphere(levels);
    const Outlined found = outlined(mesh, {}, Projection::orthographic);
    // Around the middle by angle: the picture of a ball is convex.
    std::vector<Vec2> points;
    for (Eigen::Index i = 0; i < mesh.V.rows(); ++i)
      if (found.outline[static_cast<std::size_t>(i)]) points.push_back(on_plate(found.frame, i));
    std::ranges::sort(points, {}, [](const Vec2& p) { return std::atan2(p.y(), p.x()); });
    double area = 0;
    for (std::size_t k = 0; k < points.size(); ++k) {
      const Vec2 &p = points[k], &q = points[(k + 1) % points.size()];
      area += 0.5 * (p.x() * q.y() - p.y() * q.x());
    }
    const double error = std::abs(1 - area / (std::numbers::pi / 4));
    INFO(levels << " levels, " << points.size() << " vertices, error " << error);
    if (before > 0) {
      CHECK(std::log2(before / error) > 1.8);
    }
    before = error;
  }
  CHECK(before < 0.002);
}

TEST_CASE("Outline.TheHoleOfATorusBelongsToItAndFoldsBeforeItDoNot") {
  const TriangleMesh mesh = test::torus(64, 32);
  const auto radii = [&](const Outlined& found) {
    std::vector<double> of;
    for (Eigen::Index i = 0; i < mesh.V.rows(); ++i)
      if (found.outline[static_cast<std::size_t>(i)]) of.push_back(on_plate(found.frame, i).norm());
    return of;
  };
  // The torus lies about the z axis: rings of radius 1 +- 0.4, seen along z 2.8 wide.
  const std::vector<double> front = radii(outlined(mesh, {}, Projection::orthographic));
  const auto near = [&](double radius) {
    return std::ranges::count_if(front, [&](double r) { return std::abs(r - radius) < 0.01; });
  };
  CHECK(near(0.5) == 64);
  CHECK(near(0.6 / 2.8) == 64);
  CHECK(front.size() == 128u);
  // From the side the hole is not seen, though the surface turns away from the viewer there, too.
  ReliefOptions side;
  side.direction = {1, 0, 0};
  side.up = {0, 0, 1};
  const Outlined found = outlined(mesh, side, Projection::orthographic);
  for (Eigen::Index i = 0; i < mesh.V.rows(); ++i)
    if (found.outline[static_cast<std::size_t>(i)]) {
      const Vec2 p = on_plate(found.frame, i);
      INFO(p.transpose());
      CHECK((std::abs(p.y()) > 0.4 / 2.8 - 0.01 || std::abs(p.x()) > 0.36));
    }
}

TEST_CASE("Outline.PartsDoNotTakeItFromEachOther") {
  const TriangleMesh one = test::icosphere(3), other = test::moved(test::icosphere(3), Vec3(0.7, 0.1, -3));
  const Outlined both = outlined(test::joined(one, other), {}, Projection::orthographic);
  const int alone = outlined(one, {}, Projection::orthographic).count();
  CHECK(both.count() == 2 * alone);
}

TEST_CASE("Outline.OfAnOpenSheetIsItsBorder") {
  const TriangleMesh mesh = test::grid(9, 7);
  const Adjacency adjacency(mesh);
  const Outlined found = outlined(mesh, {}, Projection::perspective);
  for (int i = 0; i < mesh.vertex_count(); ++i)
    CHECK((found.outline[static_cast<std::size_t>(i)] != 0) == adjacency.is_boundary_vertex(i));
}

Relief relief_of(const TriangleMesh& mesh, const ReliefOptions& options, std::vector<char>* outline = nullptr) {
  Context context;
  ReliefSolver solver(mesh, options, context);
  if (outline != nullptr) *outline = solver.visibility().outline;
  if (options.base == BaseShape::flat) return solver.solve(options, context);
  const BaseSurface base(base_shape(options, solver.frame()), base_bands(options, solver.frame()));
  return solver.solve(options, base, context);
}

/// Two balls, one before the other, and a torus beside them.
TriangleMesh group_of_three() {
  const TriangleMesh balls = test::joined(test::icosphere(3), test::moved(test::icosphere(3), Vec3(0.9, 0.3, -2.5)));
  return test::joined(balls, test::moved(test::torus(48, 24), Vec3(-2.2, 0, 0.5)));
}

TEST_CASE("Outline.LiesOnThePlateAndTheRestUsesTheThickness") {
  for (const Projection projection : {Projection::perspective, Projection::orthographic})
    for (const double carve_mm : {0.0, 2.0}) {
      ReliefOptions options;
      options.projection = projection;
      options.width_mm = 100;
      options.thickness_mm = 4;
      options.carve_depth_mm = carve_mm;
      options.outline_mm = 0.1;
      std::vector<char> outline;
      const Relief relief = relief_of(group_of_three(), options, &outline);
      double highest = 0, deepest = 0;
      for (Eigen::Index i = 0; i < relief.u.size(); ++i) {
        const double height = -100 * relief.moved(i, 2);
        if (outline[static_cast<std::size_t>(i)]) {
          CHECK(height >= -std::min(0.1, carve_mm) - 1e-9);
          CHECK(height <= 0.1 + 1e-9);
        }
        CHECK(relief.lambda_mm[i] >= relief.lambda_min_mm[i]);
        CHECK(relief.lambda_mm[i] <= relief.lambda_max_mm[i]);
        highest = std::max(highest, height);
        deepest = std::max(deepest, -height);
      }
      INFO("carved " << carve_mm);
      CHECK_THAT(highest, WithinAbs(4, 1e-6));
      CHECK(deepest <= carve_mm + 1e-9);
      CHECK(relief.bound_violation_max_mm <= 0);
      CHECK(relief.order_rows > 100);
      CHECK(relief.order_rows_left_out == 0);
      CHECK(relief.order_violation_max_mm < 1e-5);
    }
}

TEST_CASE("Outline.LiesOnEveryBase") {
  for (const BaseShape base : {BaseShape::cylinder, BaseShape::wave, BaseShape::groove, BaseShape::stairs}) {
    ReliefOptions options;
    options.width_mm = 100;
    options.thickness_mm = 4;
    options.base = base;
    options.base_depth_mm = 12;
    options.base_pitch_mm = 80;
    options.outline_mm = 0.2;
    std::vector<char> outline;
    const Relief relief = relief_of(group_of_three(), options, &outline);
    ReliefOptions thin = options;
    thin.outline_mm.reset();
    thin.thickness_mm = 0.2;
    const Relief within = relief_of(group_of_three(), thin);
    for (Eigen::Index i = 0; i < relief.u.size(); ++i)
      if (outline[static_cast<std::size_t>(i)]) {
        // The space of an outline is that of a relief which is so thin everywhere.
        CHECK_THAT(relief.lambda_min_mm[i], WithinRel(within.lambda_min_mm[i], 1e-12));
        CHECK_THAT(relief.lambda_max_mm[i], WithinRel(within.lambda_max_mm[i], 1e-12));
        CHECK(relief.lambda_mm[i] >= relief.lambda_min_mm[i]);
        CHECK(relief.lambda_mm[i] <= relief.lambda_max_mm[i]);
      }
  }
}

TEST_CASE("Outline.AsFarAsTheThicknessChangesNothing") {
  ReliefOptions options;
  options.thickness_mm = 4;
  const Relief free = relief_of(group_of_three(), options);
  options.outline_mm = 4;
  const Relief same = relief_of(group_of_three(), options);
  CHECK(free.u == same.u);
}

TEST_CASE("Outline.HoldsInTheBalancedAppearance") {
  ReliefOptions options;
  options.width_mm = 100;
  options.thickness_mm = 5;
  options.outline_mm = 0.2;
  options.appearance = Appearance::balanced;
  std::vector<char> outline;
  const Relief relief = relief_of(group_of_three(), options, &outline);
  for (Eigen::Index i = 0; i < relief.u.size(); ++i)
    if (outline[static_cast<std::size_t>(i)]) CHECK(-100 * relief.moved(i, 2) <= 0.2 + 1e-9);
  CHECK(relief.bound_violation_max_mm <= 0);
  CHECK(relief.balanced_steps > 0);
}

}  // namespace
}  // namespace formwright
