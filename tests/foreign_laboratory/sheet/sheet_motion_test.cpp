// SPDX-License-Identifier: GPL-3.0-or-later
#include "foreign_laboratory/sheet/sheet_motion.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <cmath>
#include <numbers>

#include "foreign_laboratory/sheet/test_sheets.h"

namespace formwright::foreign_laboratory {
namespace {

using Catch::Matchers::WithinRel;
using Eigen::Vector3d;
using namespace test;

}  // namespace

TEST_CASE("SheetMotion.AFreeSheetFallsWithItsMomentumAndItsWeight") {
  const Grid grid{5, 4, 50, 40};
  const std::vector<char> none_held(static_cast<std::size_t>(grid.node_count()), 0);
  SheetMotion motion(Membrane(grid, Polymer{}, {}), none_held, 3, {.gravity_mm_per_s2 = gravity_mm_per_s2});
  motion.velocity() = shaken(motion.velocity(), 500, 6);
  const Vector3d at_first = motion.velocity() * motion.membrane().mass_t();
  for (int k = 0; k < 500; ++k) motion.step(0);
  const double mass = motion.membrane().mass_t().sum();
  CHECK_THAT(mass, WithinRel(50 * 40 * Polymer{}.density_t_per_mm3, 1e-12));
  const double seconds = motion.time_s() - 0.5 * motion.step_s();  // velocities are of the middle of a step
  const Vector3d expected = at_first - Vector3d(0, 0, mass * gravity_mm_per_s2 * seconds);
  CHECK((motion.velocity() * motion.membrane().mass_t() - expected).norm() < 1e-10 * expected.norm());
}

TEST_CASE("SheetMotion.EnergyOfAnElasticSheetIsKeptWithOrderTwo") {
  const Grid grid{6, 6, 60, 60};
  const auto drift = [&](double step_share) {
    SheetMotion motion(Membrane(grid, elastic(), {}), rim_held(grid), 0, {.step_share = step_share});
    motion.place() = flat(grid, 1.3, 1.3);
    for (int node = 0; node < grid.node_count(); ++node)
      if (!grid.on_rim(node))
        motion.velocity()(2, node) = 3000 * std::cos(std::numbers::pi * grid.flat_mm(node).x() / 60) *
                                     std::cos(std::numbers::pi * grid.flat_mm(node).y() / 60);
    motion.step(0);
    double first = 0, worst = 0;
    while (motion.time_s() < 0.01) {
      // Kinetic energy at a step's end from the velocities in the middle of both steps around.
      const double elastic_mj = motion.membrane().energy_mj(motion.place());
      const Points before = motion.velocity();
      motion.step(0);
      const double energy =
          elastic_mj + 0.5 * (before.cwiseProduct(motion.velocity()).colwise().sum() * motion.membrane().mass_t())(0);
      if (first == 0) first = energy;
      worst = std::max(worst, std::abs(energy - first));
    }
    return worst;
  };
  const double coarse = drift(0.4), middle = drift(0.2), fine = drift(0.1);
  INFO("drifts " << coarse << ", " << middle << ", " << fine << " mJ");
  CHECK(std::log2(coarse / middle) > 1.7);
  CHECK(std::log2(middle / fine) > 1.7);
}

namespace {

/// Height of the middle of a sheet, stretched by 1.5 before it was clamped and pressed from below, once at rest.
double inflated_mm(const Grid& grid, std::vector<char> held, double stretch, double pressure_mpa) {
  SheetMotion motion(Membrane(grid, elastic(), {}), std::move(held), 0, {.damping_per_s = 3e3});
  motion.place() = flat(grid, stretch, stretch);
  double before = -1;
  for (int k = 0;; ++k) {
    motion.step(-pressure_mpa);
    if (k % 200 != 0) continue;
    const double height = motion.place()(2, grid.node(grid.cells_x / 2, grid.cells_y / 2));
    if (std::abs(height - before) < 1e-9 * std::abs(height) || k > 100000) return height;
    before = height;
  }
}

double tension_n_per_mm(double stretch) {
  return 0.5 * (std::pow(stretch, 2) - std::pow(stretch, -4)) / (stretch * stretch);
}

}  // namespace

TEST_CASE("SheetMotion.ASlightlyInflatedSquareIsTheSolutionOfPoissonsEquation") {
  // T laplace(w) = -p on a square: its Fourier series.
  const double stretch = 1.5, pressure_mpa = 1e-5, side_mm = 60 * stretch;
  double series = 0;
  for (int m = 1; m < 400; m += 2)
    for (int n = 1; n < 400; n += 2) series += ((m + n) / 2 % 2 == 1 ? 1 : -1) / (1.0 * m * n * (m * m + n * n));
  const double per_series = 16 * pressure_mpa * side_mm * side_mm / std::pow(std::numbers::pi, 4);
  const double exact = per_series / tension_n_per_mm(stretch) * series;
  const auto error = [&](int cells) {
    const Grid grid{cells, cells, 60, 60};
    return std::abs(inflated_mm(grid, rim_held(grid), stretch, pressure_mpa) / exact - 1);
  };
  const double coarse = error(4), middle = error(8), fine = error(16);
  INFO("relative errors " << coarse << ", " << middle << ", " << fine);
  CHECK(std::log2(coarse / middle) > 1.8);
  CHECK(std::log2(middle / fine) > 1.8);
  CHECK(fine < 0.005);
}

TEST_CASE("SheetMotion.ASlightlyInflatedCircleRisesByTheSquareOfItsRadius") {
  // w = p R^2 / (4 T). The rim has steps as long as the cells: it lies between two circles, and so does the height.
  const double stretch = 1.5, pressure_mpa = 1e-5, radius_mm = 29;
  const Grid grid{80, 80, 60, 60};
  std::vector<char> held;
  for (int node = 0; node < grid.node_count(); ++node) held.push_back(grid.flat_mm(node).norm() > radius_mm);
  const auto exact = [&](double radius) {
    return pressure_mpa * std::pow(radius * stretch, 2) / (4 * tension_n_per_mm(stretch));
  };
  const double height = inflated_mm(grid, held, stretch, pressure_mpa);
  CHECK(height > exact(radius_mm));
  CHECK(height < exact(radius_mm + std::sqrt(2.0) * grid.spacing_x_mm()));
}

}  // namespace formwright::foreign_laboratory
