// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/base/cut_into_parts.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <map>

#include "geometry/planar/plane.h"
#include "relief/base/seen_regions.h"
#include "relief/parts/parts_fixture.h"
#include "relief/view/straight_view.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;

TriangleMesh two_steps_mm() {
  // As stairs of two steps 20 mm apart, which rise upwards.
  return test::joined(test::box_mm({-90, -90, -40}, {90, 0, 0}), test::box_mm({-90, 0, -60}, {90, 90, -20}));
}

/// Area of each part's triangles as seen from the viewpoint, with their sign.
std::map<int, double> areas_seen(const test::OnParts& on) {
  std::map<int, double> areas;
  const Positions V = straightened(on.relief.pieces.V, on.frame.kappa);
  for (Eigen::Index f = 0; f < on.relief.pieces.F.rows(); ++f) {
    const auto at = [&](int k) -> Vec2 { return V.row(on.relief.pieces.F(f, k)).head<2>().transpose(); };
    areas[on.relief.pieces.band[static_cast<std::size_t>(f)]] +=
        0.5 * std::abs(cross(Vec2(at(1) - at(0)), Vec2(at(2) - at(0))));
  }
  return areas;
}

TEST_CASE("CutIntoParts.TwoBlocksAreAsStairsOfTwoSteps") {
  const ReliefOptions options = test::options_on_parts(Projection::orthographic);
  const test::OnParts blocks = test::relief_on(two_steps_mm(), options);
  ReliefOptions stairs = options;
  stairs.base = BaseShape::stairs;
  stairs.base_steps = 2;
  stairs.base_depth_mm = 20;
  Context context;
  ReliefSolver solver(test::icosphere(4), stairs, context);
  const Relief steps = solver.solve(
      stairs, BaseSurface(base_shape(stairs, solver.frame()), base_bands(stairs, solver.frame())), context);
  REQUIRE(blocks.relief.u.size() == steps.u.size());
  // A vertex on the border itself may go with either step.
  double largest = 0;
  for (Eigen::Index i = 0; i < steps.u.size(); ++i)
    if (std::abs(blocks.frame.P(i, 1)) > 1e-9) largest = std::max(largest, std::abs(blocks.relief.u[i] - steps.u[i]));
  CHECK(largest < 1e-9);
  CHECK_THAT(blocks.relief.energy, WithinRel(steps.energy, 1e-9));
  // The same area is cut for each, whatever the triangles.
  double by_step[2] = {0, 0};
  for (Eigen::Index f = 0; f < steps.pieces.F.rows(); ++f) {
    const auto at = [&](int k) -> Vec2 { return steps.pieces.V.row(steps.pieces.F(f, k)).head<2>().transpose(); };
    by_step[steps.pieces.band[static_cast<std::size_t>(f)]] +=
        0.5 * std::abs(cross(Vec2(at(1) - at(0)), Vec2(at(2) - at(0))));
  }
  const auto by_part = areas_seen(blocks);
  CHECK_THAT(by_part.at(0), WithinRel(by_step[0], 1e-9));
  CHECK_THAT(by_part.at(1), WithinRel(by_step[1], 1e-9));
}

TEST_CASE("CutIntoParts.LosesNothingAndKeepsEveryBound") {
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    // A wall with a ball and a leaning board before it.
    TriangleMesh board = test::rotated(test::box_mm({-8, -60, -1}, {8, 60, 1}), Vec3(0, 0, 1), 0.4);
    board = test::moved(board, {25, 0, -12});
    const TriangleMesh base = test::joined(
        test::joined(test::box_mm({-90, -90, -60}, {90, 90, -30}), test::moved(test::icosphere(3), {-20, 5, -15}, 12)),
        board);
    const test::OnParts on = test::relief_on(base, test::options_on_parts(projection));
    REQUIRE(on.parts->count() == 3);
    const ReliefPieces& cut = on.relief.pieces;
    // A ball is met twice by every ray: before all that carries nothing is lost.
    const Region outline = outline_of({straightened(on.frame.P, on.frame.kappa), on.F});
    Region carrying;
    for (int part = 0; part < 3; ++part) carrying = united(carrying, on.parts->seen(part));
    const double whole = 2 * common(outline, carrying).area();
    CHECK(whole > 2 * 0.99 * outline.area());
    double sum = 0;
    for (const auto& [part, area] : areas_seen(on)) {
      CHECK(area > 0.01);
      sum += area;
    }
    CHECK_THAT(sum, WithinRel(whole, 1e-6));
    // Each vertex lies where its part is seen, in its space, and belongs to one part.
    std::map<int, int> part_of;
    double highest = -INFINITY;
    for (Eigen::Index f = 0; f < cut.F.rows(); ++f)
      for (int k = 0; k < 3; ++k) {
        const int part = cut.band[static_cast<std::size_t>(f)];
        CHECK(part_of.try_emplace(cut.F(f, k), part).first->second == part);
      }
    const double thickness = on.options.thickness_mm / on.options.width_mm;
    for (const auto& [vertex, part] : part_of) {
      const Vec3 p = cut.V.row(vertex).transpose();
      const Vec2 place = straightened(p, on.frame.kappa).head<2>();
      REQUIRE(grown(on.parts->seen(part), 1e-7).contains(place));
      const auto passage = on.parts->passage(part, place);
      REQUIRE(passage.has_value());
      REQUIRE(p.z() >= passage->enters - thickness - 1e-9);
      REQUIRE(p.z() <= passage->enters + 1e-9);
      highest = std::max(highest, passage->enters - p.z());
    }
    CHECK_THAT(highest, WithinAbs(thickness, 1e-9));
  }
}

TEST_CASE("CutIntoParts.EveryPartOfTheSurfaceHangsTogetherAcrossItsTriangles") {
  // Between two triangles of one part an edge is shared; free edges lie on borders and on the surface's own.
  const test::OnParts on = test::relief_on(
      test::joined(test::box_mm({-90, -90, -60}, {90, 90, -30}), test::moved(test::icosphere(3), {0, 0, -12}, 15)),
      test::options_on_parts(Projection::perspective));
  const ReliefPieces& cut = on.relief.pieces;
  std::map<std::pair<int, int>, int> uses;
  std::map<int, int> part_of;
  for (Eigen::Index f = 0; f < cut.F.rows(); ++f)
    for (int k = 0; k < 3; ++k) {
      ++uses[std::minmax(cut.F(f, k), cut.F(f, (k + 1) % 3))];
      part_of[cut.F(f, k)] = cut.band[static_cast<std::size_t>(f)];
    }
  std::vector<Region> inner, outer;
  for (int part = 0; part < 2; ++part) {
    inner.push_back(grown(on.parts->seen(part), -1e-6));
    outer.push_back(grown(on.parts->seen(part), 1e-6));
  }
  const Positions V = straightened(cut.V, on.frame.kappa);
  int free = 0;
  for (const auto& [edge, times] : uses) {
    REQUIRE(times <= 2);
    if (times == 2) continue;
    ++free;
    const Vec2 middle = 0.5 * (V.row(edge.first) + V.row(edge.second)).head<2>().transpose();
    const auto part = static_cast<std::size_t>(part_of[edge.first]);
    REQUIRE(outer[part].contains(middle));
    REQUIRE(!inner[part].contains(middle));
  }
  CHECK(free > 0);
}

TEST_CASE("CutIntoParts.LeavesNoHolesAlongBorders") {
  // Borders run through vertices and along edges of the ball and of the ring; and side by side where one block hides
  // others: neighbours round the same border differently.
  const TriangleMesh blocks = test::joined(
      test::joined(test::box_mm({-80, 0, -20}, {0, 100, 0}), test::box_mm({0, 0, -35}, {80, 100, -15})),
      test::joined(test::box_mm({-80, -100, -40}, {80, 0, -20}), test::box_mm({-30, -60, -10}, {30, -20, 5})));
  for (const Projection projection : {Projection::perspective, Projection::orthographic})
    for (const TriangleMesh& model :
         {test::icosphere(4), test::torus(64, 32), test::rotated(test::torus(200, 80), Vec3(1, 2, 3), 0.3)}) {
      const ReliefOptions options = test::options_on_parts(projection);
      const test::OnParts on = test::relief_on(blocks, options, model);
      const TriangleMesh whole{straightened(on.frame.P, on.frame.kappa), on.F};
      const RayCaster of_whole(whole);
      const Positions V = straightened(on.relief.pieces.V, on.frame.kappa);
      const double front = V.col(2).minCoeff() - 2;
      const auto is_met = [&](const RayCaster& caster, const Vec2& p) {
        return caster.first_hit(Vec3(p.x(), p.y(), front), Vec3::UnitZ(), 0, 10).has_value();
      };
      int met = 0, holes = 0;
      for (int part = 0; part < on.parts->count(); ++part) {
        std::vector<Eigen::Index> faces;
        for (Eigen::Index f = 0; f < on.relief.pieces.F.rows(); ++f)
          if (on.relief.pieces.band[static_cast<std::size_t>(f)] == part) faces.push_back(f);
        const RayCaster of_part(TriangleMesh{V, on.relief.pieces.F(faces, Eigen::all)});
        for (const double inset : {1e-4, 1e-5})
          for (const std::vector<Vec2>& ring : grown(on.parts->seen(part), -inset).rings)
            for (std::size_t k = 0; k < ring.size(); ++k)
              for (int step = 0; step < 1000; ++step) {
                const Vec2 p = ring[k] + (ring[(k + 1) % ring.size()] - ring[k]) * (step / 1000.0);
                bool certain = true;
                for (const Vec2& off : {Vec2(2e-4, 0), Vec2(-2e-4, 0), Vec2(0, 2e-4), Vec2(0, -2e-4)})
                  certain = certain && is_met(of_whole, p + off);
                if (!certain) continue;
                ++met;
                holes += !is_met(of_part, p);
              }
      }
      CHECK(met > 500);
      CHECK(holes == 0);
    }
}

}  // namespace
}  // namespace formwright
