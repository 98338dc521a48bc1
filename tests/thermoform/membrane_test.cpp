// SPDX-License-Identifier: GPL-3.0-or-later
#include "thermoform/sheet/membrane.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/generators/catch_generators.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "thermoform/sheet/hinge_bending.h"
#include "thermoform/sheet_fixture.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

using thermoform_test::shaken;
constexpr double for_ever = std::numeric_limits<double>::infinity();

SheetMesh small_sheet() { return make_sheet_mesh(Vec2(12, 10), 48); }
HeldVertices none_held(const SheetMesh& sheet) { return HeldVertices(sheet.clamped.size(), 0); }

MembraneMaterial material(ElasticLaw law, double network_share = 0) {
  MembraneMaterial m;
  m.elastic_law = law;
  m.network_share = network_share;
  m.creep_per_s = 0;
  m.viscosity_s = 1e-3;
  return m;
}

TEST_CASE("EveryLaw.forces_are_the_negative_gradient_of_the_energy") {
  const ElasticLaw law =
      GENERATE(ElasticLaw::st_venant_kirchhoff, ElasticLaw::stable_neo_hookean, ElasticLaw::incompressible_neo_hookean);
  const double network_share = GENERATE(0.0, 0.3, 1.0);
  const SheetMesh sheet = small_sheet();
  Membrane membrane(sheet.flat_mm, sheet.F, 0.8, material(law, network_share));
  membrane.begin_step(shaken(sheet, 0.1, 1), none_held(sheet));
  for (const double dt : {for_ever, 2e-3}) {
    Positions x = shaken(sheet, 0.3, 2), force = Positions::Zero(x.rows(), 3);
    membrane.add_forces(x, dt, 0, static_cast<int>(x.rows()), force, nullptr);
    const double step = 1e-5, scale = force.cwiseAbs().maxCoeff();
    for (Eigen::Index i = 0; i < x.size(); i += 7) {
      const double at = x.data()[i];
      x.data()[i] = at + step;
      const double above = membrane.energy(x, dt);
      x.data()[i] = at - step;
      const double below = membrane.energy(x, dt);
      x.data()[i] = at;
      INFO("entry " << i);
      CHECK_THAT(force.data()[i], WithinAbs(-(above - below) / (2 * step), 1e-7 * scale));
    }
  }
}

TEST_CASE("EveryLaw.stiffness_in_tension_is_the_derivative_of_the_forces") {
  const ElasticLaw law =
      GENERATE(ElasticLaw::st_venant_kirchhoff, ElasticLaw::stable_neo_hookean, ElasticLaw::incompressible_neo_hookean);
  const double network_share = GENERATE(0.0, 0.3, 1.0);
  const SheetMesh sheet = small_sheet();
  Membrane membrane(sheet.flat_mm, sheet.F, 0.8, material(law, network_share));
  BlockMatrix matrix(static_cast<int>(sheet.flat_mm.rows()),
                     std::span(sheet.F.data(), static_cast<std::size_t>(sheet.F.size())), 3);
  membrane.use_matrix(matrix);
  Positions x = shaken(sheet, 0.02, 3);
  membrane.begin_step(x, none_held(sheet));
  const int n = static_cast<int>(x.rows());
  Positions force = Positions::Zero(n, 3);
  membrane.add_forces(x, for_ever, 0, n, force, &matrix);
  double largest = 0;
  for (int i = 0; i < n; ++i)
    largest = std::max(largest, static_cast<double>(matrix.block(matrix.diagonal_slot(i))[0][0]));
  const double step = 1e-5;
  for (int j = 0; j < n; j += 5)
    for (int l = 0; l < 3; ++l) {
      Positions above = Positions::Zero(n, 3), below = above, moved = x;
      moved(j, l) += step;
      membrane.add_forces(moved, for_ever, 0, n, above, nullptr);
      moved(j, l) -= 2 * step;
      membrane.add_forces(moved, for_ever, 0, n, below, nullptr);
      for (int i = 0; i < n; ++i) {
        const int slot = matrix.slot(i, j);
        for (int k = 0; k < 3; ++k) {
          const double kept = slot < 0 ? 0 : static_cast<double>(matrix.block(slot)[static_cast<std::size_t>(l)][k]);
          CHECK_THAT(kept, WithinAbs(-(above(i, k) - below(i, k)) / (2 * step), 2e-5 * largest));
        }
      }
    }
}

TEST_CASE("EveryLaw.stiffness_is_symmetric_and_has_no_negative_curvature") {
  const ElasticLaw law =
      GENERATE(ElasticLaw::st_venant_kirchhoff, ElasticLaw::stable_neo_hookean, ElasticLaw::incompressible_neo_hookean);
  const double network_share = GENERATE(0.0, 0.3, 1.0);
  const SheetMesh sheet = small_sheet();
  MembraneMaterial flowing = material(law, network_share);
  flowing.creep_per_s = 500;
  flowing.yield_strain = 0.05;
  Membrane membrane(sheet.flat_mm, sheet.F, 0.8, flowing);
  const int n = static_cast<int>(sheet.flat_mm.rows());
  BlockMatrix matrix(n, std::span(sheet.F.data(), static_cast<std::size_t>(sheet.F.size())), 3);
  membrane.use_matrix(matrix);
  membrane.begin_step(shaken(sheet, 0.1, 4), none_held(sheet));
  Positions force = Positions::Zero(n, 3);
  membrane.add_forces(shaken(sheet, 1.0, 5), 1e-3, 0, n, force, &matrix);
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(3 * n, 3 * n);
  for (int i = 0; i < n; ++i)
    for (const int j : matrix.columns(i))
      for (int k = 0; k < 3; ++k)
        for (int l = 0; l < 3; ++l)
          dense(3 * i + k, 3 * j + l) =
              static_cast<double>(matrix.block(matrix.slot(i, j))[static_cast<std::size_t>(l)][k]);
  const double size = dense.cwiseAbs().maxCoeff();
  CHECK((dense - dense.transpose()).cwiseAbs().maxCoeff() < 1e-5 * size);
  CHECK(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(dense).eigenvalues().minCoeff() > -1e-5 * size);
}

TEST_CASE("EveryLaw.turning_and_shifting_the_sheet_turns_its_forces") {
  const ElasticLaw law =
      GENERATE(ElasticLaw::st_venant_kirchhoff, ElasticLaw::stable_neo_hookean, ElasticLaw::incompressible_neo_hookean);
  const double network_share = GENERATE(0.0, 0.3, 1.0);
  const SheetMesh sheet = small_sheet();
  Membrane membrane(sheet.flat_mm, sheet.F, 1, material(law, network_share));
  const Positions x = shaken(sheet, 0.3, 6);
  membrane.begin_step(x, none_held(sheet));
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.1, Vec3(1, 2, -0.5).normalized()).toRotationMatrix();
  const Positions turned = (x * turn.transpose()).rowwise() + Eigen::RowVector3d(30, -4, 7);
  const int n = static_cast<int>(x.rows());
  Positions force = Positions::Zero(n, 3), force_turned = force;
  membrane.add_forces(x, for_ever, 0, n, force, nullptr);
  membrane.add_forces(turned, for_ever, 0, n, force_turned, nullptr);
  CHECK((force * turn.transpose() - force_turned).cwiseAbs().maxCoeff() < 1e-11);
  CHECK(force.colwise().sum().cwiseAbs().maxCoeff() < 1e-12);  // nothing pushes itself away
}

/// Equal stretch in both directions: sigma h = Y h / (1 - nu) eps for both laws as eps goes to 0.
TEST_CASE("EveryLaw.small_stretch_has_plane_stress_stiffness") {
  const ElasticLaw law =
      GENERATE(ElasticLaw::st_venant_kirchhoff, ElasticLaw::stable_neo_hookean, ElasticLaw::incompressible_neo_hookean);
  const double network_share = GENERATE(0.0, 0.3, 1.0);
  const SheetMesh sheet = make_sheet_mesh(Vec2(20, 20), 8);
  const MembraneMaterial m = material(law, network_share);
  Membrane membrane(sheet.flat_mm, sheet.F, 1, m);
  double last = 0;
  for (const double strain : {1e-3, 1e-4}) {
    Positions x = Positions::Zero(sheet.flat_mm.rows(), 3);
    membrane.begin_step((x.leftCols(2) = sheet.flat_mm, x), none_held(sheet));
    x.leftCols(2) *= 1 + strain;
    const double poisson_ratio = law == ElasticLaw::incompressible_neo_hookean ? 0.5 : m.poisson_ratio;
    const double energy = membrane.energy(x, for_ever),
                 expected = 400 * m.young_mpa / (1 - poisson_ratio) * strain * strain;
    const double error = std::abs(energy / expected - 1);
    CHECK(error < 3 * strain);
    if (last > 0) {
      CHECK_THAT(last / error, WithinAbs(10, 1));  // first order in the strain
    }
    last = error;
  }
}

/// Energy (mJ/mm^3) of the incompressible neo-Hookean law, E/6 (l1^2 + l2^2 + l3^2 - 3) with l3 = 1/(l1 l2) [Tre75].
double incompressible_density(double young_mpa, double l1, double l2) {
  return young_mpa / 6 * (l1 * l1 + l2 * l2 + 1 / (l1 * l1 * l2 * l2) - 3);
}

TEST_CASE("IncompressibleLaw.energy_of_an_even_stretch_is_the_closed_form") {
  const double network_share = GENERATE(0.0, 0.3, 1.0);
  const SheetMesh sheet = make_sheet_mesh(Vec2(20, 10), 32);
  const MembraneMaterial m = material(ElasticLaw::incompressible_neo_hookean, network_share);
  Membrane membrane(sheet.flat_mm, sheet.F, 0.8, m);
  Positions x = Positions::Zero(sheet.flat_mm.rows(), 3);
  for (const auto& [l1, l2] : {std::pair(1.8, 1.3), std::pair(2.5, 0.7), std::pair(1.0, 1.0)}) {
    x.col(0) = l1 * sheet.flat_mm.col(0);
    x.col(1) = l2 * sheet.flat_mm.col(1);
    membrane.begin_step(x, none_held(sheet));
    CHECK_THAT(membrane.energy(x, for_ever), WithinAbs(160 * incompressible_density(m.young_mpa, l1, l2), 1e-9));
  }
}

TEST_CASE("IncompressibleLaw.energy_of_an_uneven_stretch_converges_with_second_order") {
  const MembraneMaterial m = material(ElasticLaw::incompressible_neo_hookean);
  const double length = 20, amplitude = 3;
  const auto stretch = [&](double at) {
    return 1.4 + amplitude * std::numbers::pi / length * std::cos(std::numbers::pi * at / length);
  };
  double expected = 0;
  constexpr int parts = 4000;
  for (int i = 0; i < parts; ++i) {
    const double at = length * ((i + 0.5) / parts - 0.5);
    expected += length / parts * length * 0.8 * incompressible_density(m.young_mpa, stretch(at), 1);
  }
  std::vector<double> errors;
  for (const int triangles : {128, 512, 2048}) {
    const SheetMesh sheet = make_sheet_mesh(Vec2(length, length), triangles);
    Membrane membrane(sheet.flat_mm, sheet.F, 0.8, m);
    Positions x = Positions::Zero(sheet.flat_mm.rows(), 3);
    x.leftCols(2) = sheet.flat_mm;
    for (Eigen::Index i = 0; i < x.rows(); ++i)
      x(i, 0) = 1.4 * x(i, 0) + amplitude * std::sin(std::numbers::pi * x(i, 0) / length);
    membrane.begin_step(x, none_held(sheet));
    errors.push_back(std::abs(membrane.energy(x, for_ever) - expected));
  }
  CHECK_THAT(std::log2(errors[0] / errors[1]), WithinAbs(2, 0.2));
  CHECK_THAT(std::log2(errors[1] / errors[2]), WithinAbs(2, 0.2));
}

/// Pulled alike in two directions the sheet is stiffer than pulled in one alone, in the ratio of the closed forms
/// [Tre75]: E/3 (l - l^-5) against E/3 (l - l^-2) for each mm^2 of the flat sheet.
TEST_CASE("IncompressibleLaw.pull_in_one_and_in_two_directions") {
  const SheetMesh sheet = make_sheet_mesh(Vec2(20, 20), 32);
  const MembraneMaterial m = material(ElasticLaw::incompressible_neo_hookean);
  Membrane membrane(sheet.flat_mm, sheet.F, 1, m);
  const auto pull = [&](double l1, double l2) {
    Positions x = Positions::Zero(sheet.flat_mm.rows(), 3), force = x;
    x.col(0) = l1 * sheet.flat_mm.col(0);
    x.col(1) = l2 * sheet.flat_mm.col(1);
    membrane.begin_step(x, none_held(sheet));
    membrane.add_forces(x, for_ever, 0, static_cast<int>(x.rows()), force, nullptr);
    double sum = 0;
    for (Eigen::Index i = 0; i < x.rows(); ++i)
      if (sheet.flat_mm(i, 0) > 10 - 1e-9) sum -= force(i, 0);
    return sum / 20;
  };
  const double l = 2;
  CHECK_THAT(pull(l, l), WithinAbs(m.young_mpa / 3 * (l - std::pow(l, -5)), 1e-9));
  CHECK_THAT(pull(l, 1 / std::sqrt(l)), WithinAbs(m.young_mpa / 3 * (l - std::pow(l, -2)), 1e-9));
}

TEST_CASE("Membrane.sheet_over_four_triangles_and_over_many_has_the_same_energy") {
  // The strain is linear in space for an affine map: any triangulation gives the exact energy.
  const Eigen::Matrix2d A = (Eigen::Matrix2d() << 1.2, 0.1, -0.05, 0.9).finished();
  double first = 0;
  for (const int triangles : {8, 48, 500}) {
    const SheetMesh sheet = make_sheet_mesh(Vec2(12, 10), triangles);
    Membrane membrane(sheet.flat_mm, sheet.F, 1, material(ElasticLaw::st_venant_kirchhoff));
    Positions x = Positions::Zero(sheet.flat_mm.rows(), 3);
    x.leftCols(2) = sheet.flat_mm;
    membrane.begin_step(x, none_held(sheet));
    x.leftCols(2) = sheet.flat_mm * A.transpose();
    const double energy = membrane.energy(x, for_ever);
    if (first == 0) first = energy;
    CHECK_THAT(energy, WithinAbs(first, 1e-12 * first));
  }
  const Eigen::Matrix2d strain = 0.5 * (A.transpose() * A - Eigen::Matrix2d::Identity());
  const MembraneMaterial m;
  const double nu = m.poisson_ratio;
  const double exact = 0.5 * 120 * m.young_mpa / (1 - nu * nu) *
                       ((1 - nu) * (strain * strain).trace() + nu * strain.trace() * strain.trace());
  CHECK_THAT(first, WithinAbs(exact, 1e-12 * exact));
}

/// One triangle held at a constant stretch: the elastic strain decays to the yield strain (elastic excess) or to 0
/// (total strain) like exp(-c t); implicit steps do so with first order in dt.
TEST_CASE("Membrane.creep_at_constant_stretch_follows_its_law_with_first_order") {
  for (const YieldRule rule : {YieldRule::elastic_excess, YieldRule::total_strain}) {
    const SheetMesh sheet = make_sheet_mesh(Vec2(10, 10), 8);
    MembraneMaterial m;
    m.yield_rule = rule;
    m.creep_per_s = 100;
    m.yield_strain = 0.04;
    m.flow_stop_mm = 0;
    double errors[3];
    int level = 0;
    const double end_s = 0.01;
    for (const int steps : {40, 80, 160}) {
      Membrane membrane(sheet.flat_mm, sheet.F, 1, m);
      Positions x = Positions::Zero(sheet.flat_mm.rows(), 3);
      x.leftCols(2) = 1.06 * sheet.flat_mm;
      for (int k = 0; k < steps; ++k) {
        membrane.begin_step(x, none_held(sheet));
        membrane.end_step(x, end_s / steps);
      }
      // The reference: the same law, integrated finely, for the stretch of the rest state (equal in both directions).
      double rest = 1;
      const int fine = 200000;
      for (int k = 0; k < fine; ++k) {
        const double e = 0.5 * (1.06 * 1.06 / (rest * rest) - 1), size = std::sqrt(2.0) * std::abs(e);
        const double share = rule == YieldRule::total_strain ? 1 : std::max(0.0, 1 - m.yield_strain / size);
        rest *= std::sqrt(1 + 2 * end_s / fine * m.creep_per_s * share * e);
      }
      const double expected = std::sqrt(2.0) * 0.5 * (1.06 * 1.06 / (rest * rest) - 1);
      errors[level++] = std::abs(membrane.elastic_strain(x, 3) - expected);
    }
    CHECK_THAT(std::log2(errors[0] / errors[1]), WithinAbs(1, 0.1));
    CHECK_THAT(std::log2(errors[1] / errors[2]), WithinAbs(1, 0.1));
    CHECK(errors[2] < 2e-4);
  }
}

TEST_CASE("Membrane.rest_lengths_of_the_flow_agree_with_the_thesis") {
  // T s = e (thesis 4.2.2): the plastic strain, written with eq. (4.1) as a combination of differences of squared edge
  // lengths, gives the new rest lengths; the same as the rest metric kept here.
  const SheetMesh sheet = small_sheet();
  MembraneMaterial m;
  m.flow_stop_mm = 0;
  Membrane membrane(sheet.flat_mm, sheet.F, 1, m);
  const Positions x = shaken(sheet, 0.3, 7);
  membrane.begin_step(x, none_held(sheet));
  const double dt = 1e-3, a = dt * m.creep_per_s;
  int flowing = 0;
  for (int f = 0; f < membrane.face_count(); f += 5) {
    Vec3 flat, now;  // squared lengths of 01, 12, 20
    for (int k = 0; k < 3; ++k) {
      const int i = sheet.F(f, k), j = sheet.F(f, (k + 1) % 3);
      flat[k] = (sheet.flat_mm.row(i) - sheet.flat_mm.row(j)).squaredNorm();
      now[k] = (x.row(i) - x.row(j)).squaredNorm();
    }
    const double size = membrane.elastic_strain(x, f);
    if (size <= m.yield_strain) continue;
    ++flowing;
    const double kept = (1 + a * m.yield_strain / size) / (1 + a);
    Membrane after(sheet.flat_mm, sheet.F, 1, m);
    after.begin_step(x, none_held(sheet));
    after.end_step(x, dt);
    // Strain is linear in the squared lengths, so its plastic part moves them by the same share.
    CHECK((after.rest_squared_lengths(f) - (flat + (1 - kept) * (now - flat))).cwiseAbs().maxCoeff() < 1e-11);
  }
  CHECK(flowing > 3);
}

TEST_CASE("Membrane.flow_ends_where_the_sheet_is_thin") {
  const SheetMesh sheet = make_sheet_mesh(Vec2(10, 10), 8);
  MembraneMaterial m;
  m.flow_stop_mm = 0.5;
  Membrane membrane(sheet.flat_mm, sheet.F, 1, m);
  Positions x = Positions::Zero(sheet.flat_mm.rows(), 3);
  x.leftCols(2) = 1.5 * sheet.flat_mm;  // 0.444 mm thick
  membrane.begin_step(x, none_held(sheet));
  membrane.end_step(x, 1e-2);
  CHECK_THAT(membrane.elastic_strain(x, 0), WithinAbs(std::sqrt(2.0) * 0.5 * (2.25 - 1), 1e-12));
  CHECK_THAT(membrane.thickness_mm()[0], WithinAbs(1 / 2.25, 1e-12));
}

TEST_CASE("HingeBending.angle_and_gradient") {
  const Vec3 a(0, 0, 0), b(2, 0.3, 0.1), c(0.7, 1.5, -0.4), d(1.1, -1.2, -0.6);
  std::array<Vec3, 4> gradient;
  const double angle = hinge_angle(a, b, c, d, &gradient);
  CHECK(angle > 0);  // the edge stands out
  std::array<Vec3, 4> place{a, b, c, d};
  for (std::size_t v = 0; v < 4; ++v)
    for (int k = 0; k < 3; ++k) {
      auto moved = place;
      moved[v][k] += 1e-6;
      const double above = hinge_angle(moved[0], moved[1], moved[2], moved[3], nullptr);
      moved[v][k] -= 2e-6;
      const double below = hinge_angle(moved[0], moved[1], moved[2], moved[3], nullptr);
      CHECK_THAT(gradient[v][k], WithinAbs((above - below) / 2e-6, 1e-8));
    }
  // A right angle, exactly.
  CHECK_THAT(hinge_angle(Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, -1), nullptr),
             WithinAbs(std::numbers::pi / 2, 1e-15));
}

TEST_CASE("HingeBending.forces_are_the_negative_gradient_of_the_energy") {
  const SheetMesh sheet = small_sheet();
  HingeBending bending(sheet.F, static_cast<int>(sheet.flat_mm.rows()), 2.75, 0.35, 1e-3);
  const std::vector<double> thickness(static_cast<std::size_t>(sheet.F.rows()), 0.7);
  bending.begin_step(shaken(sheet, 0.1, 8), thickness, std::vector<double>(thickness.size(), 1));
  Positions x = shaken(sheet, 0.4, 9), force = Positions::Zero(x.rows(), 3);
  bending.add_forces(x, 2e-3, force, nullptr);
  const double step = 1e-6, scale = force.cwiseAbs().maxCoeff();
  for (Eigen::Index i = 0; i < x.size(); i += 5) {
    const double at = x.data()[i];
    x.data()[i] = at + step;
    const double above = bending.energy(x, 2e-3);
    x.data()[i] = at - step;
    const double below = bending.energy(x, 2e-3);
    x.data()[i] = at;
    CHECK_THAT(force.data()[i], WithinAbs(-(above - below) / (2 * step), 1e-6 * scale));
  }
}

}  // namespace
}  // namespace formwright
