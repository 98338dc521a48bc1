// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/view/view_frame.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "geometry/test_meshes.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

ReliefOptions view(Projection projection, double field_of_view_deg = 30) {
  ReliefOptions options;
  options.projection = projection;
  options.field_of_view_deg = field_of_view_deg;
  options.direction = {0.3, -0.2, -1};
  return options;
}

/// Where the viewer sees a point on the plate, in normalised lengths.
Vec2 seen(const ViewFrame& frame, const Vec3& p) { return p.head<2>() / (1 + frame.kappa * p.z()); }

TEST_CASE("ViewFrame.TheModelSeenOnThePlateIsOneWideAndCentred") {
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    const ViewFrame frame = make_view_frame(test::icosphere(3), view(projection));
    double x0 = 1e9, x1 = -1e9, y0 = 1e9, y1 = -1e9;
    for (Eigen::Index i = 0; i < frame.P.rows(); ++i) {
      const Vec2 q = seen(frame, frame.P.row(i).transpose());
      x0 = std::min(x0, q.x()), x1 = std::max(x1, q.x()), y0 = std::min(y0, q.y()), y1 = std::max(y1, q.y());
    }
    CHECK_THAT(x0, WithinAbs(-0.5, 1e-12));
    CHECK_THAT(x1, WithinAbs(0.5, 1e-12));
    CHECK_THAT(y0 + y1, WithinAbs(0, 1e-12));
    CHECK_THAT(y1 - y0, WithinAbs(frame.image_height, 1e-12));
  }
}

TEST_CASE("ViewFrame.TheFieldOfViewAndTheDistanceSayTheSame") {
  const TriangleMesh mesh = test::icosphere(2);
  ReliefOptions by_angle = view(Projection::perspective, 40), by_distance = by_angle;
  by_distance.width_mm = 80;
  by_distance.distance_mm = 80 * 0.5 / std::tan(20 * std::numbers::pi / 180);
  const ViewFrame a = make_view_frame(mesh, by_angle), b = make_view_frame(mesh, by_distance);
  CHECK_THAT(a.kappa, WithinAbs(2 * std::tan(20 * std::numbers::pi / 180), 1e-12));
  CHECK_THAT(a.kappa, WithinAbs(b.kappa, 1e-12));
  CHECK_THAT(a.scale, WithinAbs(b.scale, 1e-12));
}

TEST_CASE("ViewFrame.MovingAlongTheRayKeepsThePicture") {
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    const ViewFrame frame = make_view_frame(test::icosphere(3), view(projection));
    test::Random random(7);
    Eigen::VectorXd u(frame.P.rows());
    for (Eigen::Index i = 0; i < u.size(); ++i) u[i] = random.uniform(-0.3, 0.3);
    const Positions moved = frame.moved(u);
    const Eigen::VectorXd z = frame.depth(u);
    for (int i = 0; i < u.size(); ++i) {
      CHECK((seen(frame, frame.P.row(i).transpose()) - seen(frame, moved.row(i).transpose())).norm() < 1e-14);
      CHECK_THAT(moved(i, 2), WithinAbs(z[i], 1e-15));
      CHECK_THAT(frame.u_for_depth(i, z[i]), WithinAbs(u[i], 1e-14));
    }
  }
}

TEST_CASE("ViewFrame.LambdaIsTheThesisLambda") {
  // lambda / lambda0 = 1 + kappa u, with lambda the distance from the viewpoint (eq. 3.3).
  const ViewFrame frame = make_view_frame(test::icosphere(2), view(Projection::perspective));
  const Eigen::VectorXd u = Eigen::VectorXd::LinSpaced(frame.P.rows(), -0.2, 0.2);
  const Positions moved = frame.moved(u);
  const Vec3 o(0, 0, -1 / frame.kappa);
  for (Eigen::Index i = 0; i < u.size(); ++i) {
    const Vec3 before = frame.P.row(i).transpose() - o, after = moved.row(i).transpose() - o;
    CHECK_THAT(after.norm() / before.norm(), WithinAbs(1 + frame.kappa * u[i], 1e-14));
    CHECK(after.cross(before).norm() < 1e-13);
  }
}

TEST_CASE("ViewFrame.BackInTheModelsAxesNothingHasMoved") {
  const TriangleMesh mesh = test::icosphere(2);
  const ViewFrame frame = make_view_frame(mesh, view(Projection::perspective));
  const Positions back = frame.to_model(frame.P, 120);
  CHECK((back - mesh.V * (frame.scale * 120)).cwiseAbs().maxCoeff() < 1e-11);
}

TEST_CASE("ViewFrame.OrthographicIsTheLimitOfFar") {
  // The picture converges like kappa, i.e. like the angle.
  const TriangleMesh mesh = test::icosphere(3);
  const ViewFrame straight = make_view_frame(mesh, view(Projection::orthographic));
  double previous = 0;
  for (const double angle : {4.0, 2.0, 1.0, 0.5}) {
    const ViewFrame near = make_view_frame(mesh, view(Projection::perspective, angle));
    const double difference = (near.P - straight.P).cwiseAbs().maxCoeff();
    if (previous > 0) {
      CHECK_THAT(std::log2(previous / difference),
                 WithinAbs(1, 0.05));  // the centring of the picture is first order in kappa
    }
    previous = difference;
  }
}

void expect_refused(const TriangleMesh& mesh, const ReliefOptions& options, const std::string& where) {
  try {
    make_view_frame(mesh, options);
    FAIL("accepted");
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::invalid_input);
    INFO(error.what());
    CHECK(error.where() == where);
  }
}

TEST_CASE("ViewFrame.RefusesImpossibleViewpointsInWords") {
  const TriangleMesh mesh = test::icosphere(2);
  ReliefOptions options = view(Projection::perspective);
  options.direction = {0, 0, 0};
  expect_refused(mesh, options, "direction");
  options.direction = {0, 2, 0};
  expect_refused(mesh, options, "up");
  options = view(Projection::perspective);
  options.distance_mm = 1;  // inside the sphere that is 120 mm wide
  expect_refused(mesh, options, "distance_mm");
  options = view(Projection::orthographic);
  TriangleMesh needle{Positions(3, 3), Triangles(1, 3)};
  needle.V << 0, 0, 0, 0, 0, 1, 0, 0, 2;
  needle.F << 0, 1, 2;
  options.direction = {0, 0, -1};
  expect_refused(needle, options, "direction");
}

TEST_CASE("ViewFrame.TheFixInTheMessageWorks") {
  const TriangleMesh mesh = test::icosphere(2);
  ReliefOptions options = view(Projection::perspective);
  options.distance_mm = 1;
  try {
    make_view_frame(mesh, options);
    FAIL("accepted");
  } catch (const Error& error) {
    const std::string text = error.what();
    const auto at = text.find("at least ");
    {
      INFO(text);
      REQUIRE(at != std::string::npos);
    }
    options.distance_mm = std::strtod(text.c_str() + at + 9, nullptr);
    CHECK_NOTHROW(make_view_frame(mesh, options));
  }
}

}  // namespace
}  // namespace formwright
