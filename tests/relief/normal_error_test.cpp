// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/normal_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "geometry/test_meshes.h"

namespace formwright {
namespace {

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

TEST(NormalError, OfATiltIsItsAngle) {
  const Sheet s = sheet();
  for (const double angle : {1e-7, 0.5, 30.0, 80.0}) {
    Positions moved = s.frame.P;
    moved.col(2) = moved.col(0) * std::tan(angle * std::numbers::pi / 180);
    const NormalError error = normal_error(s.frame, s.F, s.visibility, moved);
    EXPECT_NEAR(error.mean_deg, angle, 1e-9 * angle + 1e-13);
    EXPECT_NEAR(error.mean_deg_image, angle, 1e-9 * angle + 1e-13);
    EXPECT_NEAR(error.vertex_deg.maxCoeff(), angle, 1e-9 * angle + 1e-13);
  }
}

TEST(NormalError, CountsVisibleFacesOnlyAndWeighsThemByArea) {
  Sheet s = sheet();
  Positions moved = s.frame.P;
  // Fold: the right half tilts by 45 degrees, the left stays.
  for (Eigen::Index i = 0; i < moved.rows(); ++i) moved(i, 2) = std::max(0.0, moved(i, 0));
  EXPECT_NEAR(normal_error(s.frame, s.F, s.visibility, moved).mean_deg, 22.5, 1e-9);
  for (Eigen::Index f = 0; f < s.F.rows(); ++f)
    if (s.frame.P(s.F(f, 0), 0) + s.frame.P(s.F(f, 1), 0) + s.frame.P(s.F(f, 2), 0) > 0)
      s.visibility.face[static_cast<std::size_t>(f)] = 0;
  EXPECT_EQ(normal_error(s.frame, s.F, s.visibility, moved).mean_deg, 0);
}

TEST(NormalError, OfAFaceWithoutAreaIsFinite) {
  const Sheet s = sheet();
  const Positions moved = Positions::Zero(s.frame.P.rows(), 3);
  const NormalError error = normal_error(s.frame, s.F, s.visibility, moved);
  EXPECT_TRUE(error.vertex_deg.allFinite());
  EXPECT_TRUE(std::isfinite(error.mean_deg));
}

}  // namespace
}  // namespace formwright
