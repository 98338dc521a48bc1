// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/view/visibility.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <cmath>

#include "geometry/test_meshes.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

ViewFrame visibility_frame(const TriangleMesh& mesh, Projection projection) {
  ReliefOptions options;
  options.projection = projection;
  options.field_of_view_deg = 30;
  return make_view_frame(mesh, options);
}

TEST_CASE("Visibility.OfASphereIsTheCapTheViewerSees") {
  const TriangleMesh mesh = test::icosphere(4);
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    const ViewFrame frame = visibility_frame(mesh, projection);
    Context context;
    const RayCaster caster(TriangleMesh{frame.P, mesh.F});
    const Visibility visibility = find_visibility(frame, mesh.F, caster, context);
    const Vec3 centre = frame.P.colwise().mean();
    const double radius = (frame.P.row(0).transpose() - centre).norm();
    for (Eigen::Index i = 0; i < frame.P.rows(); ++i) {
      // Seen exactly where the outward normal meets the ray head on; a band at the rim is left to the facets.
      const Vec3 p = frame.P.row(i).transpose();
      const double turned = -(p - centre).normalized().dot(frame.ray_direction(p));
      if (std::abs(turned) < 0.1) continue;
      INFO("vertex " << i << ", radius " << radius);
      CHECK((visibility.vertex[static_cast<std::size_t>(i)] != 0) == (turned > 0));
    }
    for (Eigen::Index f = 0; f < mesh.F.rows(); ++f)
      if (visibility.face[static_cast<std::size_t>(f)]) {
        CHECK(faces_viewer(frame, frame.P, mesh.F, f));
      }
  }
}

/// Two squares, the second one behind the middle of the first (further from the viewer at +z).
TriangleMesh two_sheets() {
  TriangleMesh front = test::grid(6, 6), back = test::moved(test::grid(6, 6), Vec3(0.013, 0.017, -0.3));
  return test::joined(front, back);
}

TEST_CASE("Visibility.WhatIsBehindIsHidden") {
  const TriangleMesh mesh = two_sheets();
  const ViewFrame frame = visibility_frame(mesh, Projection::orthographic);
  Context context;
  const RayCaster caster(TriangleMesh{frame.P, mesh.F});
  const Visibility visibility = find_visibility(frame, mesh.F, caster, context);
  const Eigen::Index half = mesh.V.rows() / 2;
  for (Eigen::Index i = 0; i < half; ++i) CHECK(visibility.vertex[static_cast<std::size_t>(i)]);
  for (Eigen::Index i = half; i < mesh.V.rows(); ++i) {
    const bool covered =
        mesh.V(i, 0) < mesh.V.col(0).head(half).maxCoeff() && mesh.V(i, 1) < mesh.V.col(1).head(half).maxCoeff();
    INFO(i);
    CHECK((visibility.vertex[static_cast<std::size_t>(i)] != 0) == !covered);
  }
}

TEST_CASE("DepthOrder.RowsHoldForTheModelAndBreakWhenSheetsPass") {
  const TriangleMesh mesh = two_sheets();
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    const ViewFrame frame = visibility_frame(mesh, projection);
    Context context;
    const RayCaster caster(TriangleMesh{frame.P, mesh.F});
    const auto rows = depth_order_rows(frame, mesh.F, caster, context);
    REQUIRE(rows.size() > 40u);
    const Eigen::Index half = mesh.V.rows() / 2;
    const auto slack = [&](const Eigen::VectorXd& u) {
      double minimum = 1e9;
      for (const InequalityRow& row : rows) {
        double value = -row.bound;
        for (std::size_t k = 0; k < row.index.size(); ++k) value += row.coefficient[k] * u[row.index[k]];
        minimum = std::min(minimum, value);
      }
      return minimum;
    };
    Eigen::VectorXd u = Eigen::VectorXd::Zero(mesh.V.rows());
    const double gap = frame.P(half, 2) - frame.P(0, 2);
    CHECK_THAT(slack(u), WithinAbs(gap, 1e-6));  // every row measures the distance along the ray's depth
    // Both sheets to one depth: all rows just hold.
    for (int i = 0; i < mesh.V.rows(); ++i) u[i] = frame.u_for_depth(i, 0.0);
    CHECK_THAT(slack(u), WithinAbs(0, 1e-12));
    // The back one in front: broken.
    for (int i = static_cast<int>(half); i < mesh.V.rows(); ++i) u[i] = frame.u_for_depth(i, -0.1);
    CHECK_THAT(slack(u), WithinAbs(-0.1, 1e-6));
  }
}

}  // namespace
}  // namespace formwright
