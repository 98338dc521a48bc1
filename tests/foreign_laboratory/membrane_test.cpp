// SPDX-License-Identifier: GPL-3.0-or-later
#include "foreign_laboratory/membrane.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/generators/catch_generators.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "foreign_laboratory/faults.h"
#include "foreign_laboratory/sheet_motion.h"

namespace formwright::foreign_laboratory {
namespace {

using Catch::Matchers::WithinAbs, Catch::Matchers::WithinRel;
using Eigen::Vector3d;

Points flat(const Grid& grid, double stretch_x = 1, double stretch_y = 1) {
  Points x(3, grid.node_count());
  for (int node = 0; node < grid.node_count(); ++node)
    x.col(node) << stretch_x * grid.flat_mm(node).x(), stretch_y * grid.flat_mm(node).y(), 0;
  return x;
}

Points shaken(Points x, double by, unsigned seed) {
  std::mt19937_64 random(seed);
  for (Eigen::Index k = 0; k < x.size(); ++k) x.data()[k] += uniform(random, -by, by);
  return x;
}

/// Force across the right side over its present cross section, of a sheet 1 mm thick.
double stress_along_x(const Membrane& membrane, const Points& x, double stretch_x, double stretch_y) {
  const Grid& grid = membrane.grid();
  Points force;
  membrane.forces(x, 0, force);
  double pull = 0;
  for (int j = 0; j <= grid.cells_y; ++j) pull -= force(0, grid.node(grid.cells_x, j));
  const double thickness = 1 / (stretch_x * stretch_y);
  return pull / (grid.length_mm * stretch_y * thickness);
}

Polymer elastic(double modulus_mpa = 0.5) {
  Polymer polymer;
  polymer.lasting_modulus_mpa = modulus_mpa;
  polymer.relaxing_modulus_mpa = {0, 0};
  return polymer;
}

std::vector<char> rim_held(const Grid& grid) {
  std::vector<char> held;
  for (int node = 0; node < grid.node_count(); ++node) held.push_back(grid.on_rim(node));
  return held;
}

const Grid patch{3, 2, 9, 8};

}  // namespace

TEST_CASE("Membrane.BiaxialStretchHasTheStressOfTheNeoHookeanSheet") {
  const double x = GENERATE(0.8, 1.0, 1.7, 3.0), y = GENERATE(0.9, 1.3, 2.5);
  const Polymer polymer;
  const Membrane membrane(patch, polymer, {});
  const double expected = total_modulus_mpa(polymer) * (x * x - 1 / (x * x * y * y));
  CHECK_THAT(stress_along_x(membrane, flat(patch, x, y), x, y), WithinAbs(expected, 1e-12 * std::abs(expected) + 1e-14));
  Points force;
  membrane.forces(flat(patch, x, y), 0, force);
  CHECK(force.col(patch.node(1, 1)).norm() < 1e-12);
  CHECK(force.rowwise().sum().norm() < 1e-12);
}

TEST_CASE("Membrane.StressRelaxesByThePronySeries") {
  const Polymer polymer;
  Membrane membrane(patch, polymer, {});
  const double stretch = 1.6;
  const Points x = flat(patch, stretch, stretch);
  Points force;
  membrane.set_step(1e-12);  // sudden
  membrane.advance(x, 0, force);
  membrane.set_step(0.03);
  for (int k = 1; k <= 100; ++k) {
    membrane.advance(x, 0, force);
    const double expected = relaxation_modulus_mpa(polymer, 0.03 * k, polymer.forming_temperature_k) / 3 *
                            (std::pow(stretch, 2) - std::pow(stretch, -4));
    CHECK_THAT(stress_along_x(membrane, x, stretch, stretch), WithinRel(expected, 1e-9));
  }
}

TEST_CASE("Membrane.SteadyStretchingConvergesToTheConvolutionWithOrderTwo") {
  // Both directions by exp(rate t): the integral of the memory over the past is elementary.
  const Polymer polymer;
  const double rate = 0.8, end_s = 1;
  const auto error = [&](int steps) {
    Membrane membrane(patch, polymer, {});
    membrane.set_step(end_s / steps);
    Points force;
    double stretch = 1;
    for (int k = 1; k <= steps; ++k) {
      stretch = std::exp(rate * end_s * k / steps);
      membrane.advance(flat(patch, stretch, stretch), 0, force);
    }
    double in_plane = polymer.lasting_modulus_mpa, across = polymer.lasting_modulus_mpa;
    for (std::size_t k = 0; k < 2; ++k) {
      const double tau = polymer.relaxation_s[k], left = std::exp(-end_s / tau);
      const auto mean = [&](double power) {
        return left + (std::exp(power * rate * end_s) - left) / (1 + power * rate * tau);
      };
      in_plane += polymer.relaxing_modulus_mpa[k] * mean(-2);
      across += polymer.relaxing_modulus_mpa[k] * mean(4);
    }
    const double expected = std::pow(stretch, 2) * in_plane - std::pow(stretch, -4) * across;
    return std::abs(stress_along_x(membrane, flat(patch, stretch, stretch), stretch, stretch) - expected);
  };
  const double coarse = error(20), middle = error(40), fine = error(80);
  INFO("errors " << coarse << ", " << middle << ", " << fine << " MPa");
  CHECK(std::log2(coarse / middle) > 1.9);
  CHECK(std::log2(middle / fine) > 1.95);
}

TEST_CASE("Membrane.ForcesAreTheNegativeGradientOfTheEnergy") {
  FlatSheet sheet;
  sheet.anisotropy = GENERATE(0.0, 0.4, -0.4);
  sheet.thickness_mm = [](double x, double) { return 1 + 0.05 * x; };
  Membrane membrane(patch, Polymer{}, sheet);
  Points force;
  membrane.set_step(0.05);
  membrane.advance(shaken(flat(patch, 1.2, 1.1), 0.3, 1), 0, force);
  membrane.advance(shaken(flat(patch, 1.4, 1.3), 0.3, 2), 0, force);
  Points x = shaken(flat(patch, 1.3, 1.5), 0.3, 3);
  membrane.forces(x, 0, force);
  for (Eigen::Index k = 0; k < x.size(); ++k) {
    const double at = x.data()[k], step = 1e-5;
    x.data()[k] = at + step;
    const double above = membrane.energy_mj(x);
    x.data()[k] = at - step;
    const double below = membrane.energy_mj(x);
    x.data()[k] = at;
    CHECK_THAT(force.data()[k], WithinAbs(-(above - below) / (2 * step), 1e-7));
  }
}

TEST_CASE("Membrane.TurningTheSheetTurnsItsForces") {
  Membrane membrane(patch, Polymer{}, {});
  const Points x = shaken(flat(patch, 1.3, 1.2), 0.4, 4);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.1, Vector3d(1, 2, -0.5).normalized()).toRotationMatrix();
  Points force, turned;
  membrane.forces(x, 0.02, force);
  membrane.forces((turn * x).colwise() + Vector3d(30, -4, 7), 0.02, turned);
  CHECK((turn * force - turned).cwiseAbs().maxCoeff() < 1e-12);
}

TEST_CASE("Membrane.AnExtrudedSheetIsStifferAlongItsDirection") {
  const double a = 0.5, strain = 1e-5;
  const Membrane membrane(patch, elastic(1), {.anisotropy = a});
  const auto stiffness = [&](bool along_x, bool pulled_x) {
    const Points x = flat(patch, pulled_x ? 1 + strain : 1, pulled_x ? 1 : 1 + strain);
    Points force;
    membrane.forces(x, 0, force);
    double pull = 0;
    if (along_x)
      for (int j = 0; j <= patch.cells_y; ++j) pull -= force(0, patch.node(patch.cells_x, j)) / patch.length_mm;
    else
      for (int i = 0; i <= patch.cells_x; ++i) pull -= force(1, patch.node(i, patch.cells_y)) / patch.width_mm;
    return pull / strain;
  };
  const double xx = stiffness(true, true), xy = stiffness(true, false), yy = stiffness(false, false);
  CHECK_THAT(xx - xy * xy / yy, WithinRel(3 * (1 + a), 1e-3));
  const double across = yy - xy * xy / xx;
  CHECK(across > 3 * (1 - a));
  CHECK(across < 3 * (1 - a) * 1.3);
}

TEST_CASE("Membrane.CoolingLeavesTheForcesAsTheyAre") {
  Membrane membrane(patch, Polymer{}, {.anisotropy = 0.3});
  const Points x = flat(patch, 1.5, 1.4);
  Points before, after;
  membrane.set_step(0.05);
  for (int k = 0; k < 5; ++k) membrane.advance(x, 0, before);
  const std::vector<double> colder(static_cast<std::size_t>(patch.node_count()), 373);
  membrane.set_temperatures(colder);
  membrane.forces(x, 0, after);
  CHECK((after - before).cwiseAbs().maxCoeff() < 1e-12);
  // Further stretch meets the moduli of the colder sheet.
  Points colder_force;
  const Membrane fresh(patch, Polymer{}, {.anisotropy = 0.3});
  Points fresh_force;
  membrane.forces(flat(patch, 1.5 * 1.001, 1.4), 0, colder_force);
  fresh.forces(flat(patch, 1.001, 1), 0, fresh_force);
  CHECK(modulus_shift(Polymer{}, 373) > 2);
  CHECK((colder_force - before).norm() > fresh_force.norm());
}

TEST_CASE("Membrane.NoFrequencyIsAboveTheBoundThatChoosesTheStep") {
  const double stretch = GENERATE(0.9, 1.0, 1.8);
  const Grid grid{3, 3, 9, 11};
  const Polymer polymer;
  const Membrane membrane(grid, polymer, {.anisotropy = 0.3});
  Points x = shaken(flat(grid, stretch, 1.1), 0.2, 5);
  const Eigen::Index n = x.size();
  Eigen::MatrixXd stiffness(n, n);
  for (Eigen::Index k = 0; k < n; ++k) {
    Points above, below;
    const double at = x.data()[k];
    x.data()[k] = at + 1e-6;
    membrane.forces(x, 0, above);
    x.data()[k] = at - 1e-6;
    membrane.forces(x, 0, below);
    x.data()[k] = at;
    stiffness.col(k) = -Eigen::Map<const Eigen::VectorXd>(Points(above - below).data(), n) / 2e-6;
  }
  Eigen::VectorXd root(n);
  for (Eigen::Index k = 0; k < n; ++k) root[k] = 1 / std::sqrt(membrane.mass_t()[k / 3]);
  const Eigen::MatrixXd scaled = root.asDiagonal() * (0.5 * (stiffness + stiffness.transpose())) * root.asDiagonal();
  const double largest = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scaled).eigenvalues().maxCoeff();
  CHECK(largest <= membrane.max_squared_frequency(x));
  CHECK(largest > 0.3 * membrane.max_squared_frequency(x));
}

TEST_CASE("SheetMotion.AFreeSheetFallsWithItsMomentumAndItsWeight") {
  const Grid grid{5, 4, 50, 40};
  SheetMotion motion(Membrane(grid, Polymer{}, {}), std::vector<char>(static_cast<std::size_t>(grid.node_count()), 0), 3,
                     {.mass_scale = 1, .damping_per_s = 0, .gravity_mm_per_s2 = gravity_mm_per_s2});
  motion.velocity() = shaken(motion.velocity(), 500, 6);
  const Vector3d at_first = motion.velocity() * motion.membrane().mass_t();
  for (int k = 0; k < 500; ++k) motion.step(0);
  const double mass = motion.membrane().mass_t().sum();
  CHECK_THAT(mass, WithinRel(50 * 40 * Polymer{}.density_t_per_mm3, 1e-12));
  const Vector3d expected = at_first - Vector3d(0, 0, mass * gravity_mm_per_s2 * (motion.time_s() - 0.5 * motion.step_s()));
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
    for (int n = 1; n < 400; n += 2)
      series += ((m + n) / 2 % 2 == 1 ? 1 : -1) / (1.0 * m * n * (m * m + n * n));
  const double exact = 16 * pressure_mpa * side_mm * side_mm / (std::pow(std::numbers::pi, 4) * tension_n_per_mm(stretch)) * series;
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

TEST_CASE("Polymer.TemperatureShiftsTimesByTheWlfEquationAndModuliByArrhenius") {
  const Polymer polymer;
  CHECK(relaxation_time_shift(polymer, polymer.forming_temperature_k) == 1);
  CHECK(modulus_shift(polymer, polymer.forming_temperature_k) == 1);
  // From the glass temperature to 10 K above it: 17.44 * 10 / 61.6 decades.
  const double decades = std::log10(relaxation_time_shift(polymer, polymer.glass_temperature_k) /
                                    relaxation_time_shift(polymer, polymer.glass_temperature_k + 10));
  CHECK_THAT(decades, WithinRel(174.4 / 61.6, 1e-12));
  CHECK_THAT(std::log(modulus_shift(polymer, 403)), WithinRel(30e3 / 8.314462618 * (1 / 403.0 - 1 / 413.0), 1e-12));
  CHECK(modulus_shift(polymer, 200) == polymer.max_stiffening);
  CHECK(stiffness_ratio(polymer, 405) > 1);
  CHECK(stiffness_ratio(polymer, 421) < 1);
}

}  // namespace formwright::foreign_laboratory
