// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/chart/parameterisation.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "zippable/chart/newton_system.h"
#include "zippable/zippable_shapes.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

using std::numbers::pi;

Parameterisation solve(const Segmentation& s, double tolerance = 1e-14) {
  Context context;
  return parameterise(s, {tolerance}, context);
}

double min_determinant(const Segmentation& s, const Parameterisation& p) {
  double minimum = 1e300;
  for (int f = 0; f < s.mesh.face_count(); ++f) {
    const Vec2 e1 = p.corners_mm.row(3 * f + 1) - p.corners_mm.row(3 * f),
               e2 = p.corners_mm.row(3 * f + 2) - p.corners_mm.row(3 * f);
    minimum = std::min(minimum, e1.x() * e2.y() - e1.y() * e2.x());
  }
  return minimum;
}

TEST_CASE("Parameterisation.OfACylinderIsItsUnrolling") {
  // The side of a prism is developable: no distortion at all, whatever the triangles.
  const int around = 40;
  const double radius = 20, height = 70;
  const Segmentation s = test::alone(test::cylinder_side(radius, height, around, 30));
  const Parameterisation p = solve(s);
  const double perimeter = around * 2 * radius * std::sin(pi / around);
  // Rows turned against each other are antiprisms, which are a little longer than upright: compare with a fine mesh
  // instead.
  CHECK_THAT(p.period_mm[0], WithinAbs(perimeter, 2e-3 * perimeter));
  CHECK_THAT(p.height_mm[0], WithinAbs(height, 2e-3 * height));
  CHECK(p.distortion_max < 1 + 2e-4);
  CHECK(constraint_residual_mm(s, p) <= 1e-10);
  // An upright prism: exact.
  TriangleMesh tube = test::tube(48, 24);
  const Parameterisation exact = solve(test::alone(tube));
  CHECK_THAT(exact.period_mm[0], WithinAbs(48 * 2 * std::sin(pi / 48), 1e-10));
  CHECK_THAT(exact.height_mm[0], WithinAbs(1, 1e-10));
  CHECK_THAT(exact.distortion_max, WithinAbs(1, 1e-10));
}

TEST_CASE("Parameterisation.OfAConeIsTheBestRotationallySymmetricMap") {
  // A frustum of radii r1 > r2 and slant L: by symmetry x = p t, y = y(s). With c(s) = p / (2 pi r(s)) and a = y'(s)
  // the energy is the integral of r (c^2 + 1/c^2 + a^2 + 1/a^2): a = 1, and p^4 = (2 pi)^4 (integral of r^3) /
  // (integral of 1/r).
  const double r1 = 50, r2 = 20, rise = 60, slant = std::hypot(rise, r1 - r2);
  const auto radius3 = (std::pow(r1, 4) - std::pow(r2, 4)) / 4 / (r1 - r2) * slant,
             inverse = std::log(r1 / r2) / (r1 - r2) * slant;
  const double period = 2 * pi * std::pow(radius3 / inverse, 0.25);
  double error = 1;
  for (const int around : {24, 48, 96}) {
    const Segmentation s =
        test::alone(test::turned(around, around / 2, [&](double t) { return Vec2(r1 + t * (r2 - r1), t * rise); }));
    const Parameterisation p = solve(s);
    const double now = std::abs(p.period_mm[0] / period - 1) + std::abs(p.height_mm[0] / slant - 1);
    {
      INFO(around);
      CHECK(now < 0.4 * error);
    }  // second order
    error = now;
    CHECK(constraint_residual_mm(s, p) <= 1e-10);
  }
  CHECK(error < 1e-3);
}

TEST_CASE("Parameterisation.OfASphereIsTheBestRotationallySymmetricMap") {
  // The band between colatitudes e and pi - e of a unit sphere: r = sin(s).
  const double e = 0.2;
  double radius3 = 0, inverse = 0;
  const int steps = 200000;
  for (int i = 0; i < steps; ++i) {
    const double t = e + (pi - 2 * e) * (i + 0.5) / steps, r = std::sin(t);
    radius3 += r * r * r, inverse += 1 / r;
  }
  const double period = 2 * pi * std::pow(radius3 / inverse, 0.25);
  double error = 1;
  for (const int around : {32, 64, 128}) {
    const Segmentation s = test::alone(test::turned(around, around / 2, [&](double t) {
      const double colatitude = pi - e - t * (pi - 2 * e);
      return Vec2(std::sin(colatitude), std::cos(colatitude));
    }));
    const Parameterisation p = solve(s);
    const double now = std::abs(p.period_mm[0] / period - 1) + std::abs(p.height_mm[0] / (pi - 2 * e) - 1);
    {
      INFO(around);
      CHECK(now < 0.4 * error);
    }
    error = now;
  }
  CHECK(error < 2e-3);
}

TEST_CASE("Parameterisation.ConvergesOnEverySampleWithoutFlips") {
  for (const SampleInfo& sample : sample_catalog()) {
    INFO(sample.name);
    const Proposal proposal = test::proposed(sample.name, 3000);
    const Segmentation& s = proposal.segmentation;
    const Parameterisation p = solve(s, 1e-9);
    CHECK(constraint_residual_mm(s, p) <= 1e-10);
    CHECK(min_determinant(s, p) > 0);
    CHECK(p.iterations <= 40);
    CHECK(p.distortion_mean >= 1);
    CHECK(p.distortion_mean < 0.9 * p.energy_start + 0.2);
    SUCCEED(sample.name + "_iterations " << p.iterations);
  }
}

TEST_CASE("Parameterisation.GradientAndHessianInTheVariablesAreThoseOfFiniteDifferences") {
  const Proposal proposal = test::proposed("t_shape", 500);
  const Segmentation& s = proposal.segmentation;
  REQUIRE(s.part_count() >= 3);
  Context context;
  const SeamlessChart chart(s);
  NewtonSystem system(chart, context);
  // A smooth energy of the corners that is no parameterisation's: what is tested is how corners depend on variables.
  test::Random random(5);
  Eigen::VectorXd local(chart.local_count()), shared(chart.shared_count()), along(local.size()),
      along_shared(shared.size());
  for (double& x : local) x = random.uniform(-1, 1);
  for (double& x : shared) x = random.uniform(-1, 1);
  for (double& x : along) x = random.uniform(-1, 1);
  for (double& x : along_shared) x = random.uniform(-1, 1);
  const auto assemble = [&](double t) {
    const CornerCoordinates uv = chart.corners(local + t * along, shared + t * along_shared);
    system.assemble([&](int f) {
      Eigen::Matrix<double, 6, 1> q;
      for (int i = 0; i < 6; ++i) q[i] = uv(3 * f + i / 2, i % 2);
      DirichletTerms terms;
      const double r = q.squaredNorm(), sum = q.sum();
      terms.energy = std::sin(r) + sum * sum * sum;
      terms.gradient = 2 * std::cos(r) * q + Eigen::Matrix<double, 6, 1>::Constant(3 * sum * sum);
      terms.hessian = -4 * std::sin(r) * q * q.transpose() + Eigen::Matrix<double, 6, 6>::Constant(6 * sum);
      terms.hessian.diagonal().array() += 2 * std::cos(r);
      return terms;
    });
  };
  const double step = 1e-6;
  assemble(step);
  const double energy_plus = system.energy();
  const Eigen::VectorXd plus = system.gradient_local(), plus_shared = system.gradient_shared();
  assemble(-step);
  const double energy_minus = system.energy();
  const Eigen::VectorXd minus = system.gradient_local(), minus_shared = system.gradient_shared();
  assemble(0);
  const double slope = system.gradient_local().dot(along) + system.gradient_shared().dot(along_shared);
  CHECK_THAT(slope, WithinAbs((energy_plus - energy_minus) / (2 * step), 1e-5 * std::abs(slope)));
  Eigen::VectorXd product, product_shared;
  system.apply(along, along_shared, product, product_shared);
  CHECK((product - (plus - minus) / (2 * step)).norm() <= 1e-6 * product.norm());
  CHECK((product_shared - (plus_shared - minus_shared) / (2 * step)).norm() <= 1e-6 * product_shared.norm());
}

TEST_CASE("Parameterisation.MovesAndGrowsWithTheModel") {
  Context context;
  const TriangleMesh mesh = test::proposed("heart", 1500).segmentation.mesh;
  const std::vector<int> parts = test::proposed("heart", 1500).segmentation.face_segment;
  const Parameterisation p = solve(make_segmentation(mesh, parts));
  const TriangleMesh other = test::moved(test::rotated(mesh, Vec3(1, 2, 3), 0.9), Vec3(40, -20, 7), 3);
  const Parameterisation q = solve(make_segmentation(other, parts));
  REQUIRE(p.corners_mm.rows() == q.corners_mm.rows());
  CHECK((3 * p.corners_mm - q.corners_mm).cwiseAbs().maxCoeff() <= 1e-4);
  CHECK_THAT(p.distortion_mean, WithinAbs(q.distortion_mean, 1e-10));
}

TEST_CASE("Parameterisation.IsTheSameForAnyNumberOfThreads") {
  const Segmentation s = test::proposed("star", 2000).segmentation;
  const Parameterisation many = solve(s, 1e-9);
  const ThreadLimit one(1);
  const Parameterisation single = solve(s, 1e-9);
  CHECK((many.corners_mm - single.corners_mm).cwiseAbs().maxCoeff() == 0);
}

TEST_CASE("Parameterisation.StopsWhenAskedTo") {
  const Segmentation s = test::proposed("heart", 4000).segmentation;
  for (const int after : {0, 3, 10, 20}) {
    int asked = 0;
    Context context(Host{{}, [&] { return asked++ >= after; }, {}});
    try {
      parameterise(s, {}, context);
      FAIL("went on");
    } catch (const Error& error) {
      CHECK(error.code() == ErrorCode::cancelled);
    }
  }
}

TEST_CASE("Parameterisation.RefusesWhatIsNoCylinder") {
  Context context;
  TriangleMesh disc = test::grid(6, 6, 0.1);
  try {
    parameterise(test::alone(disc), {}, context);
    FAIL("accepted");
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::invalid_input);
    INFO(error.what());
    CHECK(std::string(error.what()).find("hole into it") != std::string::npos);
  }
}

}  // namespace
}  // namespace formwright
