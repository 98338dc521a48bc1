// SPDX-License-Identifier: GPL-3.0-or-later
// The part of a hot sheet's stiffness that never flows (network_share).
#include <catch2/catch_test_macros.hpp>
#include <catch2/generators/catch_generators.hpp>

#include <Eigen/Dense>
#include <limits>

#include "thermoform/sheet/membrane.h"
#include "thermoform/sheet_fixture.h"

namespace formwright {
namespace {
using namespace thermoform_test;

/// A sheet that is held stretched until all that flows has flowed pulls with its network alone: with that share of what
/// rubber of the same law would. A share of 1 is that rubber.
TEST_CASE("Network.only_the_network_goes_on_pulling") {
  const ElasticLaw law =
      GENERATE(ElasticLaw::st_venant_kirchhoff, ElasticLaw::stable_neo_hookean, ElasticLaw::incompressible_neo_hookean);
  const double network_share = GENERATE(0.0, 0.2, 1.0);
  const SheetMesh sheet = make_sheet_mesh(Vec2(12, 10), 48);
  const HeldVertices none_held(sheet.clamped.size(), 0);
  const int n = static_cast<int>(sheet.flat_mm.rows());
  MembraneMaterial rubber;
  rubber.elastic_law = law;
  rubber.creep_per_s = 0;
  MembraneMaterial flowing = rubber;
  flowing.network_share = network_share;
  flowing.yield_rule = YieldRule::total_strain;
  flowing.yield_strain = 0.01;
  flowing.creep_per_s = 500;
  Membrane flowed(sheet.flat_mm, sheet.F, 0.8, flowing), elastic(sheet.flat_mm, sheet.F, 0.8, rubber);
  Positions x = shaken(sheet, 0.05, 11);
  x.col(0) *= 1.8;
  x.col(1) *= 1.3;
  for (int step = 0; step < 40; ++step) {
    flowed.begin_step(x, none_held);
    flowed.end_step(x, 0.1);
  }
  flowed.begin_step(x, none_held);
  elastic.begin_step(x, none_held);
  Positions force = Positions::Zero(n, 3), of_rubber = force;
  flowed.add_forces(x, std::numeric_limits<double>::infinity(), 0, n, force, nullptr);
  elastic.add_forces(x, std::numeric_limits<double>::infinity(), 0, n, of_rubber, nullptr);
  CHECK((force - network_share * of_rubber).cwiseAbs().maxCoeff() < 1e-9 * of_rubber.cwiseAbs().maxCoeff());
}

/// A drum of 25 mm radius and height, whose wall is upright, under a sheet of 4 mm.
FormedSheet over_a_drum(int triangles, double network_share, double creep_per_s = 500) {
  ThermoformOptions o;
  o.sheet_x_mm = o.sheet_y_mm = 120;
  o.clamp_opening_x_mm = o.clamp_opening_y_mm = 110;
  o.platform_travel_mm = 60;
  o.sheet_thickness_mm = 4;
  o.triangles = triangles;
  o.network_share = network_share;
  o.creep_per_s = creep_per_s;
  o.frames = 2;
  const std::vector<std::pair<double, double>> drum{{0, 0}, {25, 0}, {25, 25}, {0, 25}};
  return form(revolved(drum, 96), o).sheet;
}

/// Mean thickness of the sheet between 8 and 18 mm above the plate, as a share of the flat sheet's. Triangles are cut
/// by sampling: one may reach over the whole wall.
double wall_share(const FormedSheet& sheet) {
  double total = 0, area = 0;
  for (int f = 0; f < sheet.mesh.face_count(); ++f) {
    Eigen::Matrix3d corner;
    Vec3 thickness;
    for (int k = 0; k < 3; ++k) {
      corner.row(k) = sheet.mesh.V.row(sheet.mesh.F(f, k));
      thickness[k] = sheet.thickness_mm[sheet.mesh.F(f, k)] / 4;
    }
    const double part =
        Vec3(corner.row(1) - corner.row(0)).cross(Vec3(corner.row(2) - corner.row(0))).norm() / (2 * 400);
    for (int i = 0; i < 20; ++i)
      for (int j = 0; j < 20 - i; ++j) {
        const double u = (i + 1.0 / 3) / 20, v = (j + 1.0 / 3) / 20;
        const Vec3 weight(1 - u - v, u, v);
        const double z = weight.dot(corner.col(2));
        if (z < 8 || z > 18) continue;
        total += part * weight.dot(thickness);
        area += part;
      }
  }
  return total / area;
}

TEST_CASE("Network.a_steep_wall_is_as_thick_on_any_mesh") {
  const double coarse = wall_share(over_a_drum(1500, 0.1)), fine = wall_share(over_a_drum(6000, 0.1));
  CHECK(std::abs(coarse - fine) < 0.03);
  CHECK(fine > 0.5);
  // Without, the wall thins with the mesh.
  const double flowing_coarse = wall_share(over_a_drum(1500, 0)), flowing_fine = wall_share(over_a_drum(6000, 0));
  CHECK(flowing_fine < 0.85 * flowing_coarse);
  CHECK(flowing_coarse < 0.5 * fine);
}

TEST_CASE("Network.alone_it_is_a_sheet_that_never_flows") {
  const FormedSheet network = over_a_drum(1500, 1), elastic = over_a_drum(1500, 0, 0);
  CHECK((network.mesh.V - elastic.mesh.V).cwiseAbs().maxCoeff() < 0.05);
}

}  // namespace
}  // namespace formwright
