// SPDX-License-Identifier: GPL-3.0-or-later
#include "thermoform/mould/mould.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <cmath>
#include <numbers>

#include "base/error.h"
#include "geometry/mesh/adjacency.h"
#include "geometry/mesh/measures.h"
#include "geometry/queries/ray_caster.h"
#include "geometry/samples/samples.h"
#include "geometry/test_meshes.h"
#include "thermoform/mould/solid_shapes.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

TriangleMesh placed_sample(const char* name, int vertices, const PlacementOptions& options = {}) {
  Context context;
  const TriangleMesh mesh = make_sample(name, vertices, context).mesh;
  return place(mesh, options, {220, 240})(mesh);
}

struct Made {
  ExactSolid model;
  Mould mould;
  std::vector<std::string> notes;
};
Made make(const TriangleMesh& placed, const ThermoformMouldOptions& options, const std::vector<Vent>& vents = {}) {
  Context context;
  Made made;
  made.model = model_on_plate(placed, options, made.notes, context);
  made.mould = make_mould(made.model, vents, options, context);
  CHECK(Adjacency(made.mould.solid.mesh()).is_closed());
  return made;
}

Error refusal(const TriangleMesh& placed, const ThermoformMouldOptions& options) {
  try {
    make(placed, options);
  } catch (const Error& error) {
    return error;
  }
  FAIL_CHECK("should have been refused");
  return Error(ErrorCode::internal, "", "");
}

TEST_CASE("Mould.PyramidInItsBox") {
  ThermoformMouldOptions options;
  options.wall_mm = 4;
  const Made made = make(placed_sample("pyramid", 1000), options);
  const double pyramid = 100.0 * 100 * 60 / 3;
  CHECK_THAT(made.mould.body.volume_mm3(), WithinAbs(pyramid, 1e-9 * pyramid));
  CHECK_THAT(made.mould.solid.volume_mm3(), WithinAbs(108.0 * 108 * 64 - pyramid, 1e-9 * pyramid));
  CHECK_THAT(base_area_mm2(made.mould.body.mesh(), 0), WithinAbs(1e4, 1e-8));
  CHECK_THAT((bounding_box(made.mould.solid.mesh()).size() - Vec3(108, 108, 64)).norm(), WithinAbs(0, 1e-9));
  CHECK(made.notes.empty());
}

TEST_CASE("Mould.SphereConeAndCubeToTheMeshsOwnVolume") {
  const TriangleMesh cone = turned_mesh(Vec3::Zero(), 2, {{0, 30}, {40, 1}}, 48),
                     cube = box_mesh({-20, -20, 0}, {20, 20, 40});
  const TriangleMesh sphere = test::moved(test::icosphere(3), {0, 0, 12}, 20);  // its lower 8 mm below the plate
  Context context;
  for (const TriangleMesh* mesh : {&cone, &cube, &sphere}) {
    const Made made = make(*mesh, {});
    const double block = bounding_box(made.mould.solid.mesh()).size().prod(), model = made.model.volume_mm3();
    CHECK_THAT(made.mould.solid.volume_mm3(), WithinAbs(block - model, 1e-9 * block));
    if (mesh != &sphere) {
      CHECK_THAT(model, WithinAbs(signed_volume(*mesh), 1e-9 * model));
    }
  }
  // The cap cut off a ball: pi h^2 (3 r - h) / 3, to the mesh's own error.
  const double ball = 4.0 / 3 * std::numbers::pi * 8000, cap = std::numbers::pi * 64 * (60 - 8) / 3;
  CHECK_THAT(make(sphere, {}).model.volume_mm3() / signed_volume(sphere), WithinAbs((ball - cap) / ball, 2e-3));
}

// What fills the negative is what the sheet is formed over: exactly, not to rounding.
TEST_CASE("Mould.CastOfTheNegativeIsThePositive") {
  Context context;
  for (const char* name : {"pyramid", "hemisphere", "cat"}) {
    INFO(name);
    ThermoformMouldOptions options;
    options.base_mm = name == std::string("hemisphere") ? 6 : 0;
    const Made made = make(placed_sample(name, 2000), options);
    const BoundingBox box = bounding_box(made.mould.solid.mesh());
    const ExactSolid block = ExactSolid::from_mesh(box_mesh(box.lower, box.upper), "mesh", context);
    const ExactSolid cast = subtract(block, made.mould.solid, context);
    CHECK_THAT(cast.volume_mm3(), WithinAbs(made.mould.body.volume_mm3(), 1e-9 * cast.volume_mm3()));
    CHECK(subtract(made.mould.body, block, context).empty());
    CHECK_THAT(unite(made.mould.solid, made.mould.body, context).volume_mm3(),
               WithinAbs(block.volume_mm3(), 1e-9 * block.volume_mm3()));
    options.kind = MouldKind::positive;
    CHECK_THAT(make(placed_sample(name, 2000), options).mould.solid.volume_mm3(),
               WithinAbs(cast.volume_mm3(), 1e-9 * cast.volume_mm3()));
  }
}

// Rounded to doubles the mould is still a solid that passes every check of an input: no face crosses another.
TEST_CASE("Mould.RoundingBreaksNothing") {
  Context context;
  for (const char* name : {"hemisphere", "star", "octopus", "bust", "cat"}) {
    INFO(name);
    ThermoformMouldOptions options;
    options.sink_mm = 7.3;
    const Made made = make(placed_sample(name, 3000, options), options);
    const double volume = made.mould.solid.volume_mm3();
    CHECK_THAT(ExactSolid::from_mesh(made.mould.solid.mesh(), "mesh", context).volume_mm3(),
               WithinAbs(volume, 1e-12 * volume));
  }
}

TEST_CASE("Mould.TurningChangesNoVolume") {
  ThermoformMouldOptions options;
  options.foot_mm = 0;
  options.sink_mm = 15;
  const double straight = make(placed_sample("heart", 2000, options), options).model.volume_mm3();
  for (const double turn : {37.0, 90.0, -120.0}) {
    options.turn_deg = turn;
    CHECK_THAT(make(placed_sample("heart", 2000, options), options).model.volume_mm3(),
               WithinAbs(straight, 1e-9 * straight));
  }
  // Sinking takes off what lies below: less and less is left, and nothing below the plate.
  double last = straight;
  for (const double sink : {30.0, 45.0}) {
    options.sink_mm = sink;
    const Made made = make(placed_sample("heart", 2000, options), options);
    CHECK(made.model.volume_mm3() < last);
    CHECK(made.model.mesh().V.col(2).minCoeff() == 0);
    last = made.model.volume_mm3();
  }
}

TEST_CASE("Mould.AsLargeAsTheClampOpening") {
  ThermoformMouldOptions options;
  options.size_mm = 220;
  const Made made = make(placed_sample("pyramid", 1000, options), options);
  const double pyramid = 220.0 * 220 * 132 / 3;
  CHECK_THAT(made.mould.solid.volume_mm3(), WithinAbs(226.0 * 226 * 135 - pyramid, 1e-9 * pyramid));
}

TEST_CASE("Mould.BasePlateAndOutline") {
  ThermoformMouldOptions options;
  options.base_mm = 8;
  options.base_rim_mm = 5;
  const double pyramid = 2e5, plate = 110.002 * 110.002 * 8;
  const Made made = make(placed_sample("pyramid", 1000), options);
  CHECK_THAT(made.mould.body.volume_mm3(), WithinAbs(pyramid + plate, 1e-9 * pyramid));
  CHECK_THAT(made.mould.solid.volume_mm3(), WithinAbs(116.002 * 116.002 * 71 - pyramid - plate, 1e-9 * pyramid));
  CHECK_THAT(base_area_mm2(made.mould.body.mesh(), -8), WithinAbs(110.002 * 110.002, 1e-8));
  // A round block around a round model: every wall at least as thick as asked for, less plastic than the box.
  options = {};
  const double in_box = make(placed_sample("hemisphere", 2000), options).mould.solid.volume_mm3();
  options.outline = MouldOutline::hull;
  const Made round = make(placed_sample("hemisphere", 2000), options);
  CHECK(round.mould.solid.volume_mm3() < in_box - (4 - std::numbers::pi) * 50 * 50 * 50 + 4000);
  const TriangleMesh mesh = round.mould.solid.mesh(), body = round.mould.body.mesh();
  double thinnest = 1e9;
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    const Vec3 a = mesh.V.row(mesh.F(f, 0)), b = mesh.V.row(mesh.F(f, 1)), c = mesh.V.row(mesh.F(f, 2));
    const Vec3 n = (b - a).cross(c - a).normalized();
    if (std::abs(n.z()) < 1e-9 && n.dot(a) > 51) thinnest = std::min(thinnest, n.dot(a) - (body.V * n).maxCoeff());
  }
  CHECK(thinnest >= 3 - 1e-9);
  CHECK(thinnest < 3.01);
}

TEST_CASE("Mould.FeetForWhatStandsOnAPoint") {
  const TriangleMesh sphere = test::moved(test::icosphere(3), {0, 0, 20}, 20);
  const Made made = make(sphere, {});
  REQUIRE(made.notes.size() == 1u);
  CHECK(made.notes[0].find("drawn straight down") != std::string::npos);
  CHECK(base_area_mm2(made.model.mesh(), 0) > 100);
  ThermoformMouldOptions options;
  options.foot_mm = 0;
  CHECK(refusal(sphere, options).where() == "sink_mm");
  options.foot_mm = 5;  // a cylinder of the section at 5 mm, less the segment of the ball that it replaces
  const double section = std::numbers::pi * (400 - 225), segment = std::numbers::pi * 25 * (60 - 5) / 3;
  CHECK_THAT(make(sphere, options).model.volume_mm3() - signed_volume(sphere),
             WithinAbs(section * 5 - segment, 0.03 * segment));
}

TEST_CASE("Mould.VentsGoThrough") {
  ThermoformMouldOptions options;
  options.vent_diameter_mm = 2;
  options.base_mm = 3;
  Vent vent;
  vent.position_mm = {10, 20, 36};  // on the pyramid's side: 60 - 1.2 * 20
  Vent other;
  other.position_mm = {-30, 0, 24};
  const TriangleMesh placed = placed_sample("pyramid", 1000);
  const Made plain = make(placed, options), drilled = make(placed, options, {vent, other});
  // Prisms of 12 sides, up to the slanting side: as long as on their axes, on average.
  const double section = 6 * std::sin(std::numbers::pi / 6);
  CHECK_THAT(plain.mould.body.volume_mm3() - drilled.mould.body.volume_mm3(), WithinAbs(section * (39 + 27), 1e-6));
  const RayCaster body(drilled.mould.body.mesh()), block(drilled.mould.solid.mesh()), full(plain.mould.body.mesh());
  for (const Vent& v : {vent, other}) {
    const Vec3 below(v.position_mm.x(), v.position_mm.y(), -100);
    CHECK_FALSE(body.first_hit(below, Vec3::UnitZ(), 0, 1000).has_value());  // light shines through
    CHECK(full.first_hit(below, Vec3::UnitZ(), 0, 1000).has_value());
    // In the negative it is a pin from the wall to the level of the pour opening.
    const auto pin = block.first_hit(below, Vec3::UnitZ(), 0, 1000);
    REQUIRE(pin.has_value());
    CHECK_THAT(pin->distance, WithinAbs(100 - options.base_mm, 1e-9));
  }
  // A dozen at once is one boolean.
  std::vector<Vent> many;
  for (int i = 0; i < 12; ++i) {
    many.emplace_back();
    many.back().position_mm = {5.0 * i - 27.5, 3, 60 - 1.2 * std::max(std::abs(5.0 * i - 27.5), 3.0)};
  }
  CHECK(genus(Adjacency(make(placed, options, many).mould.body.mesh())) == 12);
}

TEST_CASE("Mould.OpenUndersidesAreClosed") {
  Context context;
  const TriangleMesh whole = placed_sample("hemisphere", 2000);
  TriangleMesh open = whole;
  int kept = 0;
  for (Eigen::Index f = 0; f < whole.F.rows(); ++f) {
    const auto face = whole.F.row(f);
    if (whole.V(face[0], 2) > 1e-6 || whole.V(face[1], 2) > 1e-6 || whole.V(face[2], 2) > 1e-6)
      open.F.row(kept++) = face;
  }
  open.F.conservativeResize(kept, 3);
  const double volume = signed_volume(whole);
  CHECK_THAT(make(open, {}).model.volume_mm3(), WithinAbs(volume, 1e-9 * volume));
  // Lifted by 3 mm: a wall of the rim's outline closes the gap.
  const Made raised = make(test::moved(open, {0, 0, 3}), {});
  CHECK_THAT(raised.model.volume_mm3(),
             WithinAbs(volume + 3 * base_area_mm2(make(whole, {}).model.mesh(), 0), 1e-7 * volume));
  CHECK(raised.notes.at(0).find("open below") != std::string::npos);
  // The mountain is a sheet.
  CHECK(make(placed_sample("mountain", 3000), {}).mould.solid.volume_mm3() > 0);
  // A hole in the upper half is not guessed at.
  TriangleMesh holed = whole;
  int at = 0;
  for (int f = 0; f < whole.face_count(); ++f)
    if (whole.V(whole.F(f, 0), 2) > whole.V(whole.F(at, 0), 2)) at = f;
  holed.F.row(at) = holed.F.row(whole.face_count() - 1);
  holed.F.conservativeResize(whole.face_count() - 1, 3);
  const Error error = refusal(holed, {});
  CHECK(error.where() == "mould");
  CHECK(std::string(error.what()).find("fill its holes") != std::string::npos);
}

TEST_CASE("Mould.PlasterIsConserved") {
  const Mixture mixture = plaster_mixture(1000, 0.6);
  CHECK_THAT(mixture.water_g, WithinAbs(0.6 * mixture.plaster_g, 1e-12));
  CHECK_THAT(mixture.plaster_g / 2.63 + mixture.water_g, WithinAbs(1000, 1e-9));
  CHECK_THAT(mixture.plaster_g,
             WithinAbs(1020, 5));  // moulders' tables: 1.02 g of powder for a millilitre at 60 parts of water
}

}  // namespace
}  // namespace formwright
