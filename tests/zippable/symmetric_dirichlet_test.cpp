// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/chart/symmetric_dirichlet.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "geometry/test_meshes.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

ReferenceTriangle random_reference(test::Random& random) {
  const double a = random.uniform(0.5, 2), b = random.uniform(0.5, 2);
  return reference_triangle(a, b, random.uniform(std::abs(a - b) + 0.1, a + b - 0.1));
}

/// A positively oriented image, now and then a very flat one.
std::array<Vec2, 3> random_image(test::Random& random) {
  for (;;) {
    std::array<Vec2, 3> u;
    for (Vec2& p : u) p = Vec2(random.uniform(-1, 1), random.uniform(-1, 1));
    const Vec2 e1 = u[1] - u[0], e2 = u[2] - u[0];
    if (e1.x() * e2.y() - e1.y() * e2.x() > 0.05) return u;
  }
}

TEST_CASE("SymmetricDirichlet.IsFourForAnIsometryAndNamesItsStretches") {
  const ReferenceTriangle reference = reference_triangle(3, 4, 5);
  CHECK_THAT(reference.area, WithinAbs(6, 1e-14));
  const double turn = 0.7;
  Eigen::Matrix2d R;
  R << std::cos(turn), -std::sin(turn), std::sin(turn), std::cos(turn);
  // Corner 0 at the origin, side 01 (3) along x, side 12 (4) upwards.
  const std::array<Vec2, 3> image{R * Vec2(1, 1), R * Vec2(4, 1), R * Vec2(4, 5)};
  CHECK_THAT(symmetric_dirichlet(jacobian(reference, image)), WithinAbs(4, 1e-13));
  const std::array<Vec2, 3> stretched{Vec2(0, 0), Vec2(2 * 3, 0), Vec2(2 * 3, 3 * 4)};
  CHECK_THAT(symmetric_dirichlet(jacobian(reference, stretched)), WithinAbs(4 + 9 + 1 / 4.0 + 1 / 9.0, 1e-12));
  const std::array<Vec2, 3> flipped{Vec2(0, 0), Vec2(3, 0), Vec2(3, -4)};
  CHECK(std::isinf(symmetric_dirichlet(jacobian(reference, flipped))));
}

TEST_CASE("SymmetricDirichlet.DerivativesAreThoseOfFiniteDifferences") {
  test::Random random(11);
  for (int trial = 0; trial < 200; ++trial) {
    const ReferenceTriangle reference = random_reference(random);
    const auto u = random_image(random);
    const DirichletTerms t = symmetric_dirichlet_terms(reference, u, false);
    CHECK_THAT(t.energy, WithinAbs(symmetric_dirichlet(jacobian(reference, u)), 1e-11 * t.energy));
    for (int i = 0; i < 6; ++i) {
      const double step = 1e-6;
      auto plus = u, minus = u;
      plus[i / 2][i % 2] += step, minus[i / 2][i % 2] -= step;
      const DirichletTerms p = symmetric_dirichlet_terms(reference, plus, false),
                           m = symmetric_dirichlet_terms(reference, minus, false);
      CHECK_THAT(t.gradient[i], WithinAbs((p.energy - m.energy) / (2 * step), 1e-5 * (1 + t.gradient.norm())));
      for (int j = 0; j < 6; ++j)
        CHECK_THAT(t.hessian(j, i),
                   WithinAbs((p.gradient[j] - m.gradient[j]) / (2 * step), 1e-5 * (1 + t.hessian.norm())));
    }
  }
}

TEST_CASE("SymmetricDirichlet.OnlyTheTwistIsProjected") {
  test::Random random(12);
  int projected = 0;
  for (int trial = 0; trial < 500; ++trial) {
    const ReferenceTriangle reference = random_reference(random);
    const auto u = random_image(random);
    const DirichletTerms exact = symmetric_dirichlet_terms(reference, u, false),
                         convex = symmetric_dirichlet_terms(reference, u, true);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> of_exact(exact.hessian), of_convex(convex.hessian);
    CHECK(of_convex.eigenvalues()[0] >= -1e-9 * of_convex.eigenvalues()[5]);
    const double minimum = of_exact.eigenvalues()[0];
    CHECK((of_exact.eigenvalues().array() < -1e-9 * of_exact.eigenvalues()[5]).count() ==
          (minimum < -1e-9 * of_exact.eigenvalues()[5] ? 1 : 0));
    if (minimum < -1e-6) ++projected;
    else if (minimum > -1e-12 * of_exact.eigenvalues()[5]) {
      CHECK((exact.hessian - convex.hessian).norm() <= 1e-9 * exact.hessian.norm());
    }
  }
  CHECK(projected > 20);
}

}  // namespace
}  // namespace formwright
