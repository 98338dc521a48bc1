// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/parts/feature_lines.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <Eigen/Geometry>
#include <cmath>
#include <set>

#include "geometry/mesh/measures.h"
#include "zippable/proposal.h"
#include "zippable/zippable_shapes.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

using std::numbers::pi;

FeatureLines features(const TriangleMesh& mesh, double scale_mm, double min_rad = 0.35) {
  Context context;
  return find_features(mesh, Adjacency(mesh), {scale_mm, min_rad}, context);
}

/// Two cones that meet in a ring of radius 30 at z = 0, bent by `bend_rad` there: a ridge, or a valley where that is
/// negative.
TriangleMesh waist(double bend_rad, int around = 96, int rows = 40) {
  const double slope = std::tan(0.5 * bend_rad);
  return test::turned(around, rows, [&](double t) {
    const double z = 60 * t - 30;
    return Vec2(30 - slope * std::abs(z), z);
  });
}

TEST_CASE("Features.ThereAreNoneOnSpheresAndCylinders") {
  TriangleMesh ball = test::icosphere(4);
  ball.V *= 20;
  CHECK(features(ball, 3).points.empty());
  CHECK(features(ball, 3).bend_rad.cwiseAbs().maxCoeff() < 0.1);
  for (const double radius : {5.0, 20.0}) {
    const TriangleMesh tube = test::cylinder_side(radius, 100, 60, 60);
    const FeatureLines lines = features(tube, 3);
    INFO(radius);
    CHECK(lines.points.empty());
  }
}

TEST_CASE("Features.ARingIsFoundWhereItIs") {
  for (const double bend : {0.6, 1.0, -0.6, -1.0}) {
    const TriangleMesh mesh = waist(bend);
    const FeatureLines lines = features(mesh, 3);
    std::set<int> ring;
    for (int v = 0; v < mesh.vertex_count(); ++v)
      if (std::abs(mesh.V(v, 2)) < 1e-9) ring.insert(v);
    REQUIRE(ring.size() == 96u);
    {
      INFO(bend);
      REQUIRE(lines.points.size() == ring.size());
    }
    for (const FeaturePoint& point : lines.points) {
      CHECK(ring.contains(point.vertex));
      CHECK_THAT(std::abs(point.along.z()), WithinAbs(0, 1e-3));
      // What is around takes a quarter of it, the ring's own curvature and the mesh a little more.
      CHECK_THAT(point.bend_rad, WithinAbs(0.75 * bend, 0.15 * std::abs(bend)));
    }
    const Adjacency adjacency(mesh);
    for (int e = 0; e < adjacency.edge_count(); ++e) {
      const auto [a, b] = adjacency.edges()[e];
      {
        INFO(e);
        CHECK((lines.sharp[e] != 0) == (ring.contains(a) && ring.contains(b)));
      }
      CHECK((!lines.sharp[e] || lines.bend_rad[e] * bend > 0));
    }
    for (int v = 0; v < mesh.vertex_count(); ++v)
      CHECK((!ring.contains(v) || (lines.valley_rad[v] > 0.3) == (bend < 0)));
  }
}

TEST_CASE("Features.ARoundedSeamIsFoundToo") {
  // A valley of 80 degrees in a tube, rounded over 4 mm: nothing is sharp in it.
  const auto profile = [](double t) {
    const double z = 60 * t - 30;
    return Vec2(20 + std::tan(0.7) * (std::hypot(z, 4.0) - 4), z);
  };
  for (const int rows : {60, 120}) {
    const TriangleMesh mesh = test::turned(2 * rows, rows, profile);
    const FeatureLines lines = features(mesh, 3);
    REQUIRE(lines.points.size() >= static_cast<std::size_t>(2 * rows));
    CHECK(std::count(lines.sharp.begin(), lines.sharp.end(), 1) == 0);
    for (const FeaturePoint& point : lines.points) {
      CHECK(std::abs(mesh.V(point.vertex, 2)) < 1.1 * mean_edge_length(mesh));
      CHECK(point.bend_rad < -0.35);
      CHECK(std::abs(point.along.z()) < 0.05);
    }
  }
}

TEST_CASE("Features.DoNotDependOnSizeOrPlace") {
  const TriangleMesh mesh = waist(0.8);
  TriangleMesh other = mesh;
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  other.V = 3 * mesh.V * turn.transpose();
  other.V.rowwise() += Eigen::RowVector3d(100, -50, 7);
  const FeatureLines a = features(mesh, 3), b = features(other, 9);
  CHECK((a.bend_rad - b.bend_rad).cwiseAbs().maxCoeff() < 1e-6);
  REQUIRE(a.points.size() == b.points.size());
  for (std::size_t i = 0; i < a.points.size(); ++i) CHECK(a.points[i].vertex == b.points[i].vertex);
}

// ---- borders -------------------------------------------------------------------------------------------------------

/// Balls that all hold the origin, united: the surface along every direction from there.
struct Ball {
  Vec3 centre;
  double radius;
};

TriangleMesh united(const std::vector<Ball>& balls, int levels) {
  TriangleMesh mesh = test::icosphere(levels);
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    const Vec3 d = mesh.V.row(v).transpose();
    double reach = 0;
    for (const Ball& b : balls)
      reach = std::max(reach, d.dot(b.centre) + std::sqrt(std::pow(d.dot(b.centre), 2) - b.centre.squaredNorm() +
                                                          b.radius * b.radius));
    mesh.V.row(v) *= reach;
  }
  return mesh;
}

/// How far a point lies from the plane in which two balls meet.
double off_plane(const Ball& a, const Ball& b, const Vec3& x) {
  const double powers =
      (x - a.centre).squaredNorm() - a.radius * a.radius - (x - b.centre).squaredNorm() + b.radius * b.radius;
  return std::abs(powers) / (2 * (a.centre - b.centre).norm());
}

std::vector<Vec3> ring_at(double z, double radius, int count, double wobble) {
  std::vector<Vec3> points;
  for (int k = 0; k < count; ++k) {
    const double u = 2 * pi * k / count;
    points.emplace_back(radius * std::cos(u), radius * std::sin(u), z + wobble * (k % 2 ? 1 : -1));
  }
  return points;
}

Proposal drawn(const TriangleMesh& mesh, const DrawnCurve& curve, bool follow) {
  Context context;
  ProposalOptions options;
  options.puncture_radius_mm = 3;
  options.curves = {curve};
  options.follow_creases = follow;
  options.features = {3, 0.35};
  options.snap_reach_mm = 8;
  return propose_segmentation(mesh, options, context);
}

TEST_CASE("Snapping.ALoopDrawnBesideASharpRingComesOutOnItExactly") {
  for (const double bend : {0.7, -0.7}) {
    const TriangleMesh mesh = waist(bend);
    const DrawnCurve roughly{ring_at(2.5, 30, 7, 2), true, {}};
    const Segmentation snapped = drawn(mesh, roughly, true).segmentation;
    REQUIRE(snapped.part_count() == 2);
    REQUIRE(snapped.interfaces.size() == 1u);
    REQUIRE(snapped.interfaces[0].vertices.size() == 97u);  // the ring's own, and the first again
    for (const int v : snapped.interfaces[0].vertices) CHECK_THAT(snapped.mesh.V(v, 2), WithinAbs(0, 1e-12));
    // Without, or where the loop itself says no, it stays where it was drawn.
    DrawnCurve unsnapped = roughly;
    unsnapped.snap = false;
    for (const Proposal& proposal : {drawn(mesh, roughly, false), drawn(mesh, unsnapped, true)}) {
      const Segmentation& s = proposal.segmentation;
      double mean = 0;
      for (const int v : s.interfaces[0].vertices)
        mean += s.mesh.V(v, 2) / static_cast<double>(s.interfaces[0].vertices.size());
      CHECK(mean > 1);
    }
    unsnapped.snap = true;  // and this one alone
    const Segmentation alone = drawn(mesh, unsnapped, false).segmentation;
    for (const int v : alone.interfaces[0].vertices) CHECK_THAT(alone.mesh.V(v, 2), WithinAbs(0, 1e-12));
  }
}

TEST_CASE("Snapping.ALoopFollowsTheSeamOfTwoBalls") {
  // An organic crease: no edge of the mesh lies along it.
  const std::vector<Ball> balls{{{0, 0, -14}, 20}, {{3, 0, 13}, 18}};
  double before = 1e9;
  for (const int levels : {4, 5}) {
    const TriangleMesh mesh = united(balls, levels);
    const Segmentation s = drawn(mesh, {ring_at(1, 14, 6, 1.5), true, {}}, true).segmentation;
    REQUIRE(s.part_count() == 2);
    double mean = 0, worst = 0;
    for (const int v : s.interfaces[0].vertices) {
      const double off = off_plane(balls[0], balls[1], s.mesh.V.row(v).transpose());
      mean += off / static_cast<double>(s.interfaces[0].vertices.size());
      worst = std::max(worst, off);
    }
    CHECK(worst < 1.5 * mean_edge_length(mesh));
    CHECK(mean < 0.8 * before);
    before = mean;
  }
}

TEST_CASE("Snapping.FoundBordersMoveIntoValleys") {
  // Three balls of different sizes: half-way between their tips is not where they meet.
  const std::vector<Ball> balls{{{0, 22, 0}, 27}, {{-16, -9, 0}, 20}, {{15, -9, 0}, 18}};
  const TriangleMesh mesh = united(balls, 5);
  Context context;
  const auto off_valleys = [&](bool follow) {
    ProposalOptions options;
    options.puncture_radius_mm = 3;
    options.tips_mm = {{0, 49, 0}, {-33, -19, 0}, {30, -19, 0}};
    options.follow_creases = follow;
    options.features = {3, 0.35};
    const Segmentation s = propose_segmentation(mesh, options, context).segmentation;
    CHECK(s.part_count() == 3);
    double sum = 0, count = 0;
    for (const Interface& interface : s.interfaces)
      for (const int v : interface.vertices) {
        const Vec3 x = s.mesh.V.row(v).transpose();
        // Of the three planes the nearest.
        sum += std::min(
            {off_plane(balls[0], balls[1], x), off_plane(balls[1], balls[2], x), off_plane(balls[2], balls[0], x)}),
            ++count;
      }
    return sum / count;
  };
  const double straight = off_valleys(false), along = off_valleys(true);
  CHECK(along < 0.6 * straight);
  CHECK(along < 2 * mean_edge_length(mesh));
}

}  // namespace
}  // namespace formwright
