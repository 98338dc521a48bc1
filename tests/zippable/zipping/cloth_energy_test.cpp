// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/zipping/cloth_energy.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "zippable/zipping/ribbons.h"
#include "zippable/zipping/zipping_system.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

/// A patch of equilateral triangles with sides `edge_mm`.
TriangleMesh equilateral_patch(int columns, int rows, double edge_mm) {
  std::vector<Vec3> points;
  std::vector<std::array<int, 3>> faces;
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i <= columns; ++i)
      points.emplace_back(edge_mm * (i + 0.5 * (j % 2)), edge_mm * std::sqrt(0.75) * j, 0.0);
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      const int a = j * (columns + 1) + i, b = a + 1, c = a + columns + 1, d = c + 1;
      if (j % 2 == 0) faces.push_back({a, b, c}), faces.push_back({b, d, c});
      else faces.push_back({a, b, d}), faces.push_back({a, d, c});
    }
  return test::make_mesh(points, faces);
}

Positions jostled(const Positions& x, double by, std::uint64_t seed) {
  test::Random random(seed);
  Positions result = x;
  for (Eigen::Index i = 0; i < x.rows(); ++i) result.row(i) += by * random.in_cube().transpose();
  return result;
}

TEST_CASE("ClothEnergy.OfAUniformStretchIsTheStrips") {
  // Plane stress with the strip free to narrow: K e^2 / 2 an area in the Green strain e, to second order.
  const TriangleMesh flat = equilateral_patch(6, 4, 2);
  const ClothMaterial material;
  const double e = 1e-4;
  Positions x = flat.V;
  x.col(0) *= std::sqrt(1 + 2 * e), x.col(1) *= std::sqrt(1 - 2 * material.poisson_ratio * e);
  double energy = 0, area = 0;
  for (const ClothTriangle& t : cloth_triangles(flat)) {
    energy += stretch_energy_mj(t, material, x), area += t.area_mm2;
    CHECK_THAT(largest_strain(t, x), WithinAbs(std::sqrt(1 + 2 * e) - 1, 1e-12));
  }
  CHECK_THAT(energy, WithinAbs(0.5 * material.stretch_n_per_mm * e * e * area, 1e-9 * energy));
}

TEST_CASE("ClothEnergy.OfBendingTendsToThePlatesOnACylinder") {
  const double radius = 10, bending = 0.3;
  std::vector<double> error;
  for (const int n : {16, 32, 64}) {
    const TriangleMesh flat = equilateral_patch(n, n, 20.0 / n);
    const Positions& u = flat.V;
    Positions x = u;
    for (Eigen::Index i = 0; i < x.rows(); ++i)
      x.row(i) << radius * std::sin(u(i, 0) / radius), u(i, 1), radius * std::cos(u(i, 0) / radius);
    // Only hinges count: the outermost half triangles have fewer, which is a share of 1 / n.
    const auto hinges = cloth_hinges(flat, bending);
    double area = 0;
    for (const ClothHinge& hinge : hinges) area += bending / hinge.stiffness_n_per_mm / 3;  // a third of both triangles
    error.push_back(std::abs(bending_energy_mj(hinges, x) / (0.5 * bending / (radius * radius) * area) - 1));
    CHECK_THAT(bending_energy_mj(hinges, flat.V), WithinAbs(0, 1e-20));
  }
  CHECK(error.back() < 0.03);
  CHECK(error[2] < 0.6 * error[0]);
}

TEST_CASE("ClothEnergy.StretchGradientAgreesWithDifferencesAndItsMatrixIsSemidefinite") {
  const TriangleMesh flat = equilateral_patch(1, 1, 2);
  const ClothTriangle t = cloth_triangles(flat)[0];
  const ClothMaterial material;
  for (std::uint64_t seed = 1; seed < 8; ++seed) {
    Positions x = jostled(flat.V, 0.4, seed);
    StretchTerms terms;
    stretch_terms(t, material, x, terms);
    CHECK_THAT(terms.energy_mj, WithinAbs(stretch_energy_mj(t, material, x), 1e-12 * terms.energy_mj));
    Eigen::Matrix<double, 9, 9> matrix;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j <= i; ++j) {
        matrix.block<3, 3>(3 * i, 3 * j) = terms.block[i][j];
        matrix.block<3, 3>(3 * j, 3 * i) = terms.block[i][j].transpose();
      }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 9, 9>> solver(matrix);
    CHECK(solver.eigenvalues()[0] > -1e-9 * solver.eigenvalues()[8]);
    for (std::size_t k = 0; k < 3; ++k)
      for (int d = 0; d < 3; ++d) {
        const double h = 1e-5, here = x(t.vertex[k], d);
        x(t.vertex[k], d) = here + h;
        const double up = stretch_energy_mj(t, material, x);
        x(t.vertex[k], d) = here - h;
        const double down = stretch_energy_mj(t, material, x);
        x(t.vertex[k], d) = here;
        CHECK_THAT(terms.gradient[k][d], WithinAbs((up - down) / (2 * h), 1e-7 * material.stretch_n_per_mm));
      }
  }
}

TEST_CASE("SeamThread.PullsOnlyWhereItIsTight") {
  const SeamThread thread{3, 2};
  CHECK(thread_energy_mj(thread, Vec3(1, 1, 1)) == 0);
  CHECK(thread_energy_mj({3, -1}, Vec3(9, 9, 9)) == 0);
  for (const double length : {0.0, 2.0}) {
    const Vec3 d(2, -1, 1.5);
    Eigen::Matrix3d hessian;
    const Vec3 gradient = thread_gradient_n({3, length}, d, &hessian);
    for (int k = 0; k < 3; ++k) {
      const Vec3 h = 1e-5 * Vec3::Unit(k);
      CHECK_THAT(gradient[k],
                 WithinAbs((thread_energy_mj({3, length}, d + h) - thread_energy_mj({3, length}, d - h)) / 2e-5, 1e-8));
      const Vec3 change =
          (thread_gradient_n({3, length}, d + h, nullptr) - thread_gradient_n({3, length}, d - h, nullptr)) / 2e-5;
      CHECK((hessian.col(k) - change).norm() < 1e-8);
    }
  }
}

TEST_CASE("Pressure.DoesTheWorkOfTheVolume") {
  const TriangleMesh ball = test::tetrahedron();
  const double pressure = 0.7;
  const Positions force =
      pressure_force_n(ball.F, ball.V, std::vector<char>(static_cast<std::size_t>(ball.face_count()), 1), pressure);
  CHECK(force.colwise().sum().norm() < 1e-12);
  const auto volume = [&](const Positions& x) {
    double six = 0;
    for (int f = 0; f < ball.face_count(); ++f) {
      const Vec3 a = x.row(ball.F(f, 0)), b = x.row(ball.F(f, 1)), c = x.row(ball.F(f, 2));
      six += a.dot(b.cross(c));
    }
    return six / 6;
  };
  const Positions move = jostled(Positions::Zero(ball.V.rows(), 3), 1, 5);
  CHECK_THAT(force.cwiseProduct(move).sum(),
             WithinAbs(pressure * (volume(ball.V + 1e-5 * move) - volume(ball.V - 1e-5 * move)) / 2e-5, 1e-8));
}

TEST_CASE("ZippingSystem.GradientOfAllAgreesWithDifferences") {
  Context context;
  const RibbonDesign design = test::cylinder_ribbon({100, 60, 1, 6, 0});
  const RibbonPattern pattern = make_ribbon_pattern(design.places, design.triangles, 0, context);
  ZippingSystem system(pattern, {}, context);
  for (SeamThread& thread : system.threads) thread = {2, 5};
  Positions x = jostled(pattern.flat.V, 2, 3);
  system.anchor_n_per_mm3 = 0.02;
  system.outer_force_n = jostled(Positions::Zero(x.rows(), 3), 1, 4);
  const Positions gradient = system.gradient_n(x);
  for (Eigen::Index i = 0; i < x.rows(); ++i)
    for (int k = 0; k < 3; ++k) {
      const double h = 1e-5, here = x(i, k);
      x(i, k) = here + h;
      const double up = system.objective_mj(x);
      x(i, k) = here - h;
      const double down = system.objective_mj(x);
      x(i, k) = here;
      CHECK_THAT(gradient(i, k), WithinAbs((up - down) / (2 * h), 1e-5 * (1 + std::abs(gradient(i, k)))));
    }
  const double before = system.objective_mj(x);
  const auto progress = system.minimise(x, 500, 1e-10, context);
  CHECK(progress.settled);
  CHECK(system.objective_mj(x) < before);
  CHECK(system.gradient_n(x).norm() < 1e-3 * gradient.norm());
}

}  // namespace
}  // namespace formwright
