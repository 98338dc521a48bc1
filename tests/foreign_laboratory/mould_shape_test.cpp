// SPDX-License-Identifier: GPL-3.0-or-later
#include "foreign_laboratory/mould_shape.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/generators/catch_generators.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <Eigen/Dense>
#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include "foreign_laboratory/air.h"
#include "foreign_laboratory/contact.h"

namespace formwright::foreign_laboratory {
namespace {

using Catch::Matchers::WithinAbs, Catch::Matchers::WithinRel;
using Eigen::Vector3d;

Mould every_mould() {
  return GENERATE(Mould::dome, Mould::cone, Mould::box, Mould::pyramid, Mould::bumps, Mould::cross);
}

double volume_of(const Triangulation& mesh) {
  double volume = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto at = [&](int k) { return mesh.vertices[static_cast<std::size_t>(k)]; };
    volume += at(a).dot(at(b).cross(at(c))) / 6;
  }
  return volume;
}

}  // namespace

TEST_CASE("MouldShape.TheNearestPointIsOnTheSurfaceAlongTheGradient") {
  const Mould mould = every_mould();
  INFO(mould_names[static_cast<std::size_t>(mould)]);
  std::mt19937_64 random(1);
  int outside = 0;
  for (int k = 0; k < 3000; ++k) {
    const Vector3d place(uniform(random, -80, 80), uniform(random, -80, 80), uniform(random, 0, 80));
    const Distance d = distance_to(mould, place);
    CHECK_THAT(d.outward.norm(), WithinAbs(1, 1e-12));
    if (d.mm < 0) continue;
    ++outside;
    CHECK_THAT(distance_to(mould, place - d.mm * d.outward).mm, WithinAbs(0, 1e-9));
    // No step is a longer way than its length: the distance is nowhere too large.
    const Vector3d step(uniform(random, -5, 5), uniform(random, -5, 5), uniform(random, -5, 5));
    CHECK(distance_to(mould, place + step).mm <= d.mm + step.norm() + 1e-12);
  }
  CHECK(outside > 1000);
  const double above = distance_to(mould, Vector3d(0, 0, 80)).mm;
  if (mould == Mould::bumps) CHECK(above > 80 - mould_height_mm(mould));  // the highest bump is beside the middle
  else CHECK_THAT(above, WithinAbs(80 - mould_height_mm(mould), 1e-9));
}

TEST_CASE("MouldMesh.IsClosedAndWithinItsChordErrorOfTheFormula") {
  const Mould mould = every_mould();
  INFO(mould_names[static_cast<std::size_t>(mould)]);
  const double chord_error = 0.02;
  const Triangulation mesh = triangulate(mould, chord_error);
  std::map<std::pair<int, int>, int> used;
  for (const auto& [a, b, c] : mesh.triangles)
    for (const auto& edge : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) ++used[edge];
  for (const auto& [edge, count] : used) {
    REQUIRE(count == 1);
    REQUIRE(used.contains({edge.second, edge.first}));
  }
  std::mt19937_64 random(2);
  double farthest = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    double u = uniform(random, 0, 1), v = uniform(random, 0, 1);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const auto at = [&](int k) { return mesh.vertices[static_cast<std::size_t>(k)]; };
    const Vector3d place = at(a) + u * (at(b) - at(a)) + v * (at(c) - at(a));
    if (place.z() > 0) farthest = std::max(farthest, std::abs(distance_to(mould, place).mm));
  }
  CHECK(farthest < 1.5 * chord_error);
  CHECK(mesh.triangles.size() < 60000);
}

TEST_CASE("MouldMesh.ADomeHasTheVolumeOfTheSphericalCap") {
  const double exact = std::numbers::pi * 45 * (3 * 50 * 50 + 45 * 45) / 6;
  CHECK_THAT(volume_of(triangulate(Mould::dome, 0.02)), WithinRel(exact, 2e-3));
  const double coarse = exact - volume_of(triangulate(Mould::dome, 0.4));
  CHECK(coarse > 2 * (exact - volume_of(triangulate(Mould::dome, 0.1))));
}

TEST_CASE("Contact.APointOnThePlateSlidesByCoulombsLaw") {
  const double friction = 0.4, seconds = 1e-3, clearance = 0.5;
  Faults faults;
  faults.slip = 1 / friction;
  const MouldOnPlate obstacle(Mould::dome, faults);
  const double pressing = 1000, pulling = GENERATE(100.0, 399.0, 401.0, 900.0);  // mm/s^2
  Vector3d place(90, 0, clearance), velocity = Vector3d::Zero();
  for (int k = 0; k < 100; ++k) {
    velocity += seconds * Vector3d(pulling, 0, -pressing);
    CHECK(obstacle.constrain(place, clearance, {seconds, 0, 0}, velocity) == 0);
    place += seconds * velocity;
  }
  CHECK_THAT(velocity.x(), WithinAbs(std::max(0.0, pulling - friction * pressing) * 0.1, 1e-9));
  CHECK_THAT(place.z(), WithinAbs(clearance, 1e-9));
}

TEST_CASE("Contact.WithoutSlipAPointSticksToTheRisingMouldAndCanBePulledOff") {
  const MouldOnPlate obstacle(Mould::dome, Faults{});
  const double clearance = 0.5, seconds = 1e-3;
  const Vector3d rising(0, 0, 100);
  Vector3d place(40, 0, 0);
  place -= (obstacle.distance_from(place, -60).mm - clearance) * obstacle.distance_from(place, -60).outward;
  const Vector3d n = obstacle.distance_from(place, -60).outward;
  CHECK_THAT(obstacle.distance_from(place, -60).mm, WithinAbs(clearance, 1e-9));
  const MouldOnPlate::Step step{seconds, -60 + seconds * rising.z(), rising.z()};
  Vector3d velocity(30, 20, -10);
  CHECK(obstacle.constrain(place, clearance, step, velocity) == 0);
  CHECK((velocity - rising).cross(n).norm() < 0.1);
  CHECK_THAT(obstacle.distance_from(place + seconds * velocity, step.plate_z_mm).mm, WithinAbs(clearance, 1e-4));
  const Vector3d pulled_off = rising + 50 * n;
  velocity = pulled_off;
  CHECK(obstacle.constrain(place, clearance, step, velocity) > 0);
  CHECK(velocity == pulled_off);
}

TEST_CASE("Contact.ATurnedShiftedAndScaledMouldIsWhereItsFaultsHaveIt") {
  Faults faults;
  faults.mould_shift_x_mm = 3, faults.mould_shift_y_mm = -2, faults.mould_rotation_deg = 30, faults.mould_scale = 0.1;
  const MouldOnPlate obstacle(Mould::box, faults);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(std::numbers::pi / 6, Vector3d::UnitZ()).toRotationMatrix();
  const Vector3d in_mould(60, 10, 20), shift(3, -2, -40);
  const Distance expected = distance_to(Mould::box, in_mould);
  const Distance found = obstacle.distance_from(turn * (1.1 * in_mould) + shift, -40);
  CHECK_THAT(found.mm, WithinAbs(1.1 * expected.mm, 1e-12));
  CHECK((found.outward - turn * expected.outward).norm() < 1e-12);
}

TEST_CASE("Contact.AMouldLeansToTheSideThatItsFaultsName") {
  Faults faults;
  faults.mould_lean_right_deg = 10;
  const Vector3d top(0, 0, mould_height_mm(Mould::cone) + 5);
  const double above = distance_to(Mould::cone, top).mm;
  const auto right = Eigen::AngleAxisd(std::numbers::pi / 18, Vector3d::UnitY()).toRotationMatrix();
  CHECK((right * top).x() > 0);
  CHECK_THAT(MouldOnPlate(Mould::cone, faults).distance_from(right * top, 0).mm, WithinAbs(above, 1e-12));
  faults.mould_lean_right_deg = 0, faults.mould_lean_back_deg = 10;
  const auto back = Eigen::AngleAxisd(-std::numbers::pi / 18, Vector3d::UnitX()).toRotationMatrix();
  CHECK((back * top).y() > 0);
  CHECK_THAT(MouldOnPlate(Mould::cone, faults).distance_from(back * top, 0).mm, WithinAbs(above, 1e-12));
}

TEST_CASE("Air.ThePumpReachesItsVacuumExponentiallyAndTheSheetSqueezesWhatIsLeft") {
  Air air(1e6, 0.08, 0.15);
  double difference = 0;
  for (int k = 0; k < 300; ++k) difference = air.step(1e6, 1e-3);
  CHECK_THAT(difference, WithinRel(0.08 * -std::expm1(-0.3 / 0.15), 1e-12));
  // Half the volume, at once: twice the pressure that was left.
  const double left = Air::atmosphere_mpa - difference;
  CHECK_THAT(air.step(0.5e6, 1e-12), WithinAbs(Air::atmosphere_mpa - 2 * left, 1e-9));
}

}  // namespace formwright::foreign_laboratory
