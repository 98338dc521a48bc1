// SPDX-License-Identifier: GPL-3.0-or-later
// Where points of the model land: closed forms, convergence, corners, undercuts, folds.
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include "base/error.h"
#include "geometry/mesh/adjacency.h"
#include "thermoform/print/formed_sheets.h"
#include "thermoform/print/sheet_projection.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

using test::Cone;

struct MapError {
  double mean = 0, maximum = 0;
};

/// Over the middles of all faces that stay away from apex and rim, where a map that is linear within each face errs
/// most.
MapError cone_error(const Cone& cone, double edge_mm, int sheet_rings, SheetProjectionMethod method) {
  ThermoformPrintOptions options;
  options.projection = method;
  Context context;
  const RefinedSurface surface = refine_above_plate(cone.mesh(1, 256), edge_mm, 3'000'000, context);
  const ProjectedSurface projected = project_onto_sheet(surface, cone.sheet(sheet_rings, 256), options, context);
  MapError error;
  double weight = 0;
  for (Eigen::Index f = 0; f < surface.mesh.F.rows(); ++f) {
    Vec3 middle = Vec3::Zero();
    Vec2 landed = Vec2::Zero();
    double longest = 0;
    for (int k = 0; k < 3; ++k) {
      middle += surface.mesh.V.row(surface.mesh.F(f, k)).transpose() / 3;
      landed += projected.sheet_mm.row(surface.mesh.F(f, k)).transpose() / 3;
      longest = std::max(
          longest,
          (surface.mesh.V.row(surface.mesh.F(f, k)) - surface.mesh.V.row(surface.mesh.F(f, (k + 1) % 3))).norm());
    }
    const double u = middle.head<2>().norm() / cone.radius_mm;
    if (u < 0.15 || u > 0.9) continue;
    CHECK(projected.face[static_cast<std::size_t>(f)] == Coverage::coloured);
    const double distance = (landed - cone.flat(middle)).norm();
    error.mean += distance;
    error.maximum = std::max(error.maximum, distance);
    weight += 1;
  }
  error.mean /= weight;
  return error;
}

TEST_CASE("PrintMap.LandsOnTheConesClosedForm") {
  const MapError error = cone_error(Cone{}, 1, 120, SheetProjectionMethod::nearest);
  SUCCEED("mean_um " << static_cast<int>(1000 * error.mean));
  SUCCEED("max_um " << static_cast<int>(1000 * error.maximum));
  CHECK(error.maximum < 0.05);
  CHECK(error.mean < 0.01);
  const MapError rays = cone_error(Cone{}, 1, 120, SheetProjectionMethod::along_normal);
  CHECK(rays.maximum < 0.05);
}

TEST_CASE("PrintMap.ErrsWithTheSquareOfTheMapsTriangles") {
  // The radius goes with u^1.5, whose second derivative bounds what a linear piece misses.
  const double coarse = cone_error(Cone{}, 16, 200, SheetProjectionMethod::nearest).mean;
  const double middle = cone_error(Cone{}, 8, 200, SheetProjectionMethod::nearest).mean;
  const double fine = cone_error(Cone{}, 4, 200, SheetProjectionMethod::nearest).mean;
  for (const auto& [name, error] : {std::pair{"mean_um_16", coarse}, {"mean_um_8", middle}, {"mean_um_4", fine}})
    SUCCEED(name << " " << static_cast<int>(1000 * error));
  {
    INFO(coarse << " " << middle);
    CHECK(std::log2(coarse / middle) > 1.5);
  }
  INFO(middle << " " << fine);
  CHECK(std::log2(middle / fine) > 1.5);
}

/// Two walls of 20 mm that meet at a right angle along y, and a sheet that spans the corner with a gap of `gap` on
/// each.
struct Corner {
  TriangleMesh model;
  FormedSheet sheet;

  explicit Corner(double gap) {
    model = test::grid_mesh(20, 20, 40, 40);
    sheet.mesh = test::grid_mesh(20, 20, 80, 1);
    sheet.sheet_mm = sheet.mesh.V.leftCols(2);
    // Folds x < 0 up into a wall at x = 0; the origin is lifted off the plate.
    const auto fold = [](TriangleMesh& mesh, double bridge) {
      for (Eigen::Index i = 0; i < mesh.V.rows(); ++i) {
        const double x = mesh.V(i, 0);
        Vec2 place = x < 0 ? Vec2(0, -x) : Vec2(x, 0);
        if (std::abs(x) < bridge) {
          const double t = (x / bridge + 1) / 2;
          place = (1 - t) * Vec2(0, bridge) + t * Vec2(bridge, 0);
        }
        mesh.V(i, 0) = place.x();
        mesh.V(i, 2) = place.y() + 5;
      }
    };
    fold(model, 0);
    fold(sheet.mesh, gap);
    test::fill_columns(sheet, 0);
  }
};

/// Area on the flat sheet that both walls claim, over the area of the span.
double claimed_twice(SheetProjectionMethod method, double gap) {
  const Corner corner(gap);
  Context context;
  ThermoformPrintOptions options;
  options.projection = method;
  options.gap_mm = 2 * gap;
  const RefinedSurface surface = refine_above_plate(corner.model, 0.25, 3'000'000, context);
  const ProjectedSurface projected = project_onto_sheet(surface, corner.sheet, options, context);
  double lowest_of_floor = 1e9, highest_of_wall = -1e9;
  for (Eigen::Index i = 0; i < surface.mesh.V.rows(); ++i) {
    const Vec3 p = surface.mesh.V.row(i);
    if (projected.vertex[static_cast<std::size_t>(i)] != Coverage::coloured || std::abs(p.y()) > 15) continue;
    if (p.x() > 1e-6 && std::abs(p.z() - 5) < 1e-6)
      lowest_of_floor = std::min(lowest_of_floor, projected.sheet_mm(i, 0));
    if (p.x() < 1e-6 && p.z() > 5 + 1e-6) highest_of_wall = std::max(highest_of_wall, projected.sheet_mm(i, 0));
  }
  return std::max(0.0, highest_of_wall - lowest_of_floor) / (2 * gap);
}

TEST_CASE("PrintMap.NearestPointsShareASpannedCornerWhereRaysClaimItTwice") {
  const double nearest = claimed_twice(SheetProjectionMethod::nearest, 1),
               rays = claimed_twice(SheetProjectionMethod::along_normal, 1);
  SUCCEED("twice_nearest_percent " << static_cast<int>(100 * nearest));
  SUCCEED("twice_rays_percent " << static_cast<int>(100 * rays));
  CHECK(nearest < 0.01);
  CHECK(rays > 0.7);  // all of it but the last row of vertices
}

TEST_CASE("PrintMap.SaysWhyAPointHasNoPlace") {
  // A table of 40 x 40 at height 20 on a leg: the sheet lies on the table only. Beside it a plate beyond the opening.
  TriangleMesh table = test::grid_mesh(20, 20, 20, 20), under = table, step = test::grid_mesh(5, 5, 4, 4),
               beyond = step;
  table.V.col(2).array() = 20;
  under.V.col(2).array() = 18;
  under.F.col(1).swap(under.F.col(2));
  step.V.col(2).array() = 10;
  step.V.col(0).array() += 35;
  beyond.V.col(2).array() = 10;
  beyond.V.col(0).array() += 90;
  TriangleMesh model;
  std::vector<TriangleMesh> parts{table, under, step, beyond};
  TriangleMesh sunk = step;
  sunk.V.col(2).array() = -3;
  parts.push_back(sunk);
  Eigen::Index n = 0, m = 0;
  for (const TriangleMesh& part : parts) n += part.V.rows(), m += part.F.rows();
  model.V.resize(n, 3), model.F.resize(m, 3);
  n = m = 0;
  for (const TriangleMesh& part : parts) {
    model.V.middleRows(n, part.V.rows()) = part.V;
    model.F.middleRows(m, part.F.rows()) = part.F.array() + static_cast<int>(n);
    n += part.V.rows(), m += part.F.rows();
  }
  FormedSheet sheet;
  sheet.mesh = test::grid_mesh(50, 50, 50, 50);
  sheet.sheet_mm = sheet.mesh.V.leftCols(2);
  sheet.mesh.V.col(2).array() = 20.5;
  test::fill_columns(sheet, 1);
  Context context;
  const RefinedSurface surface = refine_above_plate(model, 2, 1'000'000, context);
  const ProjectedSurface projected = project_onto_sheet(surface, sheet, ThermoformPrintOptions{}, context);
  std::array<int, coverage_kinds> expected{}, agreed{};
  for (Eigen::Index f = 0; f < surface.mesh.F.rows(); ++f) {
    const Vec3 p = surface.mesh.V.row(surface.mesh.F(f, 0));
    const Coverage should = p.z() < 0    ? Coverage::below_plate
                            : p.x() > 60 ? Coverage::outside
                            : p.x() > 25 ? Coverage::not_touched
                            : p.z() < 19 ? Coverage::hidden
                                         : Coverage::coloured;
    ++expected[static_cast<std::size_t>(should)];
    agreed[static_cast<std::size_t>(should)] += projected.face[static_cast<std::size_t>(f)] == should;
  }
  for (const int count : expected) CHECK(count > 0);
  CHECK(agreed == expected);
  // What lies flat on the sheet's inner side keeps its place.
  for (Eigen::Index i = 0; i < surface.mesh.V.rows(); ++i)
    if (projected.vertex[static_cast<std::size_t>(i)] == Coverage::coloured) {
      CHECK_THAT((projected.sheet_mm.row(i) - surface.mesh.V.row(i).head<2>()).norm(), WithinAbs(0, 1e-9));
      CHECK_THAT(projected.gap_mm[i], WithinAbs(0, 1e-9));
    }
}

TEST_CASE("PrintMap.TheUndersideHasNoSayAlongTheFoot") {
  // A closed cone on the plate: its foot's normals are the wall's.
  const Cone cone;
  TriangleMesh model = cone.mesh(1, 64);
  model.V.conservativeResize(model.V.rows() + 1, 3);
  model.V.row(65).setZero();
  model.F.conservativeResize(model.F.rows() + 64, 3);
  for (int j = 0; j < 64; ++j) model.F.row(64 + j) << (j + 1) % 64, j, 65;
  Context context;
  const RefinedSurface surface = refine_above_plate(model, 3, 1'000'000, context);
  const ProjectedSurface projected = project_onto_sheet(surface, cone.sheet(60, 64), {}, context);
  for (std::size_t f = 0; f < projected.face.size(); ++f)
    CHECK(projected.face[f] == (surface.below_plate[f] ? Coverage::below_plate : Coverage::coloured));
}

TEST_CASE("PrintMap.DoesNotPaintAcrossAFold") {
  // Two halves of the sheet side by side over one plate, whose material was 40 mm apart.
  TriangleMesh model = test::grid_mesh(20, 20, 4, 4);
  model.V.col(2).array() = 5;
  FormedSheet sheet;
  sheet.mesh = test::grid_mesh(20, 20, 40, 40);
  sheet.sheet_mm = sheet.mesh.V.leftCols(2);
  // Cut along x = 0: vertices there belong to the left half, and the first column of faces on the right is left out.
  Triangles kept(sheet.mesh.F.rows(), 3);
  Eigen::Index count = 0;
  for (Eigen::Index f = 0; f < sheet.mesh.F.rows(); ++f) {
    double middle = 0;
    for (int k = 0; k < 3; ++k) middle += sheet.mesh.V(sheet.mesh.F(f, k), 0) / 3;
    if (middle < 0 || middle > 1) kept.row(count++) = sheet.mesh.F.row(f);
  }
  sheet.mesh.F = kept.topRows(count);
  for (Eigen::Index i = 0; i < sheet.sheet_mm.rows(); ++i) sheet.sheet_mm(i, 0) += sheet.mesh.V(i, 0) > 0.5 ? 40 : 0;
  sheet.mesh.V.col(2).array() = 5;
  test::fill_columns(sheet, 0);
  Context context;
  const RefinedSurface surface = refine_above_plate(model, 0.7, 1'000'000, context);
  const ProjectedSurface projected = project_onto_sheet(surface, sheet, ThermoformPrintOptions{}, context);
  int torn = 0;
  for (Eigen::Index f = 0; f < surface.mesh.F.rows(); ++f) {
    double longest = 0, middle = 0;
    for (int k = 0; k < 3; ++k) {
      longest = std::max(longest, (projected.sheet_mm.row(surface.mesh.F(f, k)) -
                                   projected.sheet_mm.row(surface.mesh.F(f, (k + 1) % 3)))
                                      .norm());
      middle += surface.mesh.V(surface.mesh.F(f, k), 0) / 3;
    }
    const bool coloured = projected.face[static_cast<std::size_t>(f)] == Coverage::coloured;
    {
      INFO(middle);
      CHECK(coloured == (longest < 10));
    }
    torn += !coloured;
  }
  CHECK(torn > 50);
  CHECK(torn < surface.mesh.F.rows() / 10);
}

TEST_CASE("PrintMap.DividesWithoutCracksAndKeepsArea") {
  const Cone cone;
  TriangleMesh mesh = cone.mesh(3, 7);
  mesh.V.col(2).array() -= 20;
  Context context;
  const RefinedSurface surface = refine_above_plate(mesh, 3, 1'000'000, context);
  const Adjacency before(mesh), after(surface.mesh);
  CHECK((before.boundary_edge_count() > 0) == (after.boundary_edge_count() > 0));
  CHECK(euler_characteristic(after) == euler_characteristic(before));
  CHECK_THAT(surface_area(surface.mesh), WithinAbs(surface_area(mesh), 1e-9 * surface_area(mesh)));
  CHECK(surface.edge_mm <= 3);
  for (Eigen::Index f = 0; f < surface.mesh.F.rows(); ++f)
    for (int k = 0; k < 3; ++k) {
      const Vec3 p = surface.mesh.V.row(surface.mesh.F(f, k));
      if (surface.below_plate[static_cast<std::size_t>(f)]) CHECK(p.z() <= 0);
      else CHECK(p.z() >= 0);
      const Eigen::Vector2d w = surface.place[static_cast<std::size_t>(f)][static_cast<std::size_t>(k)].cast<double>();
      const int old = surface.face_of[static_cast<std::size_t>(f)];
      const Vec3 again = (1 - w.sum()) * mesh.V.row(mesh.F(old, 0)) + w.x() * mesh.V.row(mesh.F(old, 1)) +
                         w.y() * mesh.V.row(mesh.F(old, 2));
      CHECK_THAT((again - p).norm(), WithinAbs(0, 1e-4));
    }
  // No room: it stays coarse, and says how coarse.
  const RefinedSurface coarse = refine_above_plate(mesh, 0.5, 500, context);
  CHECK(coarse.mesh.face_count() <= 500);
  CHECK(coarse.edge_mm > 0.5);
}

TEST_CASE("PrintMap.RefusesSheetsThatAreNone") {
  const Cone cone;
  Context context;
  const RefinedSurface surface = refine_above_plate(cone.mesh(1, 16), 5, 100'000, context);
  FormedSheet sheet = cone.sheet(10, 16);
  sheet.stretch.resize(3);
  try {
    project_onto_sheet(surface, sheet, {}, context);
    FAIL();
  } catch (const Error& error) {
    CHECK(error.where() == "sheet");
  }
}

}  // namespace
}  // namespace formwright
