// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/appearance_energy.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>

#include "geometry/operators/laplacian.h"
#include "geometry/test_meshes.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

ViewFrame frame_of(const TriangleMesh& mesh, Projection projection, double field_of_view_deg = 35) {
  ReliefOptions options;
  options.projection = projection;
  options.field_of_view_deg = field_of_view_deg;
  options.direction = {0.2, 0.1, -1};
  return make_view_frame(mesh, options);
}

Eigen::VectorXd random_vector(Eigen::Index n, std::uint64_t seed, double size) {
  test::Random random(seed);
  Eigen::VectorXd v(n);
  for (Eigen::Index i = 0; i < n; ++i) v[i] = random.uniform(-size, size);
  return v;
}

/// Eq. (3.13) as it is written, from lambda, in the thesis's own symbols.
double thesis_energy(const ViewFrame& frame, const Triangles& F, const Eigen::VectorXd& w,
                     const Eigen::VectorXd& lambda) {
  const Eigen::Index n = frame.P.rows();
  Positions V = frame.P;  // seen from o = 0
  V.col(2).array() += 1 / frame.kappa;
  const Eigen::VectorXd lambda0 = V.rowwise().norm();
  const Positions V_hat = V.array().colwise() / lambda0.array();
  const TriangleMesh mesh{frame.P, F};
  const Eigen::VectorXd A = vertex_areas(mesh);
  const Eigen::SparseMatrix<double> L = A.cwiseInverse().asDiagonal() * cotangent_laplacian(mesh);
  const Positions now = L * (lambda.asDiagonal() * V_hat), before = L * (lambda0.asDiagonal() * V_hat);
  double sum = 0;
  for (Eigen::Index i = 0; i < n; ++i)
    sum += w[i] * w[i] * A[i] * (now.row(i) - before.row(i) * lambda[i] / lambda0[i]).squaredNorm();
  return sum;
}

Eigen::VectorXd lambda_of(const ViewFrame& frame, const Eigen::VectorXd& u) {
  Positions V = frame.P;
  V.col(2).array() += 1 / frame.kappa;
  return V.rowwise().norm().array() * (1 + frame.kappa * u.array());
}

TEST_CASE("AppearanceEnergy.IsEquation313") {
  const TriangleMesh mesh = test::icosphere(2);
  const ViewFrame frame = frame_of(mesh, Projection::perspective);
  const Eigen::VectorXd w = random_vector(frame.P.rows(), 3, 0.4).array() + 0.6;
  const AppearanceEnergy energy(frame, mesh.F, w);
  const Eigen::VectorXd u = random_vector(frame.P.rows(), 5, 0.1);
  const double expected = thesis_energy(frame, mesh.F, w, lambda_of(frame, u));
  CHECK_THAT(energy(u), WithinAbs(expected, 1e-9 * expected));
}

TEST_CASE("AppearanceEnergy.IsZeroForTheModelAndEveryUniformScaling") {
  const TriangleMesh mesh = test::icosphere(3);
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    const ViewFrame frame = frame_of(mesh, projection);
    const AppearanceEnergy energy(frame, mesh.F, Eigen::VectorXd::Ones(frame.P.rows()));
    const double reference = energy(random_vector(frame.P.rows(), 1, 0.1));
    CHECK(energy(Eigen::VectorXd::Zero(frame.P.rows())) == 0);
    CHECK(energy(Eigen::VectorXd::Constant(frame.P.rows(), 0.37)) <= 1e-20 * reference);
  }
}

TEST_CASE("AppearanceEnergy.GrowsWithTheSquareOfTheScale") {
  // E(2 s) = 4 E(s): s = 1 + kappa u, so 2 s belongs to 2 u + 1 / kappa.
  const TriangleMesh mesh = test::icosphere(2);
  const ViewFrame frame = frame_of(mesh, Projection::perspective);
  const AppearanceEnergy energy(frame, mesh.F, Eigen::VectorXd::Ones(frame.P.rows()));
  const Eigen::VectorXd u = random_vector(frame.P.rows(), 9, 0.1);
  CHECK_THAT(energy(2 * u + Eigen::VectorXd::Constant(u.size(), 1 / frame.kappa)),
             WithinAbs(4 * energy(u), 1e-10 * energy(u)));
}

TEST_CASE("AppearanceEnergy.TheHessianIsTheEnergysSecondDifference") {
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    const TriangleMesh mesh = test::icosphere(2);
    const ViewFrame frame = frame_of(mesh, projection);
    const Eigen::VectorXd w = random_vector(frame.P.rows(), 2, 0.3).array() + 0.7;
    const AppearanceEnergy energy(frame, mesh.F, w);
    Context context;
    const SparseMatrix lower = energy.lower_hessian(context);
    const Eigen::MatrixXd Q = Eigen::MatrixXd(lower).selfadjointView<Eigen::Lower>();
    const Eigen::VectorXd u = random_vector(frame.P.rows(), 8, 0.1);
    CHECK_THAT(u.dot(Q * u), WithinAbs(energy(u), 1e-11 * energy(u)));
    // The gradient 2 Q u against central differences.
    const Eigen::VectorXd gradient = 2 * Q * u;
    for (int i = 0; i < 20; ++i) {
      Eigen::VectorXd step = Eigen::VectorXd::Zero(u.size());
      step[i] = 1e-5;
      CHECK_THAT((energy(u + step) - energy(u - step)) / 2e-5,
                 WithinAbs(gradient[i], 1e-6 * gradient.cwiseAbs().maxCoeff()));
    }
    // Null space: the constants and nothing else.
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(Q);
    CHECK(std::abs(eigen.eigenvalues()[0]) < 1e-11 * eigen.eigenvalues().maxCoeff());
    CHECK(eigen.eigenvalues()[1] > 1e-9 * eigen.eigenvalues().maxCoeff());
  }
}

TEST_CASE("AppearanceEnergy.DoesNotDependOnScaleOrPlace") {
  TriangleMesh mesh = test::icosphere(2);
  const auto value = [](const TriangleMesh& m, const std::array<double, 3>& direction,
                        const std::array<double, 3>& up) {
    ReliefOptions options;
    options.direction = direction;
    options.up = up;
    const ViewFrame frame = make_view_frame(m, options);
    return AppearanceEnergy(frame, m.F, Eigen::VectorXd::Ones(m.V.rows()))(random_vector(m.V.rows(), 4, 0.1));
  };
  const double reference = value(mesh, {0.2, 0.1, -1}, {0, 1, 0});
  const Eigen::Matrix3d R = Eigen::AngleAxisd(1.1, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  TriangleMesh moved{(mesh.V * R.transpose() * 37.0).rowwise() + Eigen::RowVector3d(5, -90, 12), mesh.F};
  const Vec3 d = R * Vec3(0.2, 0.1, -1), up = R * Vec3(0, 1, 0);
  CHECK_THAT(value(moved, {d.x(), d.y(), d.z()}, {up.x(), up.y(), up.z()}), WithinAbs(reference, 1e-9 * reference));
}

TEST_CASE("AppearanceEnergy.ConvergesToTheOrthographicEnergy") {
  const TriangleMesh mesh = test::icosphere(2);
  const Eigen::VectorXd u = random_vector(mesh.V.rows(), 6, 0.1), ones = Eigen::VectorXd::Ones(mesh.V.rows());
  const double limit = AppearanceEnergy(frame_of(mesh, Projection::orthographic), mesh.F, ones)(u);
  double previous = 0, order = 0;
  for (const double angle : {0.4, 0.2, 0.1, 0.05}) {
    const double difference =
        std::abs(AppearanceEnergy(frame_of(mesh, Projection::perspective, angle), mesh.F, ones)(u) - limit);
    order = std::log2(previous / difference);
    previous = difference;
  }
  CHECK_THAT(order, WithinAbs(1, 0.05));  // first order in kappa
  // No digits are lost at a viewpoint 600 widths away.
  const double far = AppearanceEnergy(frame_of(mesh, Projection::perspective, 0.1), mesh.F, ones)(u);
  CHECK_THAT(far, WithinAbs(limit, 1e-2 * limit));
}

}  // namespace
}  // namespace formwright
