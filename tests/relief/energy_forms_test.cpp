// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/relief/energy_forms.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "bench/relief/bounded_least_squares.h"
#include "bench/relief/iterated_energy.h"
#include "bench/relief/rounded_box.h"
#include "geometry/mesh/measures.h"
#include "geometry/test_meshes.h"
#include "relief/appearance_energy.h"
#include "relief/relief.h"

namespace formwright::test {
namespace {
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;

constexpr double curvature_floor = 1e-4;

ViewFrame seen(const TriangleMesh& mesh, Projection projection) {
  ReliefOptions options;
  options.projection = projection;
  options.field_of_view_deg = 35;
  options.direction = {0.2, 0.1, -1};
  return make_view_frame(mesh, options);
}

Eigen::VectorXd random_depths(Eigen::Index n, std::uint64_t seed) {
  Random random(seed);
  return Eigen::VectorXd::NullaryExpr(n, [&] { return random.uniform(-0.1, 0.1); });
}

std::vector<std::pair<std::string, LeastSquares>> all_forms(const EnergyForms& forms, const Eigen::VectorXd& deformed) {
  return {{"proposed", forms.proposed()},
          {"scale dependent", forms.scale_dependent()},
          {"curvature divided", forms.curvature_divided(curvature_floor)},
          {"updated", forms.updated(deformed)},
          {"updated normals", forms.updated_normals(deformed, curvature_floor)}};
}

TEST_CASE("EnergyForms.TheProposedOneIsTheEnergyOfTheRelief") {
  const TriangleMesh mesh = icosphere(2);
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    const ViewFrame frame = seen(mesh, projection);
    const Eigen::VectorXd u = random_depths(frame.P.rows(), 3);
    const double expected = AppearanceEnergy(frame, mesh.F, Eigen::VectorXd::Ones(u.size()))(u);
    CHECK_THAT(EnergyForms(frame, mesh.F).proposed()(u), WithinRel(expected, 1e-10));
  }
}

TEST_CASE("EnergyForms.AllAreZeroAtTheModel") {
  const TriangleMesh mesh = icosphere(2);
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    const EnergyForms forms(seen(mesh, projection), mesh.F);
    const Eigen::VectorXd model = Eigen::VectorXd::Zero(mesh.V.rows()), other = random_depths(mesh.V.rows(), 4);
    for (const auto& [name, energy] : all_forms(forms, model)) {
      CAPTURE(name);
      CHECK(energy(model) <= 1e-20 * energy(other));
    }
  }
}

TEST_CASE("EnergyForms.OnlyTheScaleDependentOneChangesWithTheScale") {
  const TriangleMesh mesh = icosphere(4);
  const ViewFrame frame = seen(mesh, Projection::perspective);
  const EnergyForms forms(frame, mesh.F);
  const Eigen::VectorXd scaled = Eigen::VectorXd::Constant(mesh.V.rows(), 0.5), other = random_depths(mesh.V.rows(), 5);
  for (const auto& [name, energy] : all_forms(forms, scaled)) {
    CAPTURE(name);
    if (name == "scale dependent") continue;
    CHECK(energy(scaled) <= 1e-20 * energy(other));
  }
  // A ball of radius r has |L x| = 2 / r and an area of 4 pi r^2: the form is (kappa u)^2 16 pi.
  const double change = 0.5 * frame.kappa;
  CHECK_THAT(forms.scale_dependent()(scaled), WithinRel(change * change * 16 * std::numbers::pi, 2e-3));
}

TEST_CASE("EnergyForms.FarAwayTheScaleDependentOneIsTheProposedOne") {
  const TriangleMesh mesh = icosphere(2);
  const EnergyForms forms(seen(mesh, Projection::orthographic), mesh.F);
  const Eigen::VectorXd u = random_depths(mesh.V.rows(), 6);
  CHECK_THAT(forms.scale_dependent()(u), WithinRel(forms.proposed()(u), 1e-12));
}

TEST_CASE("EnergyForms.DividingByTheCurvatureOfABallIsAConstantFactor") {
  const TriangleMesh mesh = icosphere(3);
  const EnergyForms forms(seen(mesh, Projection::perspective), mesh.F);
  CHECK(forms.curvature_range(curvature_floor) < 1.2);
  const Eigen::VectorXd first = random_depths(mesh.V.rows(), 7), second = random_depths(mesh.V.rows(), 8);
  const LeastSquares divided = forms.curvature_divided(curvature_floor), proposed = forms.proposed();
  CHECK_THAT(divided(first) / proposed(first), WithinRel(divided(second) / proposed(second), 0.05));
}

TEST_CASE("EnergyForms.GradientsAreThoseOfDifferences") {
  const TriangleMesh mesh = icosphere(2);
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    const EnergyForms forms(seen(mesh, projection), mesh.F);
    const Eigen::VectorXd u = random_depths(mesh.V.rows(), 9);
    for (const auto& [name, energy] : all_forms(forms, random_depths(mesh.V.rows(), 10))) {
      CAPTURE(name);
      const Eigen::VectorXd gradient = energy.gradient(u);
      for (int i = 0; i < 10; ++i) {
        Eigen::VectorXd step = Eigen::VectorXd::Zero(u.size());
        step[i] = 1e-5;
        CHECK_THAT((energy(u + step) - energy(u - step)) / 2e-5,
                   WithinAbs(gradient[i], 1e-6 * gradient.cwiseAbs().maxCoeff()));
      }
    }
  }
}

TEST_CASE("BoundedLeastSquares.KeepsBoundsAndOrder") {
  // |u - (1, 0, 9)|^2 with u_1 >= u_0 and u_2 <= 2.
  LeastSquares energy{SparseMatrix(3, 3), Eigen::Vector3d(-1, 0, -9)};
  energy.rows.setIdentity();
  AllowedDepths allowed{Eigen::Vector3d::Constant(-1), Eigen::Vector3d::Constant(2), SparseMatrix(1, 3),
                        Eigen::VectorXd::Zero(1)};
  allowed.order.insert(0, 0) = -1;
  allowed.order.insert(0, 1) = 1;
  Context context;
  const BoundedMinimum minimum = BoundedLeastSquares(Positions()).minimise(energy, allowed, context);
  CHECK(minimum.converged);
  CHECK(minimum.u.isApprox(Eigen::Vector3d(0.5, 0.5, 2), 1e-5));
}

TEST_CASE("BoundedLeastSquares.FindsTheReliefOfTheProgram") {
  const TriangleMesh mesh = rounded_box(8, 0.1);
  ReliefOptions options;
  options.projection = Projection::orthographic;
  options.direction = {-0.55, -0.5, -1};
  options.depth_order = false;
  Context context;
  ReliefSolver solver(mesh, options, context);
  const Relief relief = solver.solve(options, context);
  const ViewFrame& frame = solver.frame();
  AllowedDepths allowed{-frame.P.col(2), -frame.P.col(2), SparseMatrix(0, frame.P.rows()), Eigen::VectorXd()};
  allowed.lower.array() -= options.thickness_mm / options.width_mm;
  const LeastSquares energy = EnergyForms(frame, mesh.F).proposed();
  const BoundedMinimum minimum = BoundedLeastSquares(frame.P).minimise(energy, allowed, context);
  CHECK(minimum.converged);
  CHECK_THAT(energy(minimum.u), WithinRel(relief.energy, 1e-6));
}

TEST_CASE("IteratedEnergy.EndsAtOnceWhereTheModelFits") {
  const TriangleMesh mesh = rounded_box(4, 0);
  const ViewFrame frame = seen(mesh, Projection::orthographic);
  const EnergyForms forms(frame, mesh.F);
  const Eigen::Index n = mesh.V.rows();
  const AllowedDepths allowed{Eigen::VectorXd::Constant(n, -1), Eigen::VectorXd::Constant(n, 1), SparseMatrix(0, n),
                              Eigen::VectorXd()};
  Context context;
  const IteratedMinimum minimum = iterate([&](const Eigen::VectorXd& u) { return forms.updated(u); }, allowed,
                                          Eigen::VectorXd::Zero(n), frame.P, IterationSettings(), context);
  CHECK(minimum.converged);
  CHECK(minimum.change.size() == 1);
}

TEST_CASE("RoundedBox.HasTheVerticesOfFigure35") {
  const TriangleMesh sharp = rounded_box(16, 0), round = rounded_box(32, 0.5);
  CHECK(sharp.vertex_count() == 1538);
  CHECK_THAT(signed_volume(sharp), WithinAbs(1, 1e-12));
  CHECK_THAT(signed_volume(round), WithinRel(std::numbers::pi / 6, 1e-2));
}

}  // namespace
}  // namespace formwright::test
