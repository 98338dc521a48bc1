// SPDX-License-Identifier: GPL-3.0-or-later
// Reliefs on other bases than a flat plate: bounds, solids, files.
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <array>
#include <cmath>

#include "geometry/mesh/adjacency.h"
#include "geometry/mesh/measures.h"
#include "geometry/test_meshes.h"
#include "relief/base/base_shape.h"
#include "relief/height_map.h"
#include "relief/relief.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;

ReliefOptions groove(Projection projection) {
  ReliefOptions options;
  options.width_mm = 100;
  options.thickness_mm = 1;
  options.carve_depth_mm = 6;
  options.base = BaseShape::groove;
  options.base_depth_mm = 30;
  options.base_pitch_mm = 80;
  options.projection = projection;
  return options;
}

/// Heights of that groove above the plate's front, mm.
double groove_mm(double x_mm) { return -30 * std::max(0.0, 1 - std::abs(x_mm) / 40); }

struct Solved {
  ReliefOptions options;
  BaseSurface base;
  Triangles F;
  ViewFrame frame;
  Relief relief;
};

Solved solved(const TriangleMesh& mesh, const ReliefOptions& options) {
  Context context;
  ReliefSolver solver(mesh, options, context);
  const BaseSurface base(base_shape(options, solver.frame()));
  return {options, base, solver.F(), solver.frame(), solver.solve(options, base, context)};
}

/// A rectangle across the view, 100 mm beyond all sides, `height_mm` towards the viewer and tilted by `slope` along x.
TriangleMesh plane_mm(double half_mm, double height_mm, double slope = 0) {
  TriangleMesh mesh;
  mesh.V.resize(4, 3);
  for (int i = 0; i < 4; ++i) {
    const double x = i & 1 ? half_mm : -half_mm, y = i & 2 ? half_mm : -half_mm;
    mesh.V.row(i) << x, y, height_mm + slope * x;
  }
  mesh.F.resize(2, 3);
  mesh.F << 0, 1, 2, 1, 3, 2;
  return mesh;
}

TEST_CASE("ReliefOnBase.EveryVertexIsWithinItsBounds") {
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    const Solved s = solved(test::icosphere(4), groove(projection));
    double max_above = -1e9, max_below = -1e9;
    for (Eigen::Index i = 0; i < s.relief.moved.rows(); ++i) {
      CHECK(s.relief.lambda_mm[i] >= s.relief.lambda_min_mm[i]);
      CHECK(s.relief.lambda_mm[i] <= s.relief.lambda_max_mm[i]);
      const double above = -100 * s.relief.moved(i, 2) - groove_mm(100 * s.relief.moved(i, 0));
      max_above = std::max(max_above, above);
      max_below = std::max(max_below, -above);
    }
    CHECK(s.relief.bound_violation_max_mm <= 0);
    // The space is used up to both limits, and not left.
    CHECK_THAT(max_above, WithinAbs(1, 1e-9));
    CHECK_THAT(max_below, WithinAbs(6, 1e-9));
    CHECK(s.relief.vertices_beyond_base == 0);
  }
}

TEST_CASE("ReliefOnBase.TheSolidStaysInTheAllowedSpace") {
  const Solved s = solved(test::icosphere(4), groove(Projection::perspective));
  Context context;
  const AllowedSpace space{s.base, s.options.thickness_mm, s.options.carve_depth_mm};
  const PlateSize plate{120, 110};
  const HeightMap map = make_height_map({s.relief.moved, s.F}, 100, plate, 0.5, space, context);
  CHECK_THAT(map.floor_mm, WithinAbs(-36, 1e-9));
  CHECK_THAT(map.top_mm, WithinAbs(1, 1e-9));
  int carved = 0, raised = 0;
  for (int row = 0; row < map.rows; ++row)
    for (int column = 0; column < map.columns; ++column) {
      const double above = static_cast<double>(map.at(row, column)) - groove_mm(column * map.pitch_x_mm - 60);
      REQUIRE(above <= 1 + 1e-5);
      REQUIRE(above >= -6 - 1e-5);
      carved += above < -1e-3;
      raised += above > 1e-3;
    }
  CHECK(carved > 5000);
  CHECK(raised > 100);

  const double tolerance_mm = 1e-3;
  const TriangleMesh solid = make_solid(map, 3, tolerance_mm, context);
  CHECK(Adjacency(solid).is_closed());
  CHECK_THAT(solid.V.col(2).minCoeff(), WithinAbs(0, 0));
  CHECK(solid.V.col(2).maxCoeff() <= 3 + 37 + 1e-5);
  CHECK(solid.V.col(2).minCoeff() >= 0);
}

TEST_CASE("ReliefOnBase.BesideTheModelIsTheBase") {
  // A base without a relief on it: the volume of a plate with a groove, in closed form, at two resolutions.
  ReliefOptions options = groove(Projection::orthographic);
  const ViewFrame frame = make_view_frame(test::icosphere(2), options);
  const BaseSurface base(base_shape(options, frame));
  Context context;
  const AllowedSpace space{base, 1, 0};
  const double exact = 100 * 100 * (5 + 30) - 0.5 * 80 * 30 * 100;
  for (const double pixel : {4.0, 2.0, 1.0}) {
    const HeightMap map = make_height_map({Positions(0, 3), Triangles(0, 3)}, 100, {100, 100}, pixel, space, context);
    // The grid has nodes at the groove's bottom and at its edges: nothing but the rounding of heights is left.
    CHECK_THAT(signed_volume(make_solid(map, 5, 1e-9, context)), WithinRel(exact, 2e-6));
  }
}

ReliefOptions stairs(Projection projection, int steps, double depth_mm) {
  ReliefOptions options;
  options.width_mm = 100;
  options.thickness_mm = 4;
  options.base = BaseShape::stairs;
  options.base_depth_mm = depth_mm;
  options.base_steps = steps;
  options.projection = projection;
  return options;
}

Solved solved_on_stairs(const TriangleMesh& mesh, const ReliefOptions& options) {
  Context context;
  ReliefSolver solver(mesh, options, context);
  const BaseSurface base(base_shape(options, solver.frame()), base_bands(options, solver.frame()));
  return {options, base, solver.F(), solver.frame(), solver.solve(options, base, context)};
}

TEST_CASE("ReliefOnStairs.EachPieceStandsOnItsStep") {
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    const Solved s = solved_on_stairs(test::icosphere(4), stairs(projection, 4, 60));
    const ReliefPieces& pieces = s.relief.pieces;
    REQUIRE(pieces.band.size() >= static_cast<std::size_t>(s.F.rows()));
    std::vector<int> band_of(static_cast<std::size_t>(pieces.V.rows()), -1);
    for (Eigen::Index f = 0; f < pieces.F.rows(); ++f)
      for (int k = 0; k < 3; ++k) {
        int& band = band_of[static_cast<std::size_t>(pieces.F(f, k))];
        REQUIRE((band == -1 || band == pieces.band[static_cast<std::size_t>(f)]));  // no vertex in two pieces
        band = pieces.band[static_cast<std::size_t>(f)];
      }
    std::array<double, 4> nearest{9, 9, 9, 9}, farthest{-9, -9, -9, -9};
    for (Eigen::Index i = 0; i < pieces.V.rows(); ++i) {
      const auto band = static_cast<std::size_t>(band_of[static_cast<std::size_t>(i)]);
      nearest[band] = std::min(nearest[band], pieces.V(i, 2));
      farthest[band] = std::max(farthest[band], pieces.V(i, 2));
    }
    for (std::size_t k = 0; k < 4; ++k) {
      const double step = 0.2 * static_cast<double>(k);
      CHECK(nearest[k] >= step - 0.04 - 1e-12);
      CHECK(farthest[k] <= step + 1e-12);
    }
    for (Eigen::Index i = 0; i < s.relief.u.size(); ++i) {
      CHECK(s.relief.lambda_mm[i] >= s.relief.lambda_min_mm[i]);
      CHECK(s.relief.lambda_mm[i] <= s.relief.lambda_max_mm[i]);
    }
  }
}

TEST_CASE("ReliefOnStairs.TheCutsKeepThePicture") {
  // Every vertex stays on its ray, and the pieces cover the picture once: their areas there add up to that of the
  // model.
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    const Solved s = solved_on_stairs(test::icosphere(3), stairs(projection, 5, 50));
    const auto covered = [&](const Positions& V, const Triangles& F) {
      double sum = 0;
      for (Eigen::Index f = 0; f < F.rows(); ++f) {
        Vec2 p[3];
        for (int k = 0; k < 3; ++k) {
          const Vec3 x = V.row(F(f, k)).transpose();
          p[k] = x.head<2>() / (1 + s.frame.kappa * x.z());
        }
        sum +=
            std::abs((p[1].x() - p[0].x()) * (p[2].y() - p[0].y()) - (p[1].y() - p[0].y()) * (p[2].x() - p[0].x())) / 2;
      }
      return sum;
    };
    CHECK_THAT(covered(s.relief.pieces.V, s.relief.pieces.F), WithinRel(covered(s.frame.P, s.F), 1e-9));
    // New corners lie exactly on the borders.
    for (int k = 0; k + 1 < s.base.bands()->count(); ++k) {
      int on = 0;
      for (Eigen::Index i = 0; i < s.relief.pieces.V.rows(); ++i)
        on += std::abs(s.base.bands()->on_plate(s.frame, s.relief.pieces.V.row(i).transpose()) -
                       s.base.bands()->border_on_plate(s.frame, k)) < 1e-12;
      CHECK(on >= 16);
    }
  }
}

TEST_CASE("ReliefOnStairs.StepsOfOneHeightAreAPlate") {
  // One group of bounds against several that may move by themselves: never worse.
  const TriangleMesh mesh = test::icosphere(3);
  ReliefOptions flat = stairs(Projection::orthographic, 3, 1e-2);
  flat.base = BaseShape::flat;
  Context context;
  ReliefSolver solver(mesh, flat, context);
  const Relief plate = solver.solve(flat, context);
  const Solved steps = solved_on_stairs(mesh, stairs(Projection::orthographic, 3, 1e-2));
  CHECK(steps.relief.energy <= plate.energy * (1 + 1e-9));
}

TEST_CASE("ReliefOnStairs.BothMethodsFindTheSameThinRelief") {
  // Both methods find the optimum. The interior point begins within the bounds, not where the exchange stood when its
  // work ran out: pieces that nothing holds yet lie far away there.
  TriangleMesh mesh = test::icosphere(5);
  for (Eigen::Index i = 0; i < mesh.V.rows(); ++i)
    mesh.V.row(i) *= 1 + 0.1 * std::sin(9 * mesh.V(i, 0)) * std::sin(7 * mesh.V(i, 1)) * std::sin(8 * mesh.V(i, 2));
  ReliefOptions options = stairs(Projection::perspective, 5, 60);
  options.thickness_mm = 1;
  options.method = QpMethod::exchange;
  const Relief exchange = solved_on_stairs(mesh, options).relief;
  options.method = QpMethod::interior_point;
  const Relief point = solved_on_stairs(mesh, options).relief;
  CHECK_THAT(point.qp.objective, WithinRel(exchange.qp.objective, 1e-6));
  CHECK(point.qp.interior_point_iterations < 25);
  CHECK_THAT(point.energy, WithinRel(exchange.energy, 1e-6));
}

TEST_CASE("ReliefOnStairs.TheSolidHasOneReliefAStep") {
  const Solved s = solved_on_stairs(test::icosphere(4), stairs(Projection::perspective, 4, 60));
  Context context;
  const AllowedSpace space{s.base, 4, 0};
  const CoveringMesh mesh{s.relief.pieces.V, s.relief.pieces.F, &s.relief.pieces.band};
  const HeightMap map = make_height_map(mesh, 100, {100, 100}, 0.5, space, context);
  int raised = 0;
  for (int row = 0; row < map.rows; ++row)
    for (int column = 0; column < map.columns; ++column) {
      const double y_mm = row * map.pitch_y_mm - 50;
      if (std::abs(y_mm / 25 - std::round(y_mm / 25)) < 1e-6) continue;  // on a border: either step
      const int step = std::min(3, static_cast<int>(std::floor((y_mm + 50) / 25)));
      const double above = static_cast<double>(map.at(row, column)) + 20 * step;
      REQUIRE(above >= -1e-5);
      REQUIRE(above <= 4 + 1e-5);
      raised += above > 0.5;
    }
  CHECK(raised > 5000);
  CHECK(Adjacency(make_solid(map, 3, 1e-3, context)).is_closed());
}

TEST_CASE("ReliefOnBase.AFlatBaseFromAFileIsThePlate") {
  ReliefOptions options;
  options.width_mm = 100;
  Context context;
  const TriangleMesh mesh = test::icosphere(3);
  ReliefSolver solver(mesh, options, context);
  const Relief plain = solver.solve(options, context);
  const Relief same = solver.solve(options, BaseSurface(base_from_file(plane_mm(200, 0), options)), context);
  CHECK((plain.moved - same.moved).cwiseAbs().maxCoeff() <= 1e-9);
  CHECK_THAT(same.energy, WithinAbs(plain.energy, 1e-9 * plain.energy));
  CHECK_THAT(same.energy_linear, WithinAbs(plain.energy_linear, 1e-9 * plain.energy_linear));
}

TEST_CASE("ReliefOnBase.ABaseFartherAwayOnlyShiftsAFarView") {
  ReliefOptions options;
  options.width_mm = 100;
  options.projection = Projection::orthographic;
  Context context;
  ReliefSolver solver(test::icosphere(3), options, context);
  const Relief plain = solver.solve(options, context);
  const Relief behind = solver.solve(options, BaseSurface(base_from_file(plane_mm(200, -12), options)), context);
  CHECK((behind.moved.col(2) - plain.moved.col(2)).isApproxToConstant(0.12, 1e-9));
}

TEST_CASE("ReliefOnBase.AMovedFileIsAFileThatLiesThere") {
  ReliefOptions options;
  options.width_mm = 100;
  options.projection = Projection::orthographic;
  Context context;
  ReliefSolver solver(test::icosphere(3), options, context);
  const Relief there = solver.solve(options, BaseSurface(base_from_file(plane_mm(200, -12), options)), context);
  ReliefOptions moved = options;
  moved.base_mesh_z_mm = -12;
  moved.base_mesh_x_mm = 30;
  moved.base_mesh_turn_deg = 40;
  const Relief brought = solver.solve(moved, BaseSurface(base_from_file(plane_mm(200, 0), moved)), context);
  CHECK((brought.moved - there.moved).cwiseAbs().maxCoeff() <= 1e-9);
}

TEST_CASE("ReliefOnBase.WhatHasNoBaseBehindItIsFreeOrRefused") {
  ReliefOptions options;
  options.width_mm = 100;
  Context context;
  ReliefSolver solver(test::icosphere(3), options, context);
  const BaseSurface small(base_from_file(plane_mm(30, 0), options));
  CHECK_THROWS_AS(solver.solve(options, small, context), Error);
  options.base_misses = BaseMisses::free;
  const Relief relief = solver.solve(options, small, context);
  CHECK(relief.vertices_beyond_base > 100);
  CHECK(relief.vertices_beyond_base < relief.u.size());
  int free = 0;
  for (const double largest : relief.lambda_max_mm) free += std::isinf(largest);
  CHECK(free == relief.vertices_beyond_base);
  CHECK(relief.bound_violation_max_mm <= 0);

  const BaseSurface before(base_from_file(plane_mm(200, 2000), options));  // behind the viewer
  CHECK_THROWS_AS(solver.solve(options, before, context), Error);
  const BaseSurface near(base_from_file(plane_mm(200, 250), options));  // half-way and more
  CHECK_THROWS_AS(solver.solve(options, near, context), Error);
}

}  // namespace
}  // namespace formwright
