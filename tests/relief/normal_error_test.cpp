// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/normal_error.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <cmath>
#include <numbers>

#include "geometry/test_meshes.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

struct Sheet {
  ViewFrame frame;
  Triangles F;
  Visibility visibility;
};

/// A unit square seen straight on, everything visible.
Sheet sheet() {
  const TriangleMesh mesh = test::grid(8, 8);
  ReliefOptions options;
  options.projection = Projection::orthographic;
  Sheet s{make_view_frame(mesh, options), mesh.F, {}};
  s.visibility.vertex.assign(static_cast<std::size_t>(mesh.V.rows()), 1);
  s.visibility.face.assign(static_cast<std::size_t>(mesh.F.rows()), 1);
  return s;
}

TEST_CASE("NormalError.OfATiltIsItsAngle") {
  const Sheet s = sheet();
  for (const double angle : {1e-7, 0.5, 30.0, 80.0}) {
    Positions moved = s.frame.P;
    moved.col(2) = moved.col(0) * std::tan(angle * std::numbers::pi / 180);
    const NormalError error = normal_error(s.frame, s.F, s.visibility, moved);
    CHECK_THAT(error.mean_deg, WithinAbs(angle, 1e-9 * angle + 1e-13));
    CHECK_THAT(error.mean_deg_image, WithinAbs(angle, 1e-9 * angle + 1e-13));
    CHECK_THAT(error.vertex_deg.maxCoeff(), WithinAbs(angle, 1e-9 * angle + 1e-13));
  }
}

TEST_CASE("NormalError.CountsVisibleFacesOnlyAndWeighsThemByArea") {
  Sheet s = sheet();
  Positions moved = s.frame.P;
  // Fold: the right half tilts by 45 degrees, the left stays.
  for (Eigen::Index i = 0; i < moved.rows(); ++i) moved(i, 2) = std::max(0.0, moved(i, 0));
  CHECK_THAT(normal_error(s.frame, s.F, s.visibility, moved).mean_deg, WithinAbs(22.5, 1e-9));
  for (Eigen::Index f = 0; f < s.F.rows(); ++f)
    if (s.frame.P(s.F(f, 0), 0) + s.frame.P(s.F(f, 1), 0) + s.frame.P(s.F(f, 2), 0) > 0)
      s.visibility.face[static_cast<std::size_t>(f)] = 0;
  CHECK(normal_error(s.frame, s.F, s.visibility, moved).mean_deg == 0);
}

TEST_CASE("NormalError.OfAFaceWithoutAreaIsFinite") {
  const Sheet s = sheet();
  const Positions moved = Positions::Zero(s.frame.P.rows(), 3);
  const NormalError error = normal_error(s.frame, s.F, s.visibility, moved);
  CHECK(error.vertex_deg.allFinite());
  CHECK(std::isfinite(error.mean_deg));
}

}  // namespace
}  // namespace formwright
