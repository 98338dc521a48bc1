// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/baselines.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include "geometry/test_meshes.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

struct Scene {
  TriangleMesh mesh;
  ViewFrame frame;
  Visibility visibility;
};

Scene scene(const TriangleMesh& mesh, Projection projection) {
  ReliefOptions options;
  options.projection = projection;
  Scene s{mesh, make_view_frame(mesh, options), {}};
  Context context;
  s.visibility = find_visibility(s.frame, mesh.F, RayCaster(TriangleMesh{s.frame.P, mesh.F}), context);
  return s;
}

DepthBounds slab(const Scene& s, double thickness, const std::vector<char>& bounded) {
  const Eigen::Index n = s.frame.P.rows();
  DepthBounds bounds;
  bounds.nearest = Eigen::VectorXd::Constant(n, -thickness);
  bounds.farthest = Eigen::VectorXd::Zero(n);
  bounds.bounded = bounded;
  return bounds;
}

TEST_CASE("LinearCompression.FillsTheSlabAndKeepsTheOrder") {
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    const Scene s = scene(test::icosphere(3), projection);
    const std::vector<char> all(static_cast<std::size_t>(s.mesh.V.rows()), 1);
    const Eigen::VectorXd z = s.frame.depth(linear_compression(s.frame, slab(s, 0.05, all)));
    CHECK_THAT(z.minCoeff(), WithinAbs(-0.05, 1e-14));
    CHECK_THAT(z.maxCoeff(), WithinAbs(0, 1e-14));
    for (Eigen::Index i = 1; i < z.size(); ++i) CHECK((z[i] > z[i - 1]) == (s.frame.P(i, 2) > s.frame.P(i - 1, 2)));
  }
}

TEST_CASE("LinearCompression.OfAFlatModelIsFlat") {
  const Scene s = scene(test::grid(4, 4), Projection::orthographic);
  const std::vector<char> all(static_cast<std::size_t>(s.mesh.V.rows()), 1);
  CHECK(s.frame.depth(linear_compression(s.frame, slab(s, 0.05, all))).cwiseAbs().maxCoeff() == 0);
}

TEST_CASE("GradientDomain.FillsTheSlabOverTheVisiblePart") {
  const Scene s = scene(test::icosphere(4), Projection::perspective);
  Context context;
  const Eigen::VectorXd z =
      s.frame.depth(gradient_domain_compression(s.frame, s.mesh.F, s.visibility, 0.04, {}, context));
  double low = 1, high = -1;
  for (Eigen::Index i = 0; i < z.size(); ++i)
    if (s.visibility.vertex[static_cast<std::size_t>(i)]) low = std::min(low, z[i]), high = std::max(high, z[i]);
  CHECK_THAT(low, WithinAbs(-0.04, 1e-12));
  CHECK_THAT(high, WithinAbs(0, 1e-12));
}

TEST_CASE("GradientDomain.OfGentleSlopesIsLinear") {
  // C(g) ~ g for small gradients: a gently tilted, wavy sheet is only scaled.
  TriangleMesh mesh = test::grid(20, 20);
  for (Eigen::Index i = 0; i < mesh.V.rows(); ++i)
    mesh.V(i, 2) = 1e-5 * std::sin(4 * mesh.V(i, 0)) * std::cos(3 * mesh.V(i, 1));
  const Scene s = scene(mesh, Projection::orthographic);
  Context context;
  const Eigen::VectorXd gradient =
      s.frame.depth(gradient_domain_compression(s.frame, mesh.F, s.visibility, 0.05, {}, context));
  const Eigen::VectorXd linear = s.frame.depth(linear_compression(s.frame, slab(s, 0.05, s.visibility.vertex)));
  CHECK((gradient - linear).cwiseAbs().maxCoeff() < 2e-4 * 0.05);
}

}  // namespace
}  // namespace formwright
