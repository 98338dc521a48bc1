// SPDX-License-Identifier: GPL-3.0-or-later
// The sheet against closed forms: Hencky's membrane, the clamped plate, a Newtonian sheet under its weight.
#include "thermoform/sheet_dynamics.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>

#include "thermoform/sheet_fixture.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

/// A disc of concentric rings of triangles, clamped at its edge.
SheetMesh disc(double radius_mm, int rings) {
  SheetMesh sheet;
  std::vector<Vec2> points{Vec2(0, 0)};
  for (int r = 1; r <= rings; ++r)
    for (int k = 0; k < 6 * r; ++k) {
      const double angle = 2 * std::numbers::pi * k / (6 * r);
      points.push_back(radius_mm * r / rings * Vec2(std::cos(angle), std::sin(angle)));
    }
  std::vector<Eigen::Vector3i> faces;
  const auto index = [](int r, int k) { return r == 0 ? 0 : 1 + 3 * r * (r - 1) + (k % (6 * r)); };
  for (int r = 1; r <= rings; ++r)
    for (int side = 0; side < 6; ++side)
      for (int k = 0; k < r; ++k) {
        const int outer = side * r + k, inner = side * (r - 1) + k;
        faces.emplace_back(index(r, outer), index(r, outer + 1), index(r - 1, r == 1 ? 0 : inner));
        if (k + 1 < r) faces.emplace_back(index(r - 1, inner), index(r, outer + 1), index(r - 1, inner + 1));
      }
  sheet.flat_mm.resize(static_cast<Eigen::Index>(points.size()), 2);
  for (std::size_t i = 0; i < points.size(); ++i) {
    sheet.flat_mm.row(static_cast<Eigen::Index>(i)) = points[i].transpose();
    sheet.clamped.push_back(static_cast<int>(i) >= index(rings, 0));
  }
  sheet.F.resize(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t i = 0; i < faces.size(); ++i) sheet.F.row(static_cast<Eigen::Index>(i)) = faces[i].transpose();
  return sheet;
}

/// Deflection in the middle of a clamped circular membrane over its radius, per (q a / (E h))^(1/3): Hencky 1915, with
/// the coefficients as corrected by Fichter 1997.
double hencky(double nu) {
  const auto edge = [&](double b) {  // radial displacement at the edge
    return (1 - nu) * b - (3 - nu) / std::pow(b, 2) - (5 - nu) * 2 / (3 * std::pow(b, 5)) -
           (7 - nu) * 13 / (18 * std::pow(b, 8)) - (9 - nu) * 17 / (18 * std::pow(b, 11)) -
           (11 - nu) * 37 / (27 * std::pow(b, 14)) - (13 - nu) * 1205 / (567 * std::pow(b, 17));
  };
  double low = 1, high = 3;
  for (int i = 0; i < 100; ++i) (edge(0.5 * (low + high)) < 0 ? low : high) = 0.5 * (low + high);
  const double b = low;
  return 1 / b + 1 / (2 * std::pow(b, 4)) + 5 / (9 * std::pow(b, 7)) + 55 / (72 * std::pow(b, 10)) +
         7 / (6 * std::pow(b, 13)) + 205 / (108 * std::pow(b, 16)) + 17051 / (5292 * std::pow(b, 19));
}

ThermoformOptions elastic() {
  ThermoformOptions o;
  o.creep_per_s = 0;
  o.viscosity_s = 0;
  return o;
}

TEST_CASE("SheetDynamics.circular_membrane_sags_as_hencky_says_and_converges") {
  const double a = 100;
  ThermoformOptions o = elastic();
  o.step_mm = 1e-5;  // Newton goes on until increments are 2e-7 mm
  Context context;
  StepLoad load;
  load.quasi_static = true;
  // A weight that strains the sheet by some 1e-4: Hencky's theory is that of small strain.
  load.gravity_mm_per_s2 = 0.3;
  const double q = o.density_kg_per_m3 * 1e-12 * load.gravity_mm_per_s2 * o.sheet_thickness_mm;
  const double expected =
      hencky(o.poisson_ratio) * a * std::cbrt(q * a / (o.young_modulus_pa * 1e-6 * o.sheet_thickness_mm));
  CHECK_THAT(hencky(0.3), WithinAbs(0.653, 0.001));
  std::vector<double> errors;
  for (const int rings : {6, 12, 24}) {
    SheetDynamics dynamics(disc(a, rings), o, 0, nullptr);
    Positions guess = dynamics.x();
    for (Eigen::Index i = 0; i < guess.rows(); ++i)
      guess(i, 2) -= 0.9 * expected * (1 - guess.row(i).head<2>().squaredNorm() / (a * a));
    SheetDynamics::Outcome outcome = SheetDynamics::Outcome::not_converged;
    for (int attempt = 0; attempt < 40 && outcome != SheetDynamics::Outcome::done; ++attempt) {
      dynamics.guess(guess);
      outcome = dynamics.step(1, load, 1e9, context);
      if (outcome != SheetDynamics::Outcome::done) guess = dynamics.last_iterate();
    }
    REQUIRE(outcome == SheetDynamics::Outcome::done);
    errors.push_back(-dynamics.x()(0, 2) / expected - 1);
  }
  CHECK(std::abs(errors[2]) < 2e-3);
  const double order = std::log2(std::abs(errors[0] - errors[1]) / std::abs(errors[1] - errors[2]));
  SUCCEED("order " << order);
  INFO(errors[0] << " " << errors[1] << " " << errors[2]);
  CHECK(order > 1.6);
}

TEST_CASE("SheetDynamics.newtonian_sheet_sags_with_the_cube_root_of_time") {
  // No yield strain: everything flows, and the elastic part is that of a Maxwell fluid, long relaxed.
  ThermoformOptions o;
  o.creep_per_s = 2e4;
  o.yield_strain = 0;
  o.viscosity_s = 0;
  o.flow_stop_mm = 0;
  o.step_mm = 0.01;
  Context context;
  SheetDynamics dynamics(make_sheet_mesh(Vec2(200, 200), 800), o, 0, nullptr);
  StepLoad load;
  load.quasi_static = true;
  load.gravity_mm_per_s2 = 10;
  Positions guess = dynamics.x();
  for (Eigen::Index i = 0; i < guess.rows(); ++i)
    guess(i, 2) -= 1.0 * (1 - std::pow(guess(i, 0) / 100, 2)) * (1 - std::pow(guess(i, 1) / 100, 2));
  std::vector<double> sag;
  double dt = 1e-4;
  for (const double until : {0.02, 0.04, 0.08, 0.16}) {
    while (dynamics.time_s() < until * (1 - 1e-9)) {
      dt = std::min(dt * 1.3, std::min(until / 60, until - dynamics.time_s()));
      SheetDynamics::Outcome outcome = SheetDynamics::Outcome::not_converged;
      for (int attempt = 0; attempt < 20 && outcome != SheetDynamics::Outcome::done; ++attempt) {
        if (guess.rows() > 0) dynamics.guess(guess);
        outcome = dynamics.step(dt, load, 1e9, context);
        if (outcome != SheetDynamics::Outcome::done) guess = dynamics.last_iterate();
      }
      REQUIRE(outcome == SheetDynamics::Outcome::done);
      guess.resize(0, 3);
    }
    sag.push_back(-dynamics.x().col(2).minCoeff());
  }
  for (std::size_t i = 0; i + 1 < sag.size(); ++i) {
    INFO("at doubling " << i);
    CHECK_THAT(std::log2(sag[i + 1] / sag[i]), WithinAbs(1.0 / 3, 0.02));
  }
}

/// The hinges' stiffness at rest, for movements across the sheet.
double plate_deflection(int triangles, double a, double young_mpa, double nu, double thickness, double q) {
  const SheetMesh sheet = make_sheet_mesh(Vec2(2.2 * a, 2.2 * a), triangles);
  const int n = static_cast<int>(sheet.flat_mm.rows());
  HingeBending bending(sheet.F, n, young_mpa, nu, 0);
  Positions x = Positions::Zero(n, 3);
  x.leftCols(2) = sheet.flat_mm;
  const auto faces = static_cast<std::size_t>(sheet.F.rows());
  bending.begin_step(x, std::vector<double>(faces, thickness), std::vector<double>(faces, 1));
  std::vector<int> unknown(static_cast<std::size_t>(n), -1);
  int free = 0;
  for (int i = 0; i < n; ++i)
    if (sheet.flat_mm.row(i).norm() < a) unknown[static_cast<std::size_t>(i)] = free++;
  Eigen::VectorXd load = Eigen::VectorXd::Zero(free);
  for (int f = 0; f < sheet.F.rows(); ++f) {
    const Vec2 e1 = (sheet.flat_mm.row(sheet.F(f, 1)) - sheet.flat_mm.row(sheet.F(f, 0))).transpose(),
               e2 = (sheet.flat_mm.row(sheet.F(f, 2)) - sheet.flat_mm.row(sheet.F(f, 0))).transpose();
    for (int k = 0; k < 3; ++k)
      if (const int row = unknown[static_cast<std::size_t>(sheet.F(f, k))]; row >= 0)
        load[row] += q * (e1.x() * e2.y() - e1.y() * e2.x()) / 6;
  }
  std::vector<Eigen::Triplet<double>> entries;
  const std::vector<double> stiffness = bending.stiffness_mj();
  std::array<Vec3, 4> gradient;
  for (std::size_t hinge = 0; hinge < stiffness.size(); ++hinge) {
    const int* v = bending.vertices().data() + 4 * hinge;
    hinge_angle(x.row(v[0]), x.row(v[1]), x.row(v[2]), x.row(v[3]), &gradient);
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = 0; j < 4; ++j) {
        const int row = unknown[static_cast<std::size_t>(v[i])], column = unknown[static_cast<std::size_t>(v[j])];
        if (row >= 0 && column >= 0)
          entries.emplace_back(row, column, 2 * stiffness[hinge] * gradient[i].z() * gradient[j].z());
      }
  }
  Eigen::SparseMatrix<double> K(free, free);
  K.setFromTriplets(entries.begin(), entries.end());
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(K);
  return solver.solve(load).maxCoeff();
}

TEST_CASE("SheetDynamics.hinges_bend_like_a_clamped_circular_plate") {
  const double a = 50, young = 2.75, nu = 0.35, h = 1, q = 1e-6;
  const double D = young * h * h * h / (12 * (1 - nu * nu)), expected = q * std::pow(a, 4) / (64 * D);
  std::vector<double> ratio;
  for (const int triangles : {2500, 10000, 40000})
    ratio.push_back(plate_deflection(triangles, a, young, nu, h, q) / expected);
  SUCCEED("ratios " << std::to_string(ratio[0]) + " " + std::to_string(ratio[1]) + " " + std::to_string(ratio[2]));
  // The rim is a staircase, and hinges on this mesh of alternating diagonals tend to a plate some 4 % too stiff.
  {
    INFO(ratio[0]);
    CHECK_THAT(ratio[1], WithinAbs(1, 0.05));
  }
  INFO(ratio[0] << " " << ratio[1]);
  CHECK_THAT(ratio[2], WithinAbs(1, 0.05));
}

}  // namespace
}  // namespace formwright
