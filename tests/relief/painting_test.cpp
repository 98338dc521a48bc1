// SPDX-License-Identifier: GPL-3.0-or-later
// Painted weights, regions and limits of depth: exact cases, invariants, convergence.
#include "relief/painting/painting.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "geometry/test_meshes.h"
#include "relief/appearance_energy.h"
#include "relief/base/base_shape.h"
#include "relief/height_map.h"
#include "relief/relief.h"

namespace formwright::painting_tests {
namespace {
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;
using enum PaintedRegion;

TriangleMesh wavy_ball(int levels) {
  TriangleMesh mesh = test::icosphere(levels);
  for (Eigen::Index i = 0; i < mesh.V.rows(); ++i) {
    const Vec3 p = mesh.V.row(i).transpose();
    mesh.V.row(i) *= 1 + 0.08 * std::sin(5 * p.x() + 1) * std::cos(4 * p.y()) + 0.05 * std::sin(7 * p.z());
  }
  return mesh;
}

ReliefOptions options_of(double thickness_mm, Projection projection = Projection::perspective) {
  ReliefOptions options;
  options.projection = projection;
  options.thickness_mm = thickness_mm;
  options.width_mm = 100;
  return options;
}

struct Solved {
  Relief relief;
  ViewFrame frame;
  Triangles F;
  BaseSurface base;
};

Solved solved(const TriangleMesh& mesh, const ReliefOptions& options, const Painting& painting) {
  Context context;
  ReliefSolver solver(mesh, options, context, painting.weight);
  BaseSurface base;
  if (options.base != BaseShape::flat)
    base = BaseSurface(base_shape(options, solver.frame()), base_bands(options, solver.frame()));
  Relief relief = solver.solve(options, base, context, painting);
  return {std::move(relief), solver.frame(), solver.F(), base};
}

/// Where the model's vertex has x below -0.3: on the base; above 0.5: free; in between, above: 2 to 3 mm, 1 mm carved.
Painting patches(const TriangleMesh& mesh) {
  Painting painting;
  const Eigen::Index n = mesh.V.rows();
  painting.region.assign(static_cast<std::size_t>(n), usual);
  painting.thickness_mm = Eigen::VectorXd::Constant(n, NAN);
  painting.carve_depth_mm = Eigen::VectorXd::Constant(n, NAN);
  painting.weight = Eigen::VectorXd::Ones(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double x = mesh.V(i, 0), y = mesh.V(i, 1);
    PaintedRegion& region = painting.region[static_cast<std::size_t>(i)];
    if (x < -0.6) region = on_base;
    else if (x > 0.5) region = free;
    else if (y > 0.3) {
      region = own_thickness;
      painting.thickness_mm[i] = 2.5 + 0.5 * std::sin(3 * x);
      painting.carve_depth_mm[i] = 1;
    }
    painting.weight[i] = y < 0 ? 3 : 1;
  }
  return painting;
}

/// Two balls side by side, and which vertices are the right one's.
struct TwoBalls {
  TriangleMesh mesh;
  std::vector<char> right;
};
TwoBalls two_balls(int levels) {
  const TriangleMesh ball = wavy_ball(levels);
  const Eigen::Index n = ball.V.rows(), m = ball.F.rows();
  TwoBalls both;
  both.mesh.V.resize(2 * n, 3);
  both.mesh.V << ball.V.rowwise() - Eigen::RowVector3d(1.5, 0, 0), ball.V.rowwise() + Eigen::RowVector3d(1.5, 0, 0);
  both.mesh.F.resize(2 * m, 3);
  both.mesh.F << ball.F, ball.F.array() + static_cast<int>(n);
  both.right.assign(static_cast<std::size_t>(2 * n), 0);
  std::fill(both.right.begin() + n, both.right.end(), 1);
  return both;
}

/// Depth bounds that painting may set at a vertex, mm before and behind the base.
std::pair<double, double> room_mm(const Painting& painting, const ReliefOptions& options, Eigen::Index i) {
  switch (painting.region_of(i)) {
    case usual: break;
    case free: return {1e9, options.carve_depth_mm};
    case on_base: return {0, 0};
    case own_thickness:
      return {std::isnan(painting.thickness_mm[i]) ? options.thickness_mm : painting.thickness_mm[i],
              std::isnan(painting.carve_depth_mm[i]) ? options.carve_depth_mm : painting.carve_depth_mm[i]};
  }
  return {options.thickness_mm, options.carve_depth_mm};
}

}  // namespace

TEST_CASE("Painting.AConstantWeightIsNone") {
  const TriangleMesh mesh = wavy_ball(3);
  for (const Appearance appearance : {Appearance::detail, Appearance::balanced}) {
    ReliefOptions options = options_of(4);
    options.appearance = appearance;
    const Relief plain = solved(mesh, options, {}).relief;
    for (const double weight : {0.01, 7.0, 100.0}) {
      Painting painting;
      painting.weight = Eigen::VectorXd::Constant(mesh.V.rows(), weight);
      const Relief relief = solved(mesh, options, painting).relief;
      CHECK((relief.u - plain.u).cwiseAbs().maxCoeff() <= 1e-7 * 0.04);
      CHECK_THAT(relief.energy, WithinRel(weight * weight * plain.energy, 1e-6));
    }
  }
}

TEST_CASE("Painting.TheThicknessPaintedEverywhereIsTheThickness") {
  const TriangleMesh mesh = wavy_ball(3);
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    ReliefOptions options = options_of(3, projection);
    options.carve_depth_mm = 1;
    const Relief plain = solved(mesh, options, {}).relief;
    Painting painting;
    painting.region.assign(static_cast<std::size_t>(mesh.V.rows()), own_thickness);
    painting.thickness_mm = Eigen::VectorXd::Constant(mesh.V.rows(), 3);
    painting.carve_depth_mm = Eigen::VectorXd::Constant(mesh.V.rows(), 1);
    options.thickness_mm = 20;
    options.carve_depth_mm = 0;
    const Relief painted = solved(mesh, options, painting).relief;
    CHECK((painted.u - plain.u).cwiseAbs().maxCoeff() <= 1e-7 * 0.04);
  }
}

TEST_CASE("Painting.AModelThatIsFreeIsTheModelOnItsBase") {
  const TriangleMesh mesh = wavy_ball(3);
  Painting painting;
  painting.region.assign(static_cast<std::size_t>(mesh.V.rows()), free);
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    const Relief relief = solved(mesh, options_of(2, projection), painting).relief;
    CHECK(relief.u.maxCoeff() - relief.u.minCoeff() <= 1e-9);
    CHECK(relief.energy <= 1e-16);
    CHECK_THAT(relief.moved.col(2).maxCoeff(), WithinAbs(0, 1e-9));
  }
}

TEST_CASE("Painting.AFreePartIsItselfAndChangesNoOther") {
  const TwoBalls both = two_balls(3);
  const ReliefOptions options = options_of(3, Projection::orthographic);
  Painting painting;
  for (const char right : both.right) painting.region.push_back(right != 0 ? free : usual);
  const Relief plain = solved(both.mesh, options, {}).relief, relief = solved(both.mesh, options, painting).relief;
  const Eigen::Index n = both.mesh.V.rows() / 2;
  CHECK((relief.u.head(n) - plain.u.head(n)).cwiseAbs().maxCoeff() <= 1e-7 * 0.03);
  const Eigen::VectorXd right = relief.u.tail(n);
  CHECK(right.maxCoeff() - right.minCoeff() <= 1e-9);
  CHECK(relief.moved.col(2).tail(n).maxCoeff() <= 1e-12);
}

TEST_CASE("Painting.WhatIsOnTheBaseLiesOnItExactly") {
  const TriangleMesh mesh = wavy_ball(3);
  Painting all;
  all.region.assign(static_cast<std::size_t>(mesh.V.rows()), on_base);
  Painting rim = all;
  for (Eigen::Index i = 0; i < mesh.V.rows(); ++i)
    if (mesh.V.row(i).head<2>().norm() < 0.8) rim.region[static_cast<std::size_t>(i)] = usual;
  for (const Projection projection : {Projection::perspective, Projection::orthographic})
    for (const Appearance appearance : {Appearance::detail, Appearance::balanced})
      for (const Painting& painting : {all, rim}) {
        ReliefOptions options = options_of(4, projection);
        options.appearance = appearance;
        const Relief relief = solved(mesh, options, painting).relief;
        double off = 0;
        for (Eigen::Index i = 0; i < mesh.V.rows(); ++i)
          if (painting.region_of(i) == on_base) off = std::max(off, std::abs(relief.moved(i, 2)));
        CHECK(off <= 1e-14);
        CHECK(relief.moved.allFinite());
        CHECK(relief.bound_violation_max_mm <= 0);
      }
}

TEST_CASE("Painting.EveryVertexKeepsItsOwnLimitsOnEveryBase") {
  const TriangleMesh mesh = wavy_ball(4);
  const Painting painting = patches(mesh);
  for (const BaseShape shape :
       {BaseShape::flat, BaseShape::cylinder, BaseShape::wave, BaseShape::groove, BaseShape::stairs})
    for (const Projection projection : {Projection::perspective, Projection::orthographic})
      for (const Appearance appearance : {Appearance::detail, Appearance::balanced}) {
        if (shape == BaseShape::stairs && appearance == Appearance::balanced) continue;
        ReliefOptions options = options_of(4, projection);
        options.base = shape;
        options.appearance = appearance;
        options.carve_depth_mm = shape == BaseShape::flat ? 0 : 2;
        options.base_steps = 3;
        const Solved s = solved(mesh, options, painting);
        INFO(EnumNames<BaseShape>::names.at(static_cast<std::size_t>(shape))
             << " " << static_cast<int>(projection) << " " << static_cast<int>(appearance));
        CHECK(s.relief.moved.allFinite());
        CHECK(s.relief.bound_violation_max_mm <= 0);
        CHECK(s.relief.order_violation_max_mm <= 1e-5);
        CHECK(s.relief.qp.kkt_residual <= 1e-6);
        double beyond = 0;
        int own = 0;
        for (Eigen::Index i = 0; i < mesh.V.rows(); ++i) {
          CHECK(s.relief.lambda_mm[i] >= s.relief.lambda_min_mm[i]);
          CHECK(s.relief.lambda_mm[i] <= s.relief.lambda_max_mm[i]);
          const auto [above, below] = room_mm(painting, options, i);
          // Along z: from where the base meets the plate's normal through the moved vertex.
          const double base_depth =
              shape == BaseShape::stairs
                  ? s.base.bands()->depth(s.base.bands()->of_ray(s.frame, s.frame.P.row(i).transpose()))
              : s.base.is_flat() ? 0
                                 : s.base.depth_at(s.relief.moved(i, 0), s.relief.moved(i, 1)).value_or(NAN);
          const double height = 100 * (base_depth - s.relief.moved(i, 2));
          if (std::isnan(height)) continue;  // beyond the edge of the base
          beyond = std::max({beyond, height - above, -height - below});
          own += painting.region_of(i) != usual;
        }
        CHECK(own > 100);
        CHECK(beyond <= 1e-9);
      }
}

TEST_CASE("Painting.TheOrderOfVerticesDoesNotMatter") {
  const TriangleMesh mesh = wavy_ball(3);
  const Painting painting = patches(mesh);
  std::vector<int> order(static_cast<std::size_t>(mesh.V.rows()));
  std::iota(order.begin(), order.end(), 0);
  test::Random random(5);
  for (std::size_t i = order.size(); i > 1; --i)
    std::swap(order[i - 1], order[static_cast<std::size_t>(random.below(static_cast<int>(i)))]);
  TriangleMesh permuted = mesh;
  for (std::size_t i = 0; i < order.size(); ++i) permuted.V.row(static_cast<Eigen::Index>(i)) = mesh.V.row(order[i]);
  std::vector<int> place(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) place[static_cast<std::size_t>(order[i])] = static_cast<int>(i);
  for (int& v : permuted.F.reshaped()) v = place[static_cast<std::size_t>(v)];
  const ReliefOptions options = options_of(4);
  const Relief first = solved(mesh, options, painting).relief,
               second = solved(permuted, options, painting_of(painting, order)).relief;
  CHECK((first.u(order) - second.u).cwiseAbs().maxCoeff() <= 1e-6 * 0.04);
}

TEST_CASE("Painting.WhatMattersMoreKeepsItsShapeBetter") {
  const TriangleMesh mesh = wavy_ball(4);
  const ReliefOptions options = options_of(3);
  Eigen::VectorXd there = Eigen::VectorXd::Zero(mesh.V.rows());
  for (Eigen::Index i = 0; i < mesh.V.rows(); ++i) there[i] = mesh.V(i, 2) > 0 && mesh.V(i, 0) > 0;
  double before_there = 1e300, before_elsewhere = 0;
  // E = E_elsewhere + w^2 E_there: its minimum has less E_there, and more E_elsewhere, the larger w is.
  for (const double weight : {0.1, 0.5, 1.0, 3.0, 10.0}) {
    Painting painting;
    painting.weight = Eigen::VectorXd::Ones(mesh.V.rows()) + (weight - 1) * there;
    const Solved s = solved(mesh, options, painting);
    const double energy_there = AppearanceEnergy(s.frame, s.F, there)(s.relief.u);
    const double energy_elsewhere =
        AppearanceEnergy(s.frame, s.F, Eigen::VectorXd::Ones(there.size()) - there)(s.relief.u);
    CHECK(energy_there <= before_there * (1 + 1e-6));
    CHECK(energy_elsewhere >= before_elsewhere * (1 - 1e-6));
    CHECK_THAT(s.relief.energy, WithinRel(energy_elsewhere + weight * weight * energy_there, 1e-9));
    before_there = energy_there;
    before_elsewhere = energy_elsewhere;
  }
}

TEST_CASE("Painting.ASmoothWeightConverges") {
  // Differences between a mesh and the next finer one at the vertices that both have.
  std::vector<double> change;
  std::optional<Eigen::VectorXd> before;
  for (const int levels : {3, 4, 5}) {
    const TriangleMesh mesh = wavy_ball(levels);
    Painting painting;
    painting.weight = (1.5 * mesh.V.col(0).array()).exp();
    const Solved s = solved(mesh, options_of(5, Projection::orthographic), painting);
    const Eigen::VectorXd depth = s.relief.moved.col(2);
    if (before)
      change.push_back(
          std::sqrt((depth.head(before->size()) - *before).squaredNorm() / static_cast<double>(before->size())));
    before = depth;
  }
  INFO("changes " << change[0] << " " << change[1]);
  CHECK(std::log2(change[0] / change[1]) >= 1.0);
}

TEST_CASE("Painting.RegionsShareAFactorAndWeightsDoNot") {
  const TriangleMesh mesh = wavy_ball(3);
  const ReliefOptions options = options_of(4);
  const Painting painting = patches(mesh);
  CHECK(ReliefSolver::key(options, painting.weight) != ReliefSolver::key(options));
  CHECK(ReliefSolver::key(options, painting.weight) != ReliefSolver::key(options, 2 * painting.weight));
  Context context;
  ReliefSolver solver(mesh, options, context, painting.weight);
  solver.solve(options, context);
  const Relief warm = solver.solve(options, BaseSurface(), context, painting),
               cold = solved(mesh, options, painting).relief;
  CHECK((warm.u - cold.u).cwiseAbs().maxCoeff() <= 1e-7 * 0.04);
}

TEST_CASE("Painting.ExtremeWeightsStayFinite") {
  const TriangleMesh mesh = wavy_ball(4);
  test::Random random(9);
  Painting painting;
  painting.weight = Eigen::VectorXd::NullaryExpr(
      mesh.V.rows(), [&] { return random.below(2) != 0 ? max_painted_weight : min_painted_weight; });
  for (const Appearance appearance : {Appearance::detail, Appearance::balanced}) {
    ReliefOptions options = options_of(2);
    options.appearance = appearance;
    options.hidden_weight = 0.001;
    const Relief relief = solved(mesh, options, painting).relief;
    CHECK(relief.u.allFinite());
    CHECK(relief.bound_violation_max_mm <= 0);
  }
}

TEST_CASE("Painting.AFreeRegionStaysBeforeTheViewpoint") {
  // A long rod along the view: free, it would reach past the viewpoint.
  TriangleMesh rod = test::icosphere(3);
  rod.V.col(2) *= 3;
  Painting painting;
  painting.region.assign(static_cast<std::size_t>(rod.V.rows()), free);
  ReliefOptions options = options_of(3);
  options.field_of_view_deg = 15;
  const Solved s = solved(rod, options, painting);
  CHECK(s.relief.moved.allFinite());
  CHECK(-s.relief.moved.col(2).minCoeff() * s.frame.kappa <= 0.5 + 1e-12);
  CHECK(s.relief.moved.col(2).maxCoeff() <= 1e-12);
}

TEST_CASE("Painting.TheSolidHasRoomForWhatIsFree") {
  const TriangleMesh mesh = wavy_ball(4);
  const Painting painting = patches(mesh);
  ReliefOptions options = options_of(3, Projection::orthographic);
  const Solved s = solved(mesh, options, painting);
  const double top_mm = -100 * s.relief.moved.col(2).minCoeff();
  CHECK(top_mm > 5);
  Context context;
  const AllowedSpace space{s.base, top_mm, 1};
  CoveringMesh front{s.relief.moved, s.F};
  front.above_mm = &s.relief.above_mm;
  front.below_mm = &s.relief.below_mm;
  const HeightMap map = make_height_map(front, 100, {100, 100 * s.frame.image_height}, 0.5, space, context);
  CHECK_THAT(*std::ranges::max_element(map.height_mm), WithinAbs(top_mm, 0.2));
  for (int row = 0; row < map.rows; ++row)
    for (int column = 0; column < map.columns / 6; ++column) CHECK(map.at(row, column) == 0);
}

}  // namespace formwright::painting_tests
