// SPDX-License-Identifier: GPL-3.0-or-later
// Thick surfaces on a plate: closed forms, the picture and the wall along lines of sight, convergence.
#include "relief/thick/thick_solid.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "base/error.h"
#include "geometry/mesh/adjacency.h"
#include "geometry/mesh/measures.h"
#include "geometry/queries/ray_caster.h"
#include "geometry/test_meshes.h"
#include "relief/relief.h"

namespace formwright {
namespace {
using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;
constexpr double pi = std::numbers::pi;

ThickSolidOptions on_plate(double wall_mm, double pixel_mm) {
  return {.size_mm = 100,
          .plate = {100, 100},
          .plate_mm = 3,
          .wall_mm = wall_mm,
          .above_mm = 60,
          .below_mm = 0,
          .pixel_mm = pixel_mm,
          .tolerance_mm = 0.01};
}

/// In view coordinates, with the size above: a ring of 30 mm and a tube of 10 mm around it.
TriangleMesh ring(double height_mm, double turn_deg) {
  TriangleMesh mesh = test::torus(96, 48, 1.0 / 3);
  const Eigen::AngleAxisd turn(turn_deg * pi / 180, Vec3::UnitX());
  mesh.V = (0.3 * mesh.V * turn.toRotationMatrix().transpose()).eval();
  mesh.V.col(2).array() -= height_mm / 100;
  return mesh;
}

/// The half of such a ring that looks towards the viewer before it is turned: a sheet without a back.
TriangleMesh half_ring(double height_mm, double turn_deg) {
  TriangleMesh mesh = ring(height_mm, turn_deg);
  const TriangleMesh straight = ring(0, 0);
  Eigen::Index kept = 0;
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f)
    if (straight.V(straight.F(f, 0), 2) + straight.V(straight.F(f, 1), 2) + straight.V(straight.F(f, 2), 2) < 0)
      mesh.F.row(kept++) = straight.F.row(f);
  mesh.F.conservativeResize(kept, 3);
  return mesh;
}

/// The half of a ball of 30 mm that the viewer sees, its edge on the plate.
TriangleMesh dome() {
  TriangleMesh mesh = test::icosphere(5);
  mesh.V *= 0.3;
  Eigen::Index kept = 0;
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f)
    if (mesh.V(mesh.F(f, 0), 2) + mesh.V(mesh.F(f, 1), 2) + mesh.V(mesh.F(f, 2), 2) < 0)
      mesh.F.row(kept++) = mesh.F.row(f);
  mesh.F.conservativeResize(kept, 3);
  mesh.V.col(2) = mesh.V.col(2).cwiseMin(0);
  return mesh;
}

ThickSolid made(const TriangleMesh& mesh, const ThickSolidOptions& options, double kappa = 0) {
  Context context;
  return thick_solid(mesh.V, mesh.F, kappa, options, context);
}

TEST_CASE("ThickSolid.ADomeIsAShellOverItsPlate") {
  const double wall = 4, radius = 30;
  const ThickSolidOptions options = on_plate(wall, 0.5);
  const ThickSolid solid = made(dome(), options);
  CHECK(Adjacency(solid.mesh).is_closed());
  CHECK(solid.hollows == 1);
  CHECK(solid.loose_parts == 0);
  const auto shell = [&](double thick) { return 2 * pi / 3 * (std::pow(radius, 3) - std::pow(radius - thick, 3)); };
  const double volume = solid.volume_mm3 - 100 * 100 * 3;
  CHECK(volume >= 0.99 * shell(wall));
  CHECK(volume <= 1.01 * shell(1.01 * std::hypot(wall, solid.opening_mm) / 0.99));
}

/// A floating ring, seen along its axis: what is within `reach` of the tube and behind its front half.
double ring_volume(double reach) {
  const double tube = 10, out = tube + reach;
  const double behind = tube * std::sqrt(out * out - tube * tube) + out * out * std::asin(tube / out);
  return 2 * pi * 30 * (pi * tube * tube / 2 + behind);
}

TEST_CASE("ThickSolid.ARingThatFloatsIsOpenBehind") {
  const double wall = 4;
  const ThickSolid solid = made(ring(40, 0), on_plate(wall, 0.25));
  CHECK(Adjacency(solid.mesh).is_closed());
  CHECK(solid.hollows == 0);
  CHECK(solid.loose_parts == 1);
  const double volume = solid.volume_mm3 - 100 * 100 * 3;
  CHECK(volume >= 0.99 * ring_volume(wall));
  CHECK(volume <= 1.01 * ring_volume(1.01 * std::hypot(wall, solid.opening_mm) / 0.99));
  // Straight on through the hole the plate is bare, and its front is where it was.
  CHECK_THAT(solid.mesh.V.col(2).maxCoeff(), WithinAbs(3 + 40 + 10, 0.02));
  CHECK_THAT(solid.mesh.V.col(2).minCoeff(), WithinAbs(0, 1e-4));
}

/// What lines of sight from the viewpoint find.
struct Sights {
  int rays = 0, different = 0;  // those whose first places on solid and surface differ by more than the tolerance
  double thinnest_mm = 1e9;     // of the solid, along the others that meet the surface
};

Sights seen(const TriangleMesh& surface, const ThickSolid& solid, const ThickSolidOptions& options, double kappa,
            double tolerance_mm, int across) {
  const auto caster_of = [](TriangleMesh mesh) { return RayCaster(mesh); };
  TriangleMesh lying = surface;
  lying.V *= options.size_mm;
  TriangleMesh solid_in_view = solid.mesh;
  solid_in_view.V.col(0).array() -= 0.5 * options.plate.width_mm;
  solid_in_view.V.col(1).array() -= 0.5 * options.plate.height_mm;
  solid_in_view.V.col(2) = (options.plate_mm + options.below_mm) - solid.mesh.V.col(2).array();
  const RayCaster on_surface = caster_of(lying), on_solid = caster_of(solid_in_view);
  Sights result;
  test::Random random(3);
  for (int k = 0; k < across * across; ++k) {
    const Vec3 on_plate((random.uniform() - 0.5) * options.plate.width_mm,
                        (random.uniform() - 0.5) * options.plate.height_mm, 0);
    const Vec3 direction = kappa > 0 ? (on_plate - Vec3(0, 0, -options.size_mm / kappa)).normalized() : Vec3(0, 0, 1);
    const Vec3 origin = on_plate - direction * (2 * options.above_mm);
    const auto hits = on_solid.all_hits(origin, direction, 0, 1e4);
    const auto hit = on_surface.first_hit(origin, direction, 0, 1e4);
    ++result.rays;
    const double plate_at = 2 * options.above_mm;  // the bare plate
    const double expected = hit ? std::min(hit->distance, plate_at) : plate_at;
    if (hits.size() < 2 || std::abs(hits[0].distance - expected) > tolerance_mm) {
      ++result.different;
      continue;
    }
    if (hit && hit->distance < plate_at)
      result.thinnest_mm = std::min(result.thinnest_mm, hits[1].distance - hits[0].distance);
  }
  return result;
}

TEST_CASE("ThickSolid.LooksLikeTheSurfaceAndHoldsItsWall") {
  const double wall = 3;
  for (const double kappa : {0.0, 0.35}) {
    double before = 0;
    for (const double pixel : {1.0, 0.5, 0.25}) {
      const TriangleMesh surface = half_ring(20, 35);
      const ThickSolidOptions options = on_plate(wall, pixel);
      const ThickSolid solid = made(surface, options, kappa);
      CHECK(Adjacency(solid.mesh).is_closed());
      CHECK(solid.loose_parts == 0);
      const Sights sights = seen(surface, solid, options, kappa, 0.3, 150);
      const double different = static_cast<double>(sights.different) / sights.rays;
      INFO("kappa " << kappa << ", pixel " << pixel << ", different " << 100 * different << " %, thinnest "
                    << sights.thinnest_mm);
      CHECK(different < 0.03 * pixel);
      if (before > 0) {
        CHECK(std::log2(before / different) > 0.8);
      }
      before = different;
      CHECK(sights.thinnest_mm >= wall);
    }
  }
}

TEST_CASE("ThickSolid.OfASolvedReliefNeverStandsOutFarther") {
  Context context;
  ReliefOptions relief_options;
  relief_options.width_mm = 60;
  relief_options.thickness_mm = 4;
  relief_options.carve_depth_mm = 1;
  relief_options.margin_mm = 5;
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    relief_options.projection = projection;
    const TriangleMesh mesh = test::torus(48, 24, 0.4);
    ReliefSolver solver(mesh, relief_options, context);
    const Relief relief = solver.solve(relief_options, context);
    ThickSolidOptions options = on_plate(1, 0.3);
    options.size_mm = 60;
    options.plate = {70, 60 * solver.frame().image_height + 10};
    options.above_mm = 4;
    options.below_mm = 1;
    const ThickSolid solid = thick_solid(relief.moved, solver.F(), solver.frame().kappa, options, context);
    CHECK(Adjacency(solid.mesh).is_closed());
    CHECK(solid.loose_parts == 0);
    CHECK(solid.mesh.V.col(2).maxCoeff() <= 3 + 1 + 4 + 1e-4);
    CHECK_THAT(solid.mesh.V.col(2).minCoeff(), WithinAbs(0, 1e-4));
    CHECK_THAT(solid.mesh.V.col(0).maxCoeff(), WithinAbs(70, 1e-4));
    // Never less than the plate under the carved surface, never more than the filled solid.
    CHECK(solid.volume_mm3 > options.plate.width_mm * options.plate.height_mm * 3);
    CHECK(solid.volume_mm3 < options.plate.width_mm * options.plate.height_mm * 8);
  }
}

/// A ball with its outline on the base: how far what is seen stands out, in widths.
double bulge(int levels, Projection projection, BoundedVertices bounded) {
  Context context;
  ReliefOptions options;
  options.only_outline = true;
  options.projection = projection;
  options.bounded_vertices = bounded;
  ReliefSolver solver(test::icosphere(levels), options, context);
  const Relief relief = solver.solve(options, context);
  double deepest = 0, off = 0;
  for (Eigen::Index i = 0; i < relief.moved.rows(); ++i) {
    if (solver.visibility().outline[static_cast<std::size_t>(i)]) off = std::max(off, std::abs(relief.moved(i, 2)));
    else if (bounded == BoundedVertices::all || solver.visibility().vertex[static_cast<std::size_t>(i)])
      deepest = std::max(deepest, relief.moved(i, 2));
  }
  CHECK(off <= 1e-12);
  CHECK(deepest <= 1e-12);
  return -relief.moved.col(2).minCoeff();
}

TEST_CASE("ThickSolid.OnlyTheOutlineIsHeld") {
  // The outline of a ball lies in a plane: seen from far it stays the ball that it is.
  CHECK_THAT(bulge(3, Projection::orthographic, BoundedVertices::visible), WithinAbs(0.5, 1e-6));
  // Where the back has no room behind the base, it holds the front back.
  CHECK(bulge(3, Projection::orthographic, BoundedVertices::all) > 0.1);
  // From near the outline of triangles goes to and fro in depth, which flattens what is next to it.
  for (const BoundedVertices bounded : {BoundedVertices::all, BoundedVertices::visible})
    CHECK(bulge(4, Projection::perspective, bounded) > 0.1);
}

TEST_CASE("ThickSolid.IsClosedForAnySurface") {
  // Triangles that cross each other, the plate's front, back and edges.
  const ThickSolidOptions options = on_plate(6, 2);
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    test::Random random(seed);
    std::vector<Vec3> points;
    std::vector<std::array<int, 3>> faces;
    for (int f = 0; f < 12; ++f) {
      const Vec3 middle(random.uniform(-0.55, 0.55), random.uniform(-0.55, 0.55), random.uniform(-0.5, 0.1));
      for (int k = 0; k < 3; ++k) points.push_back(middle + 0.25 * random.in_cube());
      faces.push_back({3 * f, 3 * f + 1, 3 * f + 2});
    }
    const TriangleMesh soup = test::make_mesh(points, faces);
    for (const double kappa : {0.0, 0.4}) {
      INFO("seed " << seed << ", kappa " << kappa);
      const ThickSolid solid = made(soup, options, kappa);
      CHECK(Adjacency(solid.mesh).is_closed());
      CHECK(solid.volume_mm3 > 0.999 * 100 * 100 * 3);
      CHECK(solid.mesh.V.col(2).maxCoeff() <= 3 + 60 + 1e-4);
      CHECK(solid.mesh.V.leftCols(2).minCoeff() >= -1e-4);
      CHECK(solid.mesh.V.leftCols(2).maxCoeff() <= 100 + 1e-4);
      CHECK_THAT(signed_volume(solid.mesh), WithinRel(solid.volume_mm3, 1e-5));
    }
  }
}

TEST_CASE("ThickSolid.OnThePlateItselfIsThePlate") {
  TriangleMesh square = test::grid(4, 4);
  square.V.leftCols(2).array() -= 0.5;
  square.V.leftCols(2) *= 0.6;
  for (const double behind : {0.0, 0.01, 0.5}) {  // on its front, within it, beyond its back
    square.V.col(2).setConstant(behind);
    const ThickSolid solid = made(square, on_plate(2, 1));
    INFO(behind);
    CHECK_THAT(solid.volume_mm3, WithinRel(100.0 * 100 * 3, 1e-5));
    CHECK(solid.hollows == 0);
    CHECK(solid.loose_parts == 0);
  }
}

TEST_CASE("ThickSolid.RefusesWhatIsTooFine") {
  const auto refusal = [](const ThickSolidOptions& options) -> std::string {
    try {
      made(ring(40, 0), options);
    } catch (const Error& error) {
      CHECK(error.code() == ErrorCode::invalid_input);
      CHECK(error.where() == "pixel_mm");
      return error.what();
    }
    return "";
  };
  // More points than a height map has.
  CHECK(refusal(on_plate(2, 0.01)) != "");
  // More triangles of the front than may be joined.
  ThickSolidOptions options = on_plate(4, 1);
  options.max_front_triangles = 500;
  CHECK_THAT(refusal(options), ContainsSubstring("at most 500 can be joined to its plate"));
}

}  // namespace
}  // namespace formwright
