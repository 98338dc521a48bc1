// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/balanced_relief.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <Eigen/Eigenvalues>
#include <atomic>
#include <cmath>
#include <numbers>

#include "base/parallel.h"
#include "geometry/test_meshes.h"
#include "relief/appearance_energy.h"
#include "relief/base/base_shape.h"
#include "relief/bounds/order_repair.h"
#include "relief/bounds/separators.h"
#include "relief/baselines.h"
#include "relief/relief.h"
#include "relief/seen/seen_difference.h"

namespace formwright::balanced_tests {
namespace {
using Catch::Matchers::WithinAbs;

TriangleMesh wavy_ball(int levels) {
  TriangleMesh mesh = test::icosphere(levels);
  for (Eigen::Index i = 0; i < mesh.V.rows(); ++i) {
    const Vec3 p = mesh.V.row(i).transpose();
    mesh.V.row(i) *= 1 + 0.08 * std::sin(5 * p.x() + 1) * std::cos(4 * p.y()) + 0.05 * std::sin(7 * p.z());
  }
  return mesh;
}

ReliefOptions options_of(double thickness_mm, Projection projection, Appearance appearance = Appearance::balanced) {
  ReliefOptions options;
  options.projection = projection;
  options.thickness_mm = thickness_mm;
  options.width_mm = 100;
  options.appearance = appearance;
  return options;
}

struct Scene {
  TriangleMesh mesh;
  ViewFrame frame;
  Visibility visibility;
  std::vector<InequalityRow> rows;
};

Scene scene_of(const TriangleMesh& mesh, Projection projection) {
  Scene s{mesh, make_view_frame(mesh, options_of(5, projection)), {}, {}};
  Context context;
  const RayCaster caster(TriangleMesh{s.frame.P, mesh.F});
  s.visibility = find_visibility(s.frame, mesh.F, caster, context);
  s.rows = depth_order_rows(s.frame, mesh.F, caster, context);
  return s;
}

/// Between two planes, for all vertices.
DepthBounds slab(Eigen::Index n, double thickness) {
  DepthBounds bounds;
  bounds.nearest = Eigen::VectorXd::Constant(n, -thickness);
  bounds.farthest = Eigen::VectorXd::Zero(n);
  bounds.bounded.assign(static_cast<std::size_t>(n), 1);
  return bounds;
}

Eigen::VectorXd random_vector(Eigen::Index n, std::uint64_t seed, double size) {
  test::Random random(seed);
  Eigen::VectorXd v(n);
  for (Eigen::Index i = 0; i < n; ++i) v[i] = random.uniform(-size, size);
  return v;
}

Eigen::MatrixXd dense_hessian(const NormalTerm& term, Eigen::Index n, const std::vector<NormalTerm::FaceModel>& faces) {
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(n, n);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const auto& c = term.corners()[f];
    const auto& h = faces[f].hessian;
    for (std::size_t k = 0; k < 3; ++k) H(c[k], c[k]) += h[k];
    const std::size_t pairs[3][2] = {{1, 0}, {2, 0}, {2, 1}};
    for (std::size_t k = 0; k < 3; ++k) {
      H(c[pairs[k][0]], c[pairs[k][1]]) += h[3 + k];
      H(c[pairs[k][1]], c[pairs[k][0]]) += h[3 + k];
    }
  }
  return H;
}

/// A sheet that rises to the right by `slope`, everything visible.
Scene slope_scene(double slope) {
  TriangleMesh mesh = test::grid(12, 12);
  for (Eigen::Index i = 0; i < mesh.V.rows(); ++i) mesh.V(i, 2) = slope * mesh.V(i, 0);
  return scene_of(mesh, Projection::orthographic);
}

TEST_CASE("NormalTerm.OfATiltIsOneMinusItsCosine") {
  const Scene s = slope_scene(0);
  const NormalTerm term(s.frame, s.mesh.F, s.visibility);
  for (const double angle : {1e-4, 0.3, 1.2}) {
    const Eigen::VectorXd u = s.frame.P.col(0) * std::tan(angle);
    const double expected = 2 * std::pow(std::sin(0.5 * angle), 2);
    CHECK_THAT(term(u), WithinAbs(expected, 1e-10 * expected));
  }
}

TEST_CASE("NormalTerm.IsZeroForTheModelAndEveryUniformScaling") {
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    const Scene s = scene_of(wavy_ball(3), projection);
    const NormalTerm term(s.frame, s.mesh.F, s.visibility);
    CHECK(term(Eigen::VectorXd::Zero(s.mesh.V.rows())) <= 1e-30);
    CHECK(term(Eigen::VectorXd::Constant(s.mesh.V.rows(), 0.4)) <= 1e-25);
    CHECK(term(random_vector(s.mesh.V.rows(), 3, 0.1)) > 0.05);
  }
}

TEST_CASE("NormalTerm.GradientIsTheFirstDifference") {
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    const Scene s = scene_of(wavy_ball(2), projection);
    const NormalTerm term(s.frame, s.mesh.F, s.visibility);
    const Eigen::VectorXd u = random_vector(s.mesh.V.rows(), 5, 0.05);
    Eigen::VectorXd gradient;
    std::vector<NormalTerm::FaceModel> faces;
    CHECK_THAT(term.linearise(u, gradient, faces), WithinAbs(term(u), 1e-14));
    double error = 0;
    for (Eigen::Index i = 0; i < u.size(); ++i) {
      Eigen::VectorXd up = u, down = u;
      up[i] += 1e-6;
      down[i] -= 1e-6;
      error = std::max(error, std::abs((term(up) - term(down)) / 2e-6 - gradient[i]));
    }
    CHECK(error <= 1e-7 * gradient.cwiseAbs().maxCoeff());
    INFO("a uniform scaling, along 1 + kappa u, changes nothing");
    CHECK(std::abs(gradient.sum() + s.frame.kappa * gradient.dot(u)) <= 1e-12 * gradient.cwiseAbs().sum());
  }
}

TEST_CASE("NormalTerm.HessianIsTheSecondDifferenceAtTheModelAndNowhereIndefinite") {
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    const Scene s = scene_of(wavy_ball(2), projection);
    const Eigen::Index n = s.mesh.V.rows();
    const NormalTerm term(s.frame, s.mesh.F, s.visibility);
    Eigen::VectorXd gradient, up, down;
    std::vector<NormalTerm::FaceModel> faces, unused;
    term.linearise(Eigen::VectorXd::Zero(n), gradient, faces);
    const Eigen::MatrixXd H = dense_hessian(term, n, faces);
    for (int i = 0; i < 20; ++i) {
      Eigen::VectorXd step = Eigen::VectorXd::Zero(n);
      step[i] = 1e-5;
      term.linearise(step, up, unused);
      term.linearise(-step, down, unused);
      CHECK(((up - down) / 2e-5 - H.col(i)).cwiseAbs().maxCoeff() <= 1e-5 * H.cwiseAbs().maxCoeff());
    }
    const Eigen::VectorXd at = random_vector(n, 9, 0.1);
    term.linearise(at, gradient, faces);
    const Eigen::MatrixXd elsewhere = dense_hessian(term, n, faces);
    CHECK(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(elsewhere).eigenvalues()[0] >= -1e-12 * elsewhere.norm());
    const Eigen::VectorXd scaling = Eigen::VectorXd::Ones(n) + s.frame.kappa * at;
    CHECK((elsewhere * scaling).cwiseAbs().maxCoeff() <= 1e-12 * elsewhere.cwiseAbs().maxCoeff());
  }
}

/// The optimum of normals alone in a slab, from linear compression.
BalancedResult normals_alone(const Scene& s, double thickness, double gap) {
  const Eigen::Index n = s.mesh.V.rows();
  Eigen::VectorXd lower(n), upper(n);
  for (int i = 0; i < n; ++i) {
    lower[i] = s.frame.u_for_depth(i, -thickness);
    upper[i] = s.frame.u_for_depth(i, 0);
  }
  const AppearanceEnergy energy(s.frame, s.mesh.F, Eigen::VectorXd::Ones(n));
  Context context;
  BalancedSolver solver(s.frame, s.mesh.F, s.visibility, energy.lower_hessian(context), context);
  // A start that is not the answer: bent, and within the slab.
  Eigen::VectorXd start(n);
  for (int i = 0; i < n; ++i)
    start[i] =
        s.frame.u_for_depth(i, -thickness * (0.5 + 0.5 * std::sin(2 * s.frame.P(i, 0)) * std::cos(s.frame.P(i, 1))));
  const DepthBounds bounds = slab(n, thickness);
  BalancedSettings settings;
  settings.last_beta = 0;
  settings.gap = gap;
  settings.decrease = 1e-3 * gap;
  settings.max_steps = 200;
  return balanced_relief(solver, {s.frame, s.visibility, bounds, true, thickness, lower, upper, s.rows}, start,
                         settings, context);
}

TEST_CASE("BalancedSolver.FlattensASlopeEvenly") {
  // 1 - cos(atan g - atan g0) is convex in the slope g up to g0, so that by Jensen's inequality no surface that crosses
  // the slab does better than the even slope.
  const double slope = 0.5, thickness = 0.2;
  const Scene s = slope_scene(slope);
  const double best = 1 - std::cos(std::atan(thickness) - std::atan(slope));
  double previous = 1;
  for (const double gap : {1e-1, 1e-2, 1e-3}) {
    const BalancedResult result = normals_alone(s, thickness, gap);
    CHECK(result.converged);
    CHECK(result.objective >= best * (1 - 1e-9));
    const double excess = result.objective / best - 1;
    INFO("gap " << gap << " excess " << excess);
    CHECK(excess <= gap);
    CHECK(excess <= previous);
    previous = excess;
  }
}

TEST_CASE("BalancedRelief.KeepsEveryBoundAndTheOrderAndFillsTheSlab") {
  const TriangleMesh mesh = wavy_ball(4);
  for (const Projection projection : {Projection::perspective, Projection::orthographic})
    for (const double thickness : {10.0, 2.0, 0.5})
      for (const BoundedVertices bounded : {BoundedVertices::all, BoundedVertices::visible}) {
        ReliefOptions options = options_of(thickness, projection);
        options.bounded_vertices = bounded;
        Context context;
        const Relief relief = ReliefSolver(mesh, options, context).solve(options, context);
        CHECK(relief.balanced_steps > 3);
        CHECK(relief.bound_violation_max_mm <= 1e-9 * thickness);
        for (Eigen::Index i = 0; i < relief.u.size(); ++i) {
          CHECK(relief.lambda_mm[i] >= relief.lambda_min_mm[i]);
          CHECK(relief.lambda_mm[i] <= relief.lambda_max_mm[i]);
        }
        CHECK(relief.order_violation_max_mm <= 1e-6 * thickness);
        if (bounded == BoundedVertices::all) {
          CHECK_THAT(relief.moved.col(2).minCoeff() * 100, WithinAbs(-thickness, 1e-9 * thickness));
          CHECK_THAT(relief.moved.col(2).maxCoeff() * 100, WithinAbs(0, 1e-9 * thickness));
        }
      }
}

TEST_CASE("BalancedRelief.LooksMoreLikeTheModel") {
  const TriangleMesh mesh = wavy_ball(5);
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    const ReliefOptions detail = options_of(5, projection, Appearance::detail), balanced = options_of(5, projection);
    Context context;
    ReliefSolver solver(mesh, detail, context);
    CHECK(ReliefSolver::key(detail) == ReliefSolver::key(balanced));
    const Relief before = solver.solve(detail, context), after = solver.solve(balanced, context);
    CHECK(after.normal_error.mean_deg_image < 0.95 * before.normal_error.mean_deg_image);
    INFO("the price: the energy that detail minimises");
    CHECK(after.energy > before.energy);
    const SeenComparison comparison(solver.frame(), solver.F(), 2, context);
    const SeenDifference seen_before = comparison.with(before.moved, context),
                         seen_after = comparison.with(after.moved, context);
    CHECK(1 - seen_after.similarity < 0.95 * (1 - seen_before.similarity));
    CHECK(seen_after.false_edges_percent < 0.1);
  }
}

TEST_CASE("BalancedRelief.IsNeverWorseThanItsStart") {
  for (const double thickness : {0.2, 0.05, 0.01}) {
    const BalancedResult result = normals_alone(scene_of(wavy_ball(3), Projection::perspective), thickness, 1e-3);
    CHECK(result.objective <= result.start_objective);
  }
}

TEST_CASE("BalancedRelief.WithoutAnActiveBoundIsTheModel") {
  Context context;
  const ReliefOptions options = options_of(130, Projection::orthographic);
  const Relief relief = ReliefSolver(wavy_ball(3), options, context).solve(options, context);
  CHECK(relief.normal_error.mean_deg <= 1e-6);
}

TEST_CASE("BalancedRelief.KeepsToACurvedBaseAndRefusesSteps") {
  ReliefOptions options = options_of(3, Projection::orthographic);
  options.base = BaseShape::wave;
  Context context;
  const TriangleMesh mesh = wavy_ball(4);
  ReliefSolver solver(mesh, options, context);
  const BaseSurface wave(base_shape(options, solver.frame()));
  const Relief relief = solver.solve(options, wave, context);
  CHECK(relief.balanced_steps > 3);
  CHECK(relief.bound_violation_max_mm <= 3e-9);
  CHECK(relief.order_violation_max_mm <= 3e-6);
  options.appearance = Appearance::detail;
  CHECK(relief.normal_error.mean_deg_image < solver.solve(options, wave, context).normal_error.mean_deg_image);
  options.appearance = Appearance::balanced;
  options.base = BaseShape::stairs;
  const BaseSurface stairs(base_shape(options, solver.frame()), base_bands(options, solver.frame()));
  try {
    solver.solve(options, stairs, context);
    FAIL("accepted");
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::invalid_input);
    CHECK(error.where() == "appearance");
  }
}

TEST_CASE("BalancedRelief.HasTheSameBitsWithOneThread") {
  const TriangleMesh mesh = wavy_ball(5);
  const ReliefOptions options = options_of(3, Projection::perspective);
  Context context;
  const Eigen::VectorXd several = ReliefSolver(mesh, options, context).solve(options, context).u;
  const ThreadLimit one(1);
  const Eigen::VectorXd single = ReliefSolver(mesh, options, context).solve(options, context).u;
  CHECK(several == single);
}

TEST_CASE("BalancedRelief.SizeAndPlaceOfTheModelDoNotMatter") {
  const TriangleMesh mesh = wavy_ball(3);
  const ReliefOptions options = options_of(4, Projection::perspective);
  Context context;
  const Relief reference = ReliefSolver(mesh, options, context).solve(options, context);
  const TriangleMesh large{(mesh.V * 1000).rowwise() + Eigen::RowVector3d(3e3, -2e3, 1e4), mesh.F};
  const Relief other = ReliefSolver(large, options, context).solve(options, context);
  CHECK((reference.u - other.u).cwiseAbs().maxCoeff() <= 1e-5 * 0.04);
}

TEST_CASE("BalancedRelief.StopsWhereverItIsCancelled") {
  const TriangleMesh mesh = wavy_ball(3);
  const ReliefOptions options = options_of(2, Projection::perspective);
  const auto questions_until = [&](long stop_at) {
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
  for (const double share : {0.5, 0.7, 0.9}) {
    const long stop_at = 1 + long(share * double(all)), asked = questions_until(stop_at);
    CHECK(asked >= stop_at);
    CHECK(asked <= stop_at + 64);
  }
}

TEST_CASE("OrderRepair.PushesWhatIsHiddenBack") {
  const Scene s = scene_of(wavy_ball(3), Projection::orthographic);
  const Eigen::Index n = s.mesh.V.rows();
  const double thickness = 0.1;
  Eigen::VectorXd lower(n), upper(n);
  for (int i = 0; i < n; ++i) {
    lower[i] = s.frame.u_for_depth(i, -thickness);
    upper[i] = s.frame.u_for_depth(i, 0);
  }
  const Eigen::VectorXd feasible = linear_compression(s.frame, slab(n, thickness));
  Eigen::VectorXd u = (feasible + random_vector(n, 7, 0.01)).cwiseMax(lower).cwiseMin(upper);
  const Eigen::VectorXd before = u;
  repair_order(s.rows, s.visibility.vertex, lower, upper, feasible, 1e-9, u);
  double lacking = 0, moved_visible = 0;
  for (const InequalityRow& row : s.rows) {
    double value = -row.bound;
    for (std::size_t k = 0; k < row.index.size(); ++k) value += row.coefficient[k] * u[row.index[k]];
    lacking = std::max(lacking, -value);
  }
  std::vector<char> concerned(static_cast<std::size_t>(n), 0);  // by a row with something visible behind
  for (const InequalityRow& row : s.rows)
    if (visible_behind(row, s.visibility.vertex))
      for (const int i : row.index) concerned[static_cast<std::size_t>(i)] = 1;
  for (Eigen::Index i = 0; i < n; ++i) {
    CHECK(u[i] >= lower[i]);
    CHECK(u[i] <= upper[i]);
    if (s.visibility.vertex[static_cast<std::size_t>(i)] && !concerned[static_cast<std::size_t>(i)])
      moved_visible = std::max(moved_visible, std::abs(u[i] - before[i]));
  }
  CHECK(lacking <= 2e-9);
  INFO("nothing that is seen moves where all behind is hidden");
  CHECK(moved_visible == 0);
}

TEST_CASE("Separators.ImplyTheirRows") {
  const Scene s = scene_of(wavy_ball(3), Projection::perspective);
  const Eigen::Index n = s.mesh.V.rows();
  const std::vector<Separator> kind(s.rows.size(), Separator::between);
  const Eigen::VectorXd feasible = linear_compression(s.frame, slab(n, 0.1));
  Eigen::VectorXd lower = Eigen::VectorXd::Constant(n, -1), upper = Eigen::VectorXd::Constant(n, 1);
  add_separators(s.rows, kind, feasible, 0, lower, upper);
  CHECK(((feasible - lower).array() >= 0).all());
  CHECK(((upper - feasible).array() >= 0).all());
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Eigen::VectorXd share = random_vector(n, seed, 0.5).array() + 0.5;
    const Eigen::VectorXd u = lower.array() + share.array() * (upper - lower).array();
    for (const InequalityRow& row : s.rows) {
      double value = -row.bound;
      for (std::size_t k = 0; k < row.index.size(); ++k) value += row.coefficient[k] * u[row.index[k]];
      CHECK(value >= -1e-12);
    }
  }
}

}  // namespace
}  // namespace formwright::balanced_tests
