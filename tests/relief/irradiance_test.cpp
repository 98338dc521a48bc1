// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/light/irradiance.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "base/parallel.h"
#include "geometry/test_meshes.h"

namespace formwright::irradiance_tests {
namespace {
using Catch::Matchers::WithinAbs;
constexpr double pi = std::numbers::pi;

TriangleMesh rectangles(const std::vector<std::array<Vec3, 4>>& corners) {
  TriangleMesh mesh;
  mesh.V.resize(4 * static_cast<Eigen::Index>(corners.size()), 3);
  mesh.F.resize(2 * static_cast<Eigen::Index>(corners.size()), 3);
  for (int r = 0; r < static_cast<int>(corners.size()); ++r) {
    for (int k = 0; k < 4; ++k)
      mesh.V.row(4 * r + k) = corners[static_cast<std::size_t>(r)][static_cast<std::size_t>(k)].transpose();
    mesh.F.row(2 * r) << 4 * r, 4 * r + 1, 4 * r + 2;
    mesh.F.row(2 * r + 1) << 4 * r, 4 * r + 2, 4 * r + 3;
  }
  return mesh;
}

/// The wall z = 0.
const LitObject& wall() {
  static const LitObject object(rectangles({{Vec3(-50, -50, 0), Vec3(50, -50, 0), Vec3(50, 50, 0), Vec3(-50, 50, 0)}}));
  return object;
}

SurfacePoints one_point(const Vec3& place, const Vec3& normal, double clearance = 1e-7) {
  SurfacePoints points;
  points.place = place.transpose();
  points.normal = normal.normalized().transpose();
  points.clearance = clearance;
  return points;
}

double lit(const LitObject& object, const SurfacePoints& points, const LightSamples& light) {
  Context context;
  return irradiance(object, points, light, context).lit[0];
}

/// The irradiance of a polygon whose radiance is 1: Lambert's formula of 1760, half the sum over its edges of the angle
/// that an edge is seen under times the cosine between the normal and the plane through it.
double lambert_polygon(const std::vector<Vec3>& corners, const Vec3& from, const Vec3& normal) {
  double sum = 0;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Vec3 a = (corners[k] - from).normalized(), b = (corners[(k + 1) % corners.size()] - from).normalized();
    sum += std::acos(a.dot(b)) * normal.dot(a.cross(b).normalized());
  }
  return std::abs(sum) / 2;
}

/// By how many powers of the number of samples an error falls from the first to the last.
double order(const std::vector<int>& counts, const std::vector<double>& errors) {
  return std::log(errors.front() / errors.back()) / std::log(static_cast<double>(counts.back()) / counts.front());
}

}  // namespace

TEST_CASE("Irradiance.APlaneInTheSunHasTheCosine") {
  for (const double angle : {0.0, 30.0, 60.0, 85.0}) {
    const Vec3 towards(std::sin(angle * pi / 180), 0, std::cos(angle * pi / 180));
    const SurfacePoints middle = one_point({0, 0, 0}, {0, 0, 1});
    // The disc's tangents square to its middle cancel, but for 1e-5 of the irradiance.
    CHECK_THAT(lit(wall(), middle, sun_disc(towards, 1, 64)), WithinAbs(std::cos(angle * pi / 180), 2e-4));
    CHECK_THAT(lit(wall(), middle, sun_disc(towards, 1, 1)), WithinAbs(std::cos(angle * pi / 180), 4e-3));
  }
  CHECK(lit(wall(), one_point({0, 0, 0}, {0, 0, 1}), sun_disc({0, 0, -1}, 1, 16)) == 0);
}

TEST_CASE("Irradiance.AWallAndAShelfUnderASky") {
  // A wall sees half of an even sky. Of an overcast one, integral of L cos(h)^2 cos(a) over a quarter sphere, it gets
  // (pi / 6 + 4 / 9) L, level ground 7 / 9 pi L: Moon and Spencer 1942.
  const double overcast_on_wall = (pi / 6 + 4.0 / 9) / (7.0 / 9 * pi);
  const SurfacePoints of_wall = one_point({0, 0, 0}, {0, 0, 1}), shelf = one_point({0, 0, 0}, {0, 1, 0});
  const std::vector<int> counts{64, 256, 1024, 4096, 16384};
  std::vector<double> errors, ground_errors;
  for (const int count : counts) {
    errors.push_back(std::abs(lit(wall(), of_wall, sky_light(SkyKind::overcast, 1, count)) - overcast_on_wall));
    ground_errors.push_back(std::abs(lit(wall(), of_wall, ground_light(1, count)) - 0.5));
  }
  CHECK(order(counts, errors) > 0.7);
  CHECK(order(counts, ground_errors) > 0.7);
  CHECK(errors.back() < 1e-4);
  CHECK_THAT(lit(wall(), of_wall, sky_light(SkyKind::uniform, 1, 16384)), WithinAbs(0.5, 1e-4));
  // A shelf sees the half of the sky that is before the wall.
  CHECK_THAT(lit(wall(), shelf, sky_light(SkyKind::uniform, 1, 16384)), WithinAbs(0.5, 1e-3));
  CHECK_THAT(lit(wall(), shelf, sky_light(SkyKind::overcast, 1, 16384)), WithinAbs(0.5, 1e-3));
  // Sky and ground together are an even half sphere.
  const LightSamples both = joined(sky_light(SkyKind::uniform, 1, 128), ground_light(1, 128));
  CHECK_THAT(lit(wall(), of_wall, both), WithinAbs(1, 1e-12));
}

TEST_CASE("Irradiance.AWindowHasTheFormFactorOfItsRectangle") {
  const Vec3 centre(-1200, 300, 700);
  const double width = 900, height = 1300;
  const Vec3 facing = -centre.normalized(), across = Vec3(0, 1, 0).cross(facing).normalized(),
             upwards = facing.cross(across);
  std::vector<Vec3> corners;
  for (const auto& [s, t] : {std::pair{-0.5, -0.5}, std::pair{0.5, -0.5}, std::pair{0.5, 0.5}, std::pair{-0.5, 0.5}})
    corners.push_back(centre + s * width * across + t * height * upwards);
  for (const Vec3& corner : corners) REQUIRE(corner.z() > 0);
  const std::vector<int> counts{16, 64, 256, 1024, 4096, 16384};
  std::vector<double> mean_errors(counts.size(), 0);
  const std::vector<Vec3> places{{20, -10, 0}, {-45, 30, 0}, {0, 0, 0}, {40, 40, 0}, {-10, -48, 0}};
  for (const Vec3& place : places) {
    const SurfacePoints points = one_point(place, {-0.1, 0.05, 1}, 0);
    const double exact = lambert_polygon(corners, place, points.normal.row(0).transpose());
    for (std::size_t k = 0; k < counts.size(); ++k)
      mean_errors[k] += std::abs(lit(wall(), points, window_light(centre, width, height, counts[k])) / exact - 1) / 5;
  }
  CHECK(order(counts, mean_errors) > 0.7);
  CHECK(mean_errors.back() < 2e-4);
}

TEST_CASE("Irradiance.AStrobeFallsOffWithTheSquareOfItsDistance") {
  const Vec3 lamp(-300, 100, 200);
  CHECK_THAT(lit(wall(), one_point({0, 0, 0}, lamp, 0), strobe_light(lamp)), WithinAbs(1, 1e-12));
  const Vec3 place(40, 25, 0), way = lamp - place;
  const double expected = lamp.squaredNorm() * way.z() / std::pow(way.norm(), 3);
  CHECK_THAT(lit(wall(), one_point(place, {0, 0, 1}, 0), strobe_light(lamp)), WithinAbs(expected, 1e-12));
}

TEST_CASE("Irradiance.AStepThrowsAShadowOfTheRightLength") {
  const double height = 3;
  const LitObject step(
      rectangles({{Vec3(-50, -50, height), Vec3(0, -50, height), Vec3(0, 50, height), Vec3(-50, 50, height)},
                  {Vec3(0, -50, 0), Vec3(50, -50, 0), Vec3(50, 50, 0), Vec3(0, 50, 0)},
                  {Vec3(0, -50, 0), Vec3(0, 50, 0), Vec3(0, 50, height), Vec3(0, -50, height)}}));
  for (const double angle_deg : {20.0, 45.0, 70.0}) {
    const double angle = angle_deg * pi / 180;
    const Vec3 towards(-std::cos(angle), 0, std::sin(angle));
    const double length = height / std::tan(angle);
    const LightSamples sun = sun_disc(towards, 1, 64);
    CHECK(lit(step, one_point({0.97 * length, 0, 0}, {0, 0, 1}), sun) == 0);
    CHECK_THAT(lit(step, one_point({1.03 * length, 0, 0}, {0, 0, 1}), sun), WithinAbs(std::sin(angle), 2e-4));
    // In the half shadow, of a straight edge before a disc: the share of the disc beyond a chord.
    const double tan_radius = 4.6542e-3;
    for (const double beyond : {-0.7, 0.0, 0.4}) {
      const double place = length + beyond * tan_radius * height / (std::sin(angle) * std::sin(angle));
      const double share = (std::acos(-beyond) + beyond * std::sqrt(1 - beyond * beyond)) / pi;
      const SurfacePoints points = one_point({place, 0, 0}, {0, 0, 1}, 0);
      CHECK_THAT(lit(step, points, sun_disc(towards, 1, 4096)) / std::sin(angle), WithinAbs(share, 0.01));
    }
  }
}

TEST_CASE("Irradiance.AGrooveUnderAnEvenSkyHasItsFormFactor") {
  // An endless groove of two walls, 1 wide each, half its opening angle away from its middle plane. What a wall sees of
  // the sky is half of one less the cosine between the wall and the line to the other wall's edge (crossed strings,
  // Hottel 1954).
  const double half = 35 * pi / 180, far = 1e4;
  const Vec3 edge(std::sin(half), 0, std::cos(half));
  const Vec3 left(-edge.x(), 0, edge.z()), along(0, far, 0);
  const LitObject groove(
      rectangles({{-along, along, edge + along, edge - along}, {-along, left - along, left + along, along}}));
  const std::vector<int> counts{64, 256, 1024, 4096, 16384};
  std::vector<double> mean_errors(counts.size(), 0);
  for (const double from_bottom : {0.15, 0.4, 0.65, 0.9}) {
    const Vec3 place = from_bottom * edge, normal(-edge.z(), 0, edge.x());
    const double exact = 0.5 * (1 - (left - place).normalized().dot(edge));
    for (std::size_t k = 0; k < counts.size(); ++k) {
      const LightSamples sky = joined(sky_light(SkyKind::uniform, 1, counts[k]), ground_light(1, counts[k]));
      const double seen = lit(groove, one_point(place, normal, 1e-9), sky);
      mean_errors[k] += std::abs(seen - exact) / 4;
    }
  }
  CHECK(order(counts, mean_errors) > 0.6);
  CHECK(mean_errors.back() < 1e-3);
}

TEST_CASE("Irradiance.SizesAndThreadsDoNotMatter") {
  const TriangleMesh ball = test::icosphere(3);
  SurfacePoints points;
  points.place = ball.V;
  points.normal = ball.V;
  points.clearance = 1e-3;
  const LightSamples light = joined(sky_light(SkyKind::overcast, 1, 48), sun_disc(Vec3(0.6, 0, 0.8), 2, 5));
  Context context;
  const LitObject object(ball);
  const Irradiance once = irradiance(object, points, light, context);
  {
    const ThreadLimit one_thread(1);
    CHECK(irradiance(object, points, light, context).lit == once.lit);
  }
  // Powers of two change no digit.
  TriangleMesh larger = ball;
  larger.V *= 256;
  SurfacePoints far_apart = points;
  far_apart.place *= 256;
  far_apart.clearance *= 256;
  CHECK(irradiance(LitObject(larger), far_apart, light, context).lit == once.lit);
  // A ball shades no place that faces the light, and shadows only take away.
  for (std::size_t i = 0; i < once.lit.size(); ++i) CHECK(once.lit[i] <= once.open[i]);
  const Irradiance sun = irradiance(object, points, sun_disc(Vec3(0, 0, 1), 1, 1), context);
  for (std::size_t i = 0; i < sun.lit.size(); ++i)
    if (ball.V(static_cast<Eigen::Index>(i), 2) > 0.3) CHECK(sun.lit[i] == sun.open[i]);
}

TEST_CASE("Irradiance.Cancel") {
  Host host;
  host.cancel_requested = [] { return true; };
  Context context(std::move(host));
  CHECK_THROWS_AS(irradiance(wall(), one_point({0, 0, 0}, {0, 0, 1}), ground_light(1, 8), context), Error);
}

}  // namespace formwright::irradiance_tests
