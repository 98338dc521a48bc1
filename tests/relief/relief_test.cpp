// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/relief.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <Eigen/Geometry>
#include <atomic>
#include <cmath>
#include <ctime>
#include <limits>

#include "geometry/test_meshes.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

/// A ball with waves on it: curved everywhere, with a silhouette and a hidden side.
TriangleMesh wavy_ball(int levels) {
  TriangleMesh mesh = test::icosphere(levels);
  for (Eigen::Index i = 0; i < mesh.V.rows(); ++i) {
    const Vec3 p = mesh.V.row(i).transpose();
    mesh.V.row(i) *= 1 + 0.08 * std::sin(5 * p.x() + 1) * std::cos(4 * p.y()) + 0.05 * std::sin(7 * p.z());
  }
  return mesh;
}

ReliefOptions slab(double thickness_mm, Projection projection = Projection::perspective) {
  ReliefOptions options;
  options.projection = projection;
  options.thickness_mm = thickness_mm;
  options.width_mm = 100;
  return options;
}

Relief solve(const TriangleMesh& mesh, const ReliefOptions& options) {
  Context context;
  return ReliefSolver(mesh, options, context).solve(options, context);
}

TEST_CASE("Relief.WithoutAnActiveBoundIsTheModel") {
  const TriangleMesh mesh = wavy_ball(3);
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    const ReliefOptions options = slab(130, projection);  // the ball is about 100 mm deep
    const Relief relief = solve(mesh, options);
    // One common scale: s = lambda / lambda0 is constant (perspective), the depth shift is (straight on).
    const double spread = relief.u.maxCoeff() - relief.u.minCoeff();
    CHECK(spread <= 1e-10);
    CHECK(relief.energy <= 1e-18);
    CHECK(relief.normal_error.mean_deg <= 1e-6);
    CHECK(relief.qp.active_constraints == 0);
    INFO("it should rest on its plate");
    CHECK_THAT(relief.moved.col(2).maxCoeff(), WithinAbs(0, 1e-9));
  }
}

TEST_CASE("Relief.KeepsEveryBoundAndTheOrder") {
  const TriangleMesh mesh = wavy_ball(4);
  for (const Projection projection : {Projection::perspective, Projection::orthographic})
    for (const double thickness : {10.0, 2.0, 0.5})
      for (const BoundedVertices bounded : {BoundedVertices::all, BoundedVertices::visible}) {
        ReliefOptions options = slab(thickness, projection);
        options.bounded_vertices = bounded;
        const Relief relief = solve(mesh, options);
        CHECK(relief.bound_violation_max_mm <= 1e-9 * thickness);
        CHECK(relief.order_violation_max_mm <= 1e-6 * thickness);
        CHECK(relief.qp.kkt_residual <= 1e-6);
        CHECK(relief.energy < relief.energy_linear);
        CHECK(relief.qp.active_constraints > 2);
        CHECK(relief.order_rows > 100);
        // The whole slab is used.
        if (bounded == BoundedVertices::all) {
          CHECK_THAT(relief.moved.col(2).minCoeff() * 100, WithinAbs(-thickness, 1e-9 * thickness));
          CHECK_THAT(relief.moved.col(2).maxCoeff() * 100, WithinAbs(0, 1e-9 * thickness));
        }
      }
}

TEST_CASE("Relief.ThinnerIsNeverBetter") {
  const TriangleMesh mesh = wavy_ball(3);
  ReliefOptions options = slab(20, Projection::orthographic);
  Context context;
  ReliefSolver solver(mesh, options, context);
  double previous = -1;
  for (const double thickness : {40.0, 20.0, 10.0, 5.0, 2.5, 1.0}) {
    options.thickness_mm = thickness;
    const double energy = solver.solve(options, context).energy;
    CHECK(energy >= previous);
    previous = energy;
  }
}

TEST_CASE("Relief.ReusedFactorisationGivesTheSameAnswer") {
  const TriangleMesh mesh = wavy_ball(3);
  ReliefOptions first = slab(8), second = slab(3);
  Context context;
  ReliefSolver solver(mesh, first, context);
  solver.solve(first, context);
  const Relief warm = solver.solve(second, context), cold = solve(mesh, second);
  CHECK((warm.u - cold.u).cwiseAbs().maxCoeff() <= 1e-8 * 0.03);
  CHECK(ReliefSolver::key(first) == ReliefSolver::key(second));
}

TEST_CASE("Relief.SizeAndPlaceOfTheModelDoNotMatter") {
  const TriangleMesh mesh = wavy_ball(3);
  const ReliefOptions options = slab(4);
  const Relief reference = solve(mesh, options);
  TriangleMesh large{(mesh.V * 1000).rowwise() + Eigen::RowVector3d(3e3, -2e3, 1e4), mesh.F};
  const Relief other = solve(large, options);
  CHECK((reference.u - other.u).cwiseAbs().maxCoeff() <= 1e-6 * 0.04);
  CHECK_THAT(other.energy, WithinAbs(reference.energy, 1e-6 * reference.energy));
  // Width and thickness together only scale.
  ReliefOptions twice = options;
  twice.width_mm *= 2;
  twice.thickness_mm *= 2;
  const Relief scaled = solve(mesh, twice);
  CHECK((scaled.u - reference.u).cwiseAbs().maxCoeff() <= 1e-12);
  CHECK((scaled.lambda_mm - 2 * reference.lambda_mm).cwiseAbs().maxCoeff() <= 1e-9);
}

TEST_CASE("Relief.TurningTheModelAndTheViewTogetherChangesNothing") {
  const TriangleMesh mesh = wavy_ball(3);
  const ReliefOptions options = slab(4);
  const Relief reference = solve(mesh, options);
  const Eigen::Matrix3d R = Eigen::AngleAxisd(0.8, Vec3(1, 1, 2).normalized()).toRotationMatrix();
  const TriangleMesh turned{mesh.V * R.transpose(), mesh.F};
  ReliefOptions turned_options = options;
  const Vec3 d = R * Vec3(0, 0, -1), up = R * Vec3(0, 1, 0);
  turned_options.direction = {d.x(), d.y(), d.z()};
  turned_options.up = {up.x(), up.y(), up.z()};
  const Relief other = solve(turned, turned_options);
  CHECK((reference.u - other.u).cwiseAbs().maxCoeff() <= 1e-6 * 0.04);
}

TEST_CASE("Relief.BothSolversAgree") {
  const TriangleMesh mesh = wavy_ball(3);
  for (const Projection projection : {Projection::perspective, Projection::orthographic})
    for (const double thickness : {5.0, 2.0}) {
      ReliefOptions options = slab(thickness, projection);
      options.method = QpMethod::exchange;
      const Relief exchange = solve(mesh, options);
      options.method = QpMethod::interior_point;
      const Relief interior = solve(mesh, options);
      CHECK_THAT(exchange.energy, WithinAbs(interior.energy, 1e-6 * exchange.energy));
      CHECK((exchange.u - interior.u).cwiseAbs().maxCoeff() <= 1e-4 * thickness / 100);
    }
}

TEST_CASE("Relief.EveryPartRestsOnItsOwn") {
  // Two balls side by side and one behind: three components with free constants.
  const TriangleMesh ball = wavy_ball(3);
  const TriangleMesh mesh =
      test::joined(test::joined(ball, test::moved(ball, Vec3(2.6, 0, 0))), test::moved(ball, Vec3(1.3, 1, -3)));
  const ReliefOptions options = slab(5);
  const Relief relief = solve(mesh, options);
  CHECK(relief.bound_violation_max_mm <= 5e-9);
  CHECK(relief.order_violation_max_mm <= 1e-5);
  CHECK(relief.energy < relief.energy_linear);
}

TEST_CASE("Relief.ConvergesWithSecondOrderUnderRefinement") {
  // The energy is fourth order and the contact a free boundary; on a ball, whose mesh converges with second order,
  // so does the energy at the solution.
  for (const double thickness : {10.0, 40.0}) {
    std::vector<double> energy;
    for (const int levels : {2, 3, 4, 5}) {
      ReliefOptions options = slab(thickness, Projection::orthographic);
      options.direction = {0.1, 0.2, -1};
      options.depth_order = false;
      energy.push_back(solve(test::icosphere(levels), options).energy);
    }
    const double order = std::log2((energy[2] - energy[1]) / (energy[3] - energy[2]));
    INFO("thickness " << thickness);
    CHECK(order > 1.5);
    CHECK(order < 3.0);
  }
}

TEST_CASE("Relief.RefusesWhatCannotBe") {
  const TriangleMesh mesh = wavy_ball(2);
  ReliefOptions options = slab(90);
  options.field_of_view_deg = 90;
  options.thickness_mm = 60;  // the viewpoint is 50 mm away
  try {
    solve(mesh, options);
    FAIL("accepted");
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::invalid_input);
  }
}

TEST_CASE("Relief.RefusesMoreVerticesThanFitBeforeAnyWork") {
  TriangleMesh mesh = wavy_ball(1);
  mesh.V.conservativeResize(1'600'000, 3);
  Context context;
  try {
    ReliefSolver(mesh, slab(5), context);
    FAIL("accepted");
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::invalid_input);
    INFO(error.what());
    CHECK(std::string(error.what()).find("simplify it first") != std::string::npos);
  }
}

TEST_CASE("Relief.AsksForCancelAllAlong") {
  // The longest stretch between two questions in processor time and as a share of the run, so that neither a busy
  // machine nor sanitizers make it fail. Natively 0.10 s, 3 % of the run.
  const TriangleMesh mesh = wavy_ball(6);
  const ReliefOptions options = slab(1);
  std::atomic<std::clock_t> last{std::clock()}, longest{0};
  const auto ask = [&] {
    const std::clock_t at = std::clock(), stretch = at - last.exchange(at);
    for (std::clock_t before = longest; stretch > before && !longest.compare_exchange_weak(before, stretch);) {}
    return false;
  };
  Context context(Host{{}, ask, {}});
  const std::clock_t start = std::clock();
  ReliefSolver(mesh, options, context).solve(options, context);
  ask();
  const double share = double(longest) / double(std::clock() - start);
  CHECK(share < 0.25);
}

TEST_CASE("Relief.StopsWhereverItIsCancelled") {
  const TriangleMesh mesh = wavy_ball(4);
  const ReliefOptions options = slab(1);
  const auto questions_until =
      [&](long stop_at) {  // asked in all; no other is asked by the thread that was told to stop
        std::atomic<long> asked{0};
        Context context(Host{{}, [&] { return ++asked >= stop_at; }, {}});
        try {
          ReliefSolver(mesh, options, context).solve(options, context);
        } catch (const Error& error) {
          CHECK(error.code() == ErrorCode::cancelled);
          return asked.load();
        }
        return -asked.load();
      };
  const long all = -questions_until(std::numeric_limits<long>::max());
  REQUIRE(all > 20);
  for (const double share : {0.0, 0.2, 0.5, 0.8, 0.95}) {
    const long stop_at = 1 + long(share * double(all));
    const long asked = questions_until(stop_at);
    {
      INFO("not cancelled");
      CHECK(asked >= stop_at);
    }
    CHECK(asked <= stop_at + 64);
  }
}

}  // namespace
}  // namespace formwright
