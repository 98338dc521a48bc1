// SPDX-License-Identifier: GPL-3.0-or-later
#include "foreign_laboratory/sheet/membrane.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/generators/catch_generators.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <Eigen/Dense>
#include <cmath>

#include "foreign_laboratory/sheet/test_sheets.h"

namespace formwright::foreign_laboratory {
namespace {

using Catch::Matchers::WithinAbs, Catch::Matchers::WithinRel;
using Eigen::Vector3d;
using namespace test;

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

const Grid patch{3, 2, 9, 8};

}  // namespace

TEST_CASE("Membrane.BiaxialStretchHasTheStressOfTheNeoHookeanSheet") {
  const double x = GENERATE(0.8, 1.0, 1.7, 3.0), y = GENERATE(0.9, 1.3, 2.5);
  const Polymer polymer;
  const Membrane membrane(patch, polymer, {});
  const double expected = total_modulus_mpa(polymer) * (x * x - 1 / (x * x * y * y));
  const double tolerance = 1e-12 * std::abs(expected) + 1e-14;
  CHECK_THAT(stress_along_x(membrane, flat(patch, x, y), x, y), WithinAbs(expected, tolerance));
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
