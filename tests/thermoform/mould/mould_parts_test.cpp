// SPDX-License-Identifier: GPL-3.0-or-later
#include "thermoform/mould/mould_parts.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <cmath>
#include <numbers>

#include "base/error.h"
#include "geometry/mesh/adjacency.h"
#include "geometry/mesh/measures.h"
#include "geometry/samples/samples.h"
#include "thermoform/mould/mould.h"
#include "thermoform/mould/registration_keys.h"
#include "thermoform/mould/solid_shapes.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

ExactSolid negative_of(const char* name, int vertices) {
  Context context;
  const TriangleMesh mesh = make_sample(name, vertices, context).mesh;
  std::vector<std::string> notes;
  return make_mould(model_on_plate(place(mesh, {}, {220, 240})(mesh), {}, notes, context), {}, {}, context).solid;
}

double total_volume(const MouldParts& parts) {
  double volume = 0;
  for (const MouldPart& part : parts.parts) volume += part.volume_mm3;
  return volume;
}

void expect_printable(const MouldParts& parts, const Vec3& printer) {
  BoundingBox all;
  for (const MouldPart& part : parts.parts) {
    CHECK(Adjacency(part.mesh).is_closed());
    const BoundingBox box = bounding_box(part.mesh);
    CHECK_THAT(box.lower.z(), WithinAbs(0, 1e-12));
    for (int k = 0; k < 3; ++k) {
      if (printer[k] > 0) {
        CHECK(box.size()[k] <= printer[k] * (1 + 1e-12));
      }
    }
    for (const MouldPart& other : parts.parts) {
      if (&other == &part) continue;
      const BoundingBox b = bounding_box(other.mesh);
      const double apart = std::max(std::max(b.lower.x() - box.upper.x(), box.lower.x() - b.upper.x()),
                                    std::max(b.lower.y() - box.upper.y(), box.lower.y() - b.upper.y()));
      CHECK(apart >= 5 - 1e-9);
    }
    all.add(box.lower), all.add(box.upper);
  }
  CHECK_THAT(all.centre().head<2>().norm(), WithinAbs(0, 1e-9));
}

TEST_CASE("MouldParts.WholeIfThereIsRoom") {
  Context context;
  const ExactSolid solid = negative_of("pyramid", 1000);
  const MouldParts parts = split_mould(solid, {}, context);
  REQUIRE(parts.parts.size() == 1u);
  CHECK_THAT(parts.parts[0].volume_mm3, WithinAbs(solid.volume_mm3(), 1e-9 * solid.volume_mm3()));
  expect_printable(parts, Vec3::Zero());
  CHECK(parts.sentences.empty());
  // The opening is up: the pyramid's base of 100 x 100 mm is open at the top, z = 63.
  const TriangleMesh& mesh = parts.parts[0].mesh;
  double rim = 0;
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    const Vec3 a = mesh.V.row(mesh.F(f, 0)), b = mesh.V.row(mesh.F(f, 1)), c = mesh.V.row(mesh.F(f, 2));
    if (std::min({a.z(), b.z(), c.z()}) > 63 - 1e-9) rim += 0.5 * (b - a).cross(c - a).z();
  }
  CHECK_THAT(rim, WithinAbs(106.0 * 106 - 1e4, 1e-7));
}

TEST_CASE("MouldParts.AddUpAndFit") {
  Context context;
  for (const char* name : {"pyramid", "cat"}) {
    INFO(name);
    const ExactSolid solid = negative_of(name, 2000);
    ThermoformMouldOptions options;
    options.key_diameter_mm = 0;
    options.printer_x_mm = 60, options.printer_y_mm = 80, options.printer_z_mm = 45;
    const MouldParts parts = split_mould(solid, options, context);
    CHECK_THAT(total_volume(parts), WithinAbs(solid.volume_mm3(), 1e-9 * solid.volume_mm3()));
    expect_printable(parts, {60, 80, 45});
    const Vec3 size = bounding_box(solid.mesh()).size();
    const auto count = [&](double px, double py) {
      return static_cast<int>(std::ceil(size.x() / px) * std::ceil(size.y() / py) * std::ceil(size.z() / 45));
    };
    CHECK(static_cast<int>(parts.parts.size()) == std::min(count(60, 80), count(80, 60)));
    CHECK(parts.keys == 0);
  }
}

TEST_CASE("MouldParts.KeysFitIntoTheirSockets") {
  Context context;
  const ExactSolid solid = negative_of("pyramid", 1000);
  ThermoformMouldOptions options;
  options.printer_x_mm = 70;
  const MouldParts parts = split_mould(solid, options, context);
  REQUIRE(parts.parts.size() == 2u);
  REQUIRE(parts.keys == 2);
  CHECK(parts.parts[0].pins == 2);
  CHECK(parts.parts[1].sockets == 2);
  expect_printable(parts, {70, 0, 0});
  // A pin: a prism of 16 sides for a quarter of its length, then a frustum to 0.7 of the radius.
  const double unit = 8 * std::sin(2 * std::numbers::pi / 16);
  const auto cone = [&](double r, double q, double straight, double slant) {
    return unit * (r * r * straight + slant * (r * r + r * q + q * q) / 3);
  };
  const double pin = cone(2, 1.4, 1, 3), socket = cone(2.2, 1.6, 1, 3.2);
  CHECK_THAT(parts.parts[0].volume_mm3 + parts.parts[1].volume_mm3 - solid.volume_mm3(),
             WithinAbs(2 * (pin - socket), 1e-6));
  CHECK_THAT(parts.parts[0].size_mm.x(), WithinAbs(53 + 4, 1e-9));  // the pin stands out
  // Put together, nothing overlaps.
  const BoundingBox box = bounding_box(solid.mesh());
  const auto keys = find_keys(solid.mesh(), box, {2, 1, 1}, 4, 0.2, false, context);
  REQUIRE(keys.size() == 2u);
  int pins = 0, sockets = 0;
  const ExactSolid left = with_keys(solid.half(0, 0, false, context), {0, 0, 0}, keys, 0.2, pins, sockets, context);
  const ExactSolid right = with_keys(solid.half(0, 0, true, context), {1, 0, 0}, keys, 0.2, pins, sockets, context);
  CHECK(intersect(left, right, context).empty());
  CHECK((keys[0].centre_mm - keys[1].centre_mm).norm() > 40);
}

// Every part stands on a whole side, not on its pins, whichever way up it is printed.
TEST_CASE("MouldParts.PinsPointUpOnTheBed") {
  Context context;
  ThermoformMouldOptions options;
  options.printer_z_mm = 40;
  const ExactSolid solid = negative_of("pyramid", 1000);
  for (const MouldKind kind : {MouldKind::negative, MouldKind::positive}) {
    options.kind = kind;
    const MouldParts parts = split_mould(solid, options, context);
    REQUIRE(parts.parts.size() == 2u);
    CHECK(parts.keys == 2);
    CHECK(parts.parts[kind == MouldKind::negative ? 1 : 0].pins == 2);
    for (const MouldPart& part : parts.parts) CHECK(base_area_mm2(part.mesh, 0) > 106 * 106 - 1e4 - 1);
    CHECK_THAT(total_volume(parts), WithinAbs(solid.volume_mm3(), 1e-3 * solid.volume_mm3()));
  }
}

TEST_CASE("MouldParts.SmallerKeysInThinnerWalls") {
  Context context;
  // A square tube with walls of 8 mm.
  const ExactSolid tube =
      subtract(ExactSolid::from_mesh(box_mesh({-40, -20, 0}, {40, 20, 30}), "mesh", context),
               ExactSolid::from_mesh(box_mesh({-41, -12, 8}, {41, 12, 22}), "mesh", context), context);
  const BoundingBox box = bounding_box(tube.mesh());
  const auto keys = find_keys(tube.mesh(), box, {2, 1, 1}, 4, 0.2, false, context);
  REQUIRE_FALSE(keys.empty());
  CHECK(keys[0].diameter_mm < 4);
  CHECK(find_keys(tube.mesh(), box, {2, 1, 1}, 40, 0.2, false, context).empty());
}

TEST_CASE("MouldParts.TurnsOnTheBedToSaveParts") {
  Context context;
  const ExactSolid bar = ExactSolid::from_mesh(box_mesh({-50, -10, 0}, {50, 10, 10}), "mesh", context);
  ThermoformMouldOptions options;
  options.kind = MouldKind::positive;
  options.printer_x_mm = 25, options.printer_y_mm = 105;
  const MouldParts parts = split_mould(bar, options, context);
  REQUIRE(parts.parts.size() == 1u);
  CHECK_THAT(parts.parts[0].size_mm.y(), WithinAbs(100, 1e-12));
  expect_printable(parts, {25, 105, 0});
}

TEST_CASE("MouldParts.RefusesToyPrinters") {
  Context context;
  const ExactSolid bar = ExactSolid::from_mesh(box_mesh({-50, -10, 0}, {50, 10, 10}), "mesh", context);
  for (const double printer : {1.0, 4.5}) {
    ThermoformMouldOptions options;
    options.printer_x_mm = printer, options.printer_y_mm = printer;
    try {
      split_mould(bar, options, context);
      FAIL();
    } catch (const Error& error) {
      CHECK(error.code() == ErrorCode::invalid_input);
      CHECK(error.where().substr(0, 8) == "printer_");
    }
  }
}

}  // namespace
}  // namespace formwright
