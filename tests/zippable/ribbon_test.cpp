// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/ribbon/ribbon.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <Eigen/Geometry>
#include <cmath>

#include "geometry/mesh/adjacency.h"
#include "geometry/queries/point_distance.h"
#include "zippable/parts/polygon_dissection.h"
#include "zippable/zippable_shapes.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

using std::numbers::pi;

/// Everything that theory says of any ribbon.
void expect_sound(const test::Zipped& z) {
  const Ribbon& ribbon = z.ribbon;
  const TriangleMesh formed = ribbon.formed();
  const Adjacency adjacency(formed);
  const int count = formed.vertex_count();
  CHECK(adjacency.is_manifold());
  CHECK(euler_characteristic(adjacency) == 1);
  CHECK(face_components(adjacency).count == 1);
  const auto loops = boundary_loops(adjacency);
  REQUIRE(loops.size() == 1u);
  REQUIRE(static_cast<int>(loops[0].size()) == count);      // no inner vertices
  for (int i = 0; i < count; ++i) CHECK(loops[0][i] == i);  // the boundary is the walk itself
  CHECK(formed.face_count() == count - 2);
  CHECK(ribbon.opening_arcs == 2 + 2 * z.curve.fermat_spirals);
  CHECK(ribbon.isometry_error <= 1e-9);
  // Every place on the zipper stands once on either side, in opposite orders, and the sides are equally long.
  double left = 0, right = 0;
  std::vector<int> seen_left(z.curve.samples.size(), 0), seen_right(z.curve.samples.size(), 0);
  for (int i = 0; i < count; ++i) {
    const RibbonVertex &a = ribbon.boundary[i], &b = ribbon.boundary[(i + 1) % count];
    if (a.sample >= 0) ++(a.left ? seen_left : seen_right)[a.sample];
    if (a.piece < 0 || a.piece != b.piece || a.left != b.left) continue;
    CHECK(b.sample - a.sample == (a.left ? 1 : -1));
    (a.left ? left : right) += (ribbon.flat_mm[i] - ribbon.flat_mm[(i + 1) % count]).norm();
  }
  for (std::size_t k = 0; k < seen_left.size(); ++k) CHECK((seen_left[k] == 1 && seen_right[k] == 1));
  CHECK_THAT(left, WithinAbs(right, 1e-9 * left));
  CHECK_THAT(left, WithinAbs(ribbon.zipper_mm, 1e-9 * left));
  // Flat triangles face the way of those in space: none is turned over or without area.
  for (int f = 0; f < formed.face_count(); ++f) {
    const Vec2 a = ribbon.flat_mm[formed.F(f, 0)], e1 = ribbon.flat_mm[formed.F(f, 1)] - a,
               e2 = ribbon.flat_mm[formed.F(f, 2)] - a;
    CHECK(e1.x() * e2.y() - e1.y() * e2.x() > 0);
  }
}

TEST_CASE("PolygonDissection.FillsAPolygonWithTheShortestDiagonals") {
  // Against all triangulations of random polygons, by recursion.
  test::Random random(4);
  for (int trial = 0; trial < 40; ++trial) {
    const int n = 3 + random.below(6);
    std::vector<Vec3> points;
    for (int i = 0; i < n; ++i) points.push_back(random.in_cube());
    std::vector<int> polygon(n);
    for (int i = 0; i < n; ++i) polygon[i] = i;
    const auto cost = [&](int a, int b) { return (points[a] - points[b]).norm(); };
    const auto sides = [&](int a, int b) { return b - a == 1 || (a == 0 && b == n - 1) ? 0.0 : cost(a, b); };
    const std::function<double(int, int)> minimum = [&](int i, int j) {
      if (j - i < 2) return 0.0;
      double best = 1e300;
      for (int k = i + 1; k < j; ++k) best = std::min(best, minimum(i, k) + minimum(k, j) + sides(i, k) + sides(k, j));
      return best;
    };
    double total = 0;
    const auto triangles = cheapest_triangulation(polygon, cost, [](int, int, int) { return 0.0; });
    CHECK(static_cast<int>(triangles.size()) == n - 2);
    for (const auto& t : triangles) {
      CHECK((t[0] < t[1] && t[1] < t[2]));
      total += sides(t[0], t[1]) + sides(t[1], t[2]) + sides(t[0], t[2]);
    }
    CHECK_THAT(total, WithinAbs(2 * minimum(0, n - 1), 1e-9));  // every diagonal belongs to two triangles
  }
}

TEST_CASE("PolygonDissection.DropsWhatCrosses") {
  const std::vector<Chord> kept =
      without_crossings({{0, 5}, {2, 7}, {0, 5}, {1, 2}, {5, 9}, {6, 9}, {0, 9}, {1, 4}, {0, 8}}, 10);
  const auto pieces = dissect(10, kept);
  REQUIRE(kept.size() == 4u);  // 0-5, 5-9, 6-9, 1-4; 0-8 crosses 5-9
  CHECK(pieces.size() == 5u);
  std::size_t corners = 0;
  for (const auto& piece : pieces) corners += piece.size();
  CHECK(corners == 10u + 2 * kept.size());
}

TEST_CASE("Unfold.KeepsEveryEdge") {
  // A fan with random bends.
  test::Random random(8);
  std::vector<Vec3> points{Vec3::Zero()};
  Triangles F(30, 3);
  for (int i = 0; i <= 30; ++i) points.push_back(random.direction() * random.uniform(1, 2));
  for (int i = 0; i < 30; ++i) F.row(i) << 0, i + 1, i + 2;
  const auto flat = unfold(points, F);
  for (int i = 0; i < 30; ++i)
    for (int k = 0; k < 3; ++k) {
      const int a = F(i, k), b = F(i, (k + 1) % 3);
      CHECK_THAT((flat[a] - flat[b]).norm(), WithinAbs((points[a] - points[b]).norm(), 1e-12));
    }
}

TEST_CASE("Ribbon.OfACylinderIsAStraightStrip") {
  const int around = 48;
  const Segmentation s = test::alone(test::tube(around, 24));
  const double period = around * 2 * std::sin(pi / around), windings = 5;
  CurveOptions options;
  options.width_mm = 1 / windings, options.windings = windings,
  options.sample_mm = period / (around - 0.5);  // one a side of the prism
  const test::Zipped z = test::zip(s, options);
  expect_sound(z);
  // Sides of the prism are bent along its upright edges only, which are rulings: the strip is the parallelogram of the
  // parameter domain. Its zipper sides are straight and as far apart as the slope says.
  const double length = std::hypot(windings * period, 1.0), width = period / length;  // area period * 1 over length
  CHECK_THAT(z.ribbon.zipper_mm, WithinAbs(length, 1e-9));
  const auto& flat = z.ribbon.flat_mm;
  int first = -1, last = -1;
  for (int i = 0; i < static_cast<int>(flat.size()); ++i)
    if (z.ribbon.boundary[i].sample >= 0 && z.ribbon.boundary[i].left) {
      if (first < 0) first = i;
      last = i;
    }
  const Vec2 along = (flat[last] - flat[first]).normalized(), across(-along.y(), along.x());
  CHECK_THAT((flat[last] - flat[first]).norm(), WithinAbs(length, 1e-9));
  for (std::size_t i = 0; i < flat.size(); ++i) {
    const RibbonVertex& v = z.ribbon.boundary[i];
    if (v.sample < 0) continue;
    CHECK_THAT(across.dot(flat[i] - flat[first]), WithinAbs(v.left ? 0 : width, 1e-8));
  }
  CHECK_THAT(z.ribbon.width_mean_mm, WithinAbs(1 / windings, 1e-9));  // rulings are upright
  CHECK_THAT(z.ribbon.width_min_mm, WithinAbs(1 / windings, 1e-9));
}

TEST_CASE("Ribbon.OnAConeAndASphereHasTheKnownSpacing") {
  const double windings = 9;
  CurveOptions options;
  options.windings = windings, options.sample_mm = 0.05;
  const double slant = std::hypot(2.0, 1.0);
  options.width_mm = slant / windings;
  const test::Zipped cone =
      test::zip(test::alone(test::turned(64, 40, [](double t) { return Vec2(2 - t, 2 * t); })), options);
  expect_sound(cone);
  CHECK_THAT(cone.ribbon.width_mean_mm, WithinAbs(slant / windings, 0.01 * slant / windings));
  CHECK(cone.ribbon.width_min_mm > 0.97 * slant / windings);
  const double arc = (pi - 0.4) / windings;
  options.width_mm = arc;
  const test::Zipped sphere =
      test::zip(test::alone(test::turned(64, 48,
                                         [](double t) {
                                           const double colatitude = pi - 0.2 - t * (pi - 0.4);
                                           return Vec2(std::sin(colatitude), std::cos(colatitude));
                                         })),
                options);
  expect_sound(sphere);
  CHECK_THAT(sphere.ribbon.width_mean_mm, WithinAbs(2 * std::sin(arc / 2), 0.02 * arc));
}

TEST_CASE("Ribbon.ApproachesTheSurfaceWithTheSquareOfItsWidth") {
  const Segmentation s = test::alone(test::turned(128, 96, [](double t) {
    const double colatitude = pi - 0.2 - t * (pi - 0.4);
    return Vec2(std::sin(colatitude), std::cos(colatitude));
  }));
  std::vector<double> mean;
  for (const double windings : {4.0, 8.0, 16.0}) {
    CurveOptions options;
    options.windings = windings, options.width_mm = (pi - 0.4) / windings, options.sample_mm = 0.2 * options.width_mm;
    const test::Zipped z = test::zip(s, options);
    Context context;
    mean.push_back(surface_distance(z.ribbon.formed(), PointDistance(s.mesh), 0.02, context).mean);
  }
  CHECK(std::log2(mean[0] / mean[1]) > 1.6);
  CHECK(std::log2(mean[1] / mean[2]) > 1.4);  // the mesh's own error shows
}

TEST_CASE("Ribbon.IsSoundOnEverySampleAtManyWidths") {
  for (const SampleInfo& sample : sample_catalog()) {
    const Proposal proposal = test::proposed(sample.name, 2500, 4);
    for (const double width : {30.0, 14.0, 5.0}) {
      INFO(sample.name + " " + std::to_string(width));
      CurveOptions options;
      options.width_mm = width, options.sample_mm = 0.25 * width;
      const test::Zipped z = test::zip(proposal.segmentation, options);
      expect_sound(z);
      if (width < 10) {
        CHECK_THAT(z.ribbon.width_mean_mm, WithinAbs(width, 0.25 * width));
      }
    }
  }
}

TEST_CASE("Ribbon.MovesAndGrowsWithTheModel") {
  // Nothing symmetric, where two diagonals would be equally long but for rounding.
  const Segmentation s = test::proposed("cat", 3000).segmentation;
  CurveOptions options;
  options.width_mm = 12, options.sample_mm = 3;
  const test::Zipped z = test::zip(s, options);
  const TriangleMesh other = test::moved(test::rotated(s.mesh, Vec3(1, -1, 2), 1.1), Vec3(5, 60, -9), 2.5);
  options.width_mm *= 2.5, options.sample_mm *= 2.5;
  const test::Zipped y = test::zip(make_segmentation(other, s.face_segment), options);
  REQUIRE(z.ribbon.flat_mm.size() == y.ribbon.flat_mm.size());
  CHECK(z.ribbon.F == y.ribbon.F);
  for (std::size_t i = 0; i < z.ribbon.flat_mm.size(); ++i)
    CHECK((2.5 * z.ribbon.flat_mm[i] - y.ribbon.flat_mm[i]).norm() <= 1e-2);
}

}  // namespace
}  // namespace formwright
